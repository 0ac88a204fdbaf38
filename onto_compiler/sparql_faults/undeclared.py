"""Names in a query that no vocabulary declares: SPARQL accepts them, and they match nothing."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cached_property
from typing import Protocol

from pyoxigraph import NamedNode, Store

from onto_compiler.rdf import OWL, RDF, RDFS, namespace_of
from onto_compiler.sparql_faults.fault import Fault, fault_at
from onto_compiler.terms import show
from onto_compiler.turtle.tokens import Token, tokens
from onto_compiler.vocabularies import meant

__all__ = ["StoreVocabulary", "Vocabulary", "undeclared"]

_NAME = re.compile(r"(?<![\w?$])([^\W\d_][\w.\-]*)?:([\w%\\:][\w.\-%\\:]*)?|<([^<>\"{}|^`\\\s]+)>")
_ELSEWHERE = 0.8  # how similar a name of another namespace must be
_DEFINED_BY, _TYPE = NamedNode(RDFS + "isDefinedBy"), NamedNode(RDF + "type")


class Vocabulary(Protocol):
    """The terms that are declared, as far as their namespace is known."""

    def knows(self, iri: str) -> bool:
        """Whether a term is declared or used, or lies in a namespace of which nothing is known."""

    def declared(self) -> Iterable[str]:
        """The declared terms."""


@dataclass(frozen=True)
class StoreVocabulary:
    """What the graphs of a store declare; the namespaces are those of terms with an ``rdfs:isDefinedBy``."""

    store: Store

    def knows(self, iri: str) -> bool:
        """Whether the store has a triple with the term, or declares nothing in its namespace."""
        term = NamedNode(iri)
        found = self.store.quads_for_pattern
        uses = (found(term, None, None, None), found(None, None, term, None), found(None, term, None, None))
        if any(next(use, None) is not None for use in uses):
            return True
        return namespace_of(iri) not in self._namespaces

    def declared(self) -> Iterable[str]:
        """The terms that the store defines, classes and properties first."""
        return self._declared

    @cached_property
    def _declared(self) -> list[str]:
        defined = {quad.subject for quad in self.store.quads_for_pattern(None, _DEFINED_BY, None, None)}
        named = (term for term in defined if isinstance(term, NamedNode))
        return [
            term.value for term in sorted(named, key=lambda term: (not self._is_class_or_property(term), str(term)))
        ]

    def _is_class_or_property(self, term: NamedNode) -> bool:
        kinds = (quad.object for quad in self.store.quads_for_pattern(term, _TYPE, None, None))
        return any(isinstance(kind, NamedNode) and kind.value.startswith((OWL, RDF, RDFS)) for kind in kinds)

    @cached_property
    def _namespaces(self) -> set[str]:
        return set(map(namespace_of, self._declared))


def undeclared(query: str, prefixes: Mapping[str, str], vocabulary: Vocabulary) -> Iterator[tuple[str, Fault]]:
    """Each undeclared IRI that ``query``, which is SPARQL, names, with a fault at its first use.

    VOC011 is for a namespace of the standard vocabularies, VOC001 for one that ``vocabulary`` declares.
    ``prefixes`` need no declaration in the query.
    """
    if not any(_is_unknown(iri, vocabulary) for iri in _candidates(query, prefixes)):
        return
    seen: set[str] = set()
    for token, iri in _named(list(tokens(query)), prefixes):
        if iri in seen or not _is_unknown(iri, vocabulary):
            continue
        seen.add(iri)
        hint = meant(iri)
        if hint is not None:
            yield iri, _fault(token, f"`{token.text}` is no term of its vocabulary", hint, "VOC011")
            continue
        similar = _similar(iri, vocabulary.declared())
        question = f"did you mean `{_shown(similar, prefixes)}`? Otherwise: " if similar else ""
        hint = f"{question}correct the name, or declare the term"
        yield iri, _fault(token, f"`{token.text}` is not declared", hint, "VOC001")


def _similar(iri: str, declared: Iterable[str]) -> str:
    """The term that is meant: the same name elsewhere, or a similar one in the namespace, or else anywhere."""
    namespace, terms = namespace_of(iri), dict[str, list[str]]()
    for term in declared:
        terms.setdefault(term.removeprefix(namespace_of(term)), []).append(term)
    name = iri.removeprefix(namespace)
    same = next((one for one in terms if one.lower() == name.lower()), None)
    beside = [one for one, found in terms.items() if any(namespace_of(term) == namespace for term in found)]
    close = [same] if same else get_close_matches(name, beside, 1) or get_close_matches(name, terms, 1, _ELSEWHERE)
    if not close:
        return ""
    return next((term for term in terms[close[0]] if namespace_of(term) == namespace), terms[close[0]][0])


def _shown(iri: str, prefixes: Mapping[str, str]) -> str:
    return show(NamedNode(iri), prefixes.items())


def _fault(token: Token, message: str, hint: str, code: str) -> Fault:
    found = fault_at(token, message, hint)
    return Fault(found.message, found.hint, found.start, found.length, code)


def _is_unknown(iri: str, vocabulary: Vocabulary) -> bool:
    try:
        return meant(iri) is not None or not vocabulary.knows(iri)
    except ValueError:  # no absolute IRI, which can be in no vocabulary
        return False


def _candidates(query: str, prefixes: Mapping[str, str]) -> Iterator[str]:
    """Every IRI that the query may name, those of its comments and texts included: to look is faster than to parse."""
    known = {**prefixes, **dict(re.findall(r"(?i)\bPREFIX\s+([\w.\-]*):\s*<([^<>]*)>", query))}
    for prefix, local, iri in set(_NAME.findall(query)):
        if iri or (local and prefix in known):
            yield iri or known[prefix] + local.rstrip(".").replace("\\", "")


def _named(read: list[Token], prefixes: Mapping[str, str]) -> Iterator[tuple[Token, str]]:
    """The IRIs behind the prologue, each with its token."""
    known = dict(prefixes)
    for at, token in enumerate(read):
        before = [one.text.upper() for one in read[max(at - 2, 0) : at] if one.kind in {"word", "name"}]
        if token.kind == "name":
            prefix, _, local = token.text.partition(":")
            if before[-1:] == ["PREFIX"]:
                known[prefix] = read[at + 1].text[1:-1] if at + 1 < len(read) else ""
            elif local and prefix in known:
                yield token, known[prefix] + local.replace("\\", "")
        elif token.kind == "iri" and not {"PREFIX", "BASE"} & set(before):
            yield token, token.text[1:-1]
