"""Looking things up in a shapes graph, with a fault that names the shape where something is not as it must be."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from pyoxigraph import BlankNode, Literal, NamedNode

from onto_compiler.rdf import BASE, OWL, RDF, RDFS, SH, XSD
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.model import ShapeFault
from onto_compiler.shacl.paths import Path, sparql_path
from onto_compiler.sparql import refusal

__all__ = ["Parameter", "Reader", "local", "shown"]

_KNOWN = {"rdf": RDF, "rdfs": RDFS, "xsd": XSD, "sh": SH}
_IMPORTS = NamedNode(OWL + "imports")
_QUERIES = ("ask", "construct", "select", "update")
_ANY_PATH = Path("predicate", NamedNode("urn:onto-evwm:path"))
_PATH = re.compile(r"[$?]PATH\b")
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
        """Whether ``sh:name`` is true."""
        return any(value.value == "true" for value in self.values(node, name))

    def texts(self, node: Term) -> tuple[str, str, str]:
        """Message, code and hint that a shape or constraint gives."""
        return self.text(node, "message"), self.text(node, _CODE), self.text(node, _HINT)

    def prefixes(self, node: Term) -> str:
        """The PREFIX lines that ``sh:prefixes`` of ``node`` stands for, imported ontologies included."""
        found: dict[str, str] = {}
        todo, seen = self.values(node, "prefixes"), set[Term]()
        while todo:
            header = todo.pop()
            if header in seen:
                continue
            seen.add(header)
            todo += self.values(header, _IMPORTS)
            for declaration in self.values(header, "declare"):
                prefix, namespace = self.one(declaration, "prefix"), self.one(declaration, "namespace")
                if prefix is not None and namespace is not None:
                    found[prefix.value] = namespace.value
        return "".join(f"PREFIX {prefix}: <{namespace}>\n" for prefix, namespace in sorted(found.items()))

    def query(self, node: Term, name: str, path: Path | None = None) -> str | None:
        """The query ``sh:name`` of ``node`` as it is asked: prefixes in front, ``path`` in place of ``$PATH``.

        This is the only way from a shapes graph to a query. None if there is none.

        Raises:
            ShapeFault: the query must not be run (QRY001 to QRY003), needs a path that ``node`` lacks, or mentions
                SERVICE and is not SPARQL.

        """
        text = self.one(node, name)
        if text is None:
            return None
        body = text.value
        if _PATH.search(body):
            if path is None:
                raise ShapeFault("`$PATH` stands in a query of a shape without a path", node, name, text)
            body = _PATH.sub(lambda _: sparql_path(path), body)
        whole = self.prefixes(node) + body
        try:
            refused = refusal(whole)
        except SyntaxError as error:
            reason = " ".join(str(error).partition(", [")[0].split())
            raise ShapeFault(f"the query is not SPARQL: {reason}", node, name, text) from error
        if refused is None:
            return whole
        place = refused.place(text.value)
        raise ShapeFault(refused.message, node, name, text, code=refused.code, hint=refused.hint, inside=place)

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
            return int(self.value.value)
        except ValueError:
            raise self.fault(f"`{self.value.value}` stands where a whole number belongs") from None

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
        if isinstance(self.value, Literal):
            raise self.fault(f"the value of sh:{self.name} is no shape")
        return self.reader.shape(self.value)

    def others(self, name: str) -> list[Term]:
        """The shape's values of another parameter."""
        return self.reader.values(self.shape, name)


def local(iri: str) -> str:
    """An IRI of the SHACL namespace without it; any other as it is."""
    return iri.removeprefix(SH)


def shown(term: Term) -> str:
    """A term as a sentence names it."""
    if isinstance(term, BlankNode):
        return "a blank node"
    if isinstance(term, Literal):
        return f"`{term.value}`"
    for prefix, namespace in _KNOWN.items():
        if term.value.startswith(namespace):
            return f"`{prefix}:{term.value[len(namespace) :]}`"
    return f"`{term.value.rpartition('#')[2].rpartition('/')[2] or term.value}`"
