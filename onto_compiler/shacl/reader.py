"""Looking things up in a shapes graph, with a fault that names the shape where something is not as it must be."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import NoReturn

from pyoxigraph import Literal, NamedNode, Triple

from onto_compiler.rdf import BASE, OWL, SH, XSD
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.model import ShapeFault
from onto_compiler.shacl.paths import Path, sparql_path
from onto_compiler.sparql import refusal
from onto_compiler.sparql_faults.explain import query_fault, without_mark
from onto_compiler.sparql_faults.fault import Fault
from onto_compiler.terms import text_of

__all__ = ["Parameter", "Reader", "local"]

_IMPORTS = NamedNode(OWL + "imports")
_QUERIES = ("ask", "construct", "select", "update")
_ANY_PATH = Path("predicate", NamedNode("urn:onto-evwm:path"))
_DECLARATIONS = re.compile(r"(?:PREFIX (?:[^\W\d_][\w.\-]*)?: <[^<>\"{}|^`\\\x00-\x20]*>\n)*")
_PATH, _PATH_OF_THAT_LENGTH = re.compile(r"[$?]PATH\b"), "<p:p>"
_DECLARE = 'declare it: sh:prefixes [ sh:declare [ sh:prefix "{prefix}" ; sh:namespace "{iri}"^^xsd:anyURI ] ]'
_TRUE = tuple(Literal(text, datatype=NamedNode(XSD + "boolean")) for text in ("true", "1"))
_CODE, _HINT = NamedNode(BASE + "shapes#code"), NamedNode(BASE + "shapes#hint")


@dataclass(frozen=True, slots=True)
class Reader:
    """A shapes graph, and the shapes that what was read so far refers to."""

    graph: Graph
    wanted: list[Term] = field(default_factory=list)

    def values(self, node: Term, name: str | NamedNode) -> list[Term]:
        """The values of ``sh:name``, or of a property given whole."""
        predicate = name if isinstance(name, NamedNode) else NamedNode(SH + name)
        return list(self.graph.objects(node, predicate))

    def one(self, node: Term, name: str | NamedNode) -> Term | None:
        """The first of them."""
        return next(iter(self.values(node, name)), None)

    def text(self, node: Term, name: str | NamedNode) -> str:
        """A text value: the one without a language before the English one before any other."""
        found = [value for value in self.values(node, name) if isinstance(value, Literal)]
        found.sort(key=lambda value: {None: 0, "en": 1}.get(value.language, 2))
        return found[0].value if found else ""

    def is_true(self, node: Term, name: str) -> bool:
        """Whether ``sh:name`` is true, by its value: a boolean is written in two ways, and a string is none."""
        return any(value in _TRUE for value in self.values(node, name))

    def messages(self, node: Term) -> tuple[Literal, ...]:
        """The texts of ``sh:message``, one or more for each language."""
        return tuple(value for value in self.values(node, "message") if isinstance(value, Literal))

    def texts(self, node: Term) -> tuple[str, str, str]:
        """Message, code and hint that a shape or constraint gives."""
        return self.text(node, "message"), self.text(node, _CODE), self.text(node, _HINT)

    def declarations(self, node: Term) -> list[Term]:
        """The values of sh:declare that ``sh:prefixes`` of ``node`` stands for, imported ontologies included."""
        found: list[Term] = []
        todo, seen = self.values(node, "prefixes"), set[Term]()
        while todo:
            header = todo.pop()
            if header in seen:
                continue
            seen.add(header)
            todo += self.values(header, _IMPORTS)
            found += self.values(header, "declare")
        return found

    def prefixes(self, node: Term) -> dict[str, str]:
        """The namespaces that ``sh:prefixes`` of ``node`` declares, by prefix."""
        found: dict[str, str] = {}
        for declaration in self.declarations(node):
            prefix, namespace = self.one(declaration, "prefix"), self.one(declaration, "namespace")
            if prefix is not None and namespace is not None:
                found[text_of(prefix)] = text_of(namespace)
        return dict(sorted(found.items()))

    def query(self, node: Term, name: str, path: Path | None = None, *, what: str = "the query") -> str | None:
        """The query ``sh:name`` of ``node`` as it is asked: prefixes in front, ``path`` in place of ``$PATH``.

        This is the only way from a shapes graph to a query, which ``what`` names. None where there is none.

        Raises:
            ShapeFault: the query must not be run (QRY001 to QRY003), is not SPARQL, or needs a path that ``node``
                lacks; the place is in the text as its author wrote it.

        """
        text = self.one(node, name)
        if text is None:
            return None
        if not isinstance(text, Literal):
            raise ShapeFault(f"the value of sh:{name} is no text of a query", node, name, text)
        written = text.value
        if _PATH.search(written) and path is None:
            raise ShapeFault("`$PATH` stands in a query of a shape without a path", node, name, text)
        known = self.prefixes(node)
        fault = _fault(_PATH.sub(_PATH_OF_THAT_LENGTH, written), tuple(known.items()))
        if fault is not None:
            code, inside = fault.code or "SHP002", (fault.start, fault.length)
            said = fault.message if fault.code else f"{what} cannot run: {fault.message}"
            raise ShapeFault(said, node, name, text, code=code, hint=fault.hint, inside=inside)
        lines = "".join(f"PREFIX {prefix}: <{namespace}>\n" for prefix, namespace in known.items())
        if not _DECLARATIONS.fullmatch(lines):
            self._refuse(lines + written, node, name, text)
        body = without_mark(written)
        return lines + (body if path is None else _PATH.sub(lambda _: sparql_path(path), body))

    def _refuse(self, query: str, node: Term, name: str, text: Literal) -> NoReturn:
        """Refuse a query whose ``sh:declare`` gives no prefix or no IRI: what it gives may hold a query of its own."""
        try:
            hidden = refusal(query)
        except SyntaxError:
            hidden = None
        said = "a sh:declare of this query gives a prefix that is no name, or a namespace that is no IRI"
        hint = 'write it as sh:declare [ sh:prefix "ex" ; sh:namespace "http://example.org/"^^xsd:anyURI ]'
        raise ShapeFault(said, node, name, text, code=hidden.code if hidden else "SHP002", hint=hint)

    def refused(self) -> Iterator[ShapeFault]:
        """Every query of the graph that must not be run, whether anything uses it or not."""
        for name in _QUERIES:
            for holder in sorted(self.graph.holders(NamedNode(SH + name)), key=str):
                try:
                    self.query(holder, name, _ANY_PATH)
                except ShapeFault as fault:
                    if fault.problems[0].code != "SHP002":  # what cannot run matters where it is used
                        yield fault

    def shape(self, node: Term) -> Term:
        """A shape that is referred to; it will be compiled too."""
        self.wanted.append(node)
        return node


@dataclass(frozen=True, slots=True)
class Parameter:
    """A constraint parameter that is being compiled: ``shape`` has ``value`` for ``sh:name``."""

    reader: Reader
    shape: Term
    name: str
    value: Term

    def fault(self, message: str) -> ShapeFault:
        """What is wrong with the value."""
        return ShapeFault(message, self.shape, self.name, self.value)

    def iri(self) -> NamedNode:
        """The value as an IRI.

        Raises:
            ShapeFault: where it is none.

        """
        if not isinstance(self.value, NamedNode):
            raise self.fault(f"the value of sh:{self.name} is no IRI")
        return self.value

    def number(self) -> int:
        """The value as a whole number.

        Raises:
            ShapeFault: where it is none.

        """
        try:
            return int(text_of(self.value))
        except ValueError:
            raise self.fault(f"`{text_of(self.value)}` stands where a whole number belongs") from None

    def literal(self) -> Literal:
        """The value as a literal.

        Raises:
            ShapeFault: where it is none.

        """
        if not isinstance(self.value, Literal):
            raise self.fault(f"the value of sh:{self.name} is no literal")
        return self.value

    def items(self) -> list[Term]:
        """The members of the list that the value is.

        Raises:
            ShapeFault: where it is none.

        """
        members = self.reader.graph.items(self.value)
        if members is None:
            raise self.fault("a list in this shape does not end")
        return members

    def referred(self) -> Term:
        """The value as a shape.

        Raises:
            ShapeFault: where it is a literal.

        """
        if isinstance(self.value, (Literal, Triple)):
            raise self.fault(f"the value of sh:{self.name} is no shape")
        return self.reader.shape(self.value)

    def others(self, name: str) -> list[Term]:
        """The shape's values of another parameter."""
        return self.reader.values(self.shape, name)


@lru_cache(maxsize=256)
def _fault(text: str, prefixes: tuple[tuple[str, str], ...]) -> Fault | None:
    return query_fault(text, dict(prefixes), declare=_DECLARE)


def local(iri: str) -> str:
    """An IRI of the SHACL namespace without it; any other as it is."""
    return iri.removeprefix(SH)
