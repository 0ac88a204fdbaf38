"""One side of a comparison: Turtle files, folders, or what a git revision held, as descriptions of terms.

A blank node is described by its statements, so two files that differ only in its label or place are equal.
"""

from __future__ import annotations

import io
import subprocess
import tarfile
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import cast

from pyoxigraph import BlankNode, Literal, NamedNode, Store

from onto_compiler.emit.turtle import iri_text, term_text
from onto_compiler.problems import OntoError, Problem
from onto_compiler.rdf import BASE, OWL, RDF, RDFS, SH, node
from onto_compiler.sources import collect, load_store, read_into

__all__ = ["DISJOINT", "Side", "read_side"]

Term = NamedNode | BlankNode | Literal

DISJOINT = OWL + "disjointWith"
_TYPE = node(RDF + "type")
_NO_MEANING = {
    SH + "message", SH + "name", SH + "description", RDFS + "comment", BASE + "shapes#hint", BASE + "shapes#code",
}  # fmt: skip
_DEPTH = 12


@dataclass(frozen=True, slots=True)
class Side:
    """``terms``: IRI -> predicate IRI -> values as Turtle texts, blank nodes in brackets.

    ``ontology``: the IRI of the ontology whose file holds a term; ``versions``: its ``owl:versionInfo``, or nothing;
    ``above``: a class with all its superclasses, those of the shipped ontology among them.
    """

    terms: Mapping[str, Mapping[str, frozenset[str]]]
    ontology: Mapping[str, str]
    versions: Mapping[str, str]
    above: Mapping[str, frozenset[str]]


def read_side(given: str) -> Side:
    """Read a file, a folder, or ``REVISION:PATH`` of the git repository around the working directory.

    Raises:
        OntoError: TTL0nn, for what is missing or is not Turtle; SCH005, where git cannot give it.
    """
    revision, colon, path = given.partition(":")
    if Path(given).exists() or not colon or not revision:
        return _side([Path(given)])
    with tempfile.TemporaryDirectory() as folder:
        _extract(revision, path or ".", folder)
        root = Path(folder).resolve()
        try:
            return _side([root / path])
        except OntoError as error:
            raise OntoError(*(_placed(problem, f"{root}/", f"{revision}:") for problem in error.problems)) from None


def _placed(problem: Problem, root: str, revision: str) -> Problem:
    """Name the file as the person did, not where it was unpacked."""
    return replace(problem, file=problem.file.replace(root, revision), message=problem.message.replace(root, revision))


def _extract(revision: str, path: str, folder: str) -> None:
    # A revision that begins with a dash would be an option.
    command = ["git", "archive", "--format=tar", "--end-of-options", revision, path]
    try:
        done = subprocess.run(command, capture_output=True, check=False)  # noqa: S603 - no shell reads it
    except OSError as error:
        raise OntoError.of("SCH005", f"git cannot be run: {error.strerror}", "give files or folders") from error
    if done.returncode:
        reason = done.stderr.decode(errors="replace").strip().partition("\n")[0].removeprefix("fatal: ")
        hint = "give REVISION:PATH, the path as seen from the working directory, or files"
        raise OntoError.of("SCH005", f"git has no `{path}` of `{revision}`: {reason}", hint)
    with tarfile.open(fileobj=io.BytesIO(done.stdout)) as archive:
        for member in archive:
            if (content := archive.extractfile(member)) is not None:
                file = Path(folder, member.name)
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(content.read())


def _side(paths: list[Path]) -> Side:
    store = Store()
    problems = [problem for path in collect(paths) for problem in read_into(store, path)]
    if problems:
        raise OntoError(*problems)
    headers = {
        str(quad.graph_name): quad.subject.value
        for quad in store.quads_for_pattern(None, _TYPE, node(OWL + "Ontology"), None)
        if isinstance(quad.subject, NamedNode)
    }
    terms: dict[str, dict[str, set[str]]] = {}
    ontology: dict[str, str] = {}
    for quad in store:
        if isinstance(quad.subject, NamedNode):
            values = terms.setdefault(quad.subject.value, {}).setdefault(quad.predicate.value, set())
            values.add(_text(store, cast("Term", quad.object), _DEPTH))
            ontology.setdefault(quad.subject.value, headers.get(str(quad.graph_name), ""))
    for one, other in _disjoint(store):
        terms.setdefault(one, {}).setdefault(DISJOINT, set()).add(iri_text(other))
    for iri, about in terms.items():
        for reason in about.get(RDFS + "isDefinedBy", ()):
            if reason.startswith("<"):
                ontology[iri] = reason[1:-1]
    versions = {iri: _first(store, iri, OWL + "versionInfo") for iri in headers.values()}
    frozen = {iri: {name: frozenset(values) for name, values in about.items()} for iri, about in terms.items()}
    return Side(frozen, ontology, versions, _closure(store))


def _first(store: Store, iri: str, predicate: str) -> str:
    values = (quad.object for quad in store.quads_for_pattern(node(iri), node(predicate), None, None))
    return min((value.value for value in values if isinstance(value, Literal)), default="")


def _text(store: Store, term: Term, depth: int) -> str:
    if not isinstance(term, BlankNode):
        return term_text(term)
    if depth == 0:
        return "[...]"
    if any(True for _ in store.quads_for_pattern(term, node(RDF + "first"), None, None)):
        return f"( {' '.join(_text(store, member, depth - 1) for member in _items(store, term))} )"
    parts = sorted(
        f"{iri_text(quad.predicate.value)} {_text(store, cast('Term', quad.object), depth - 1)}"
        for quad in store.quads_for_pattern(term, None, None, None)
        if quad.predicate.value not in _NO_MEANING
    )
    return f"[ {' ; '.join(parts)} ]"


def _items(store: Store, head: Term) -> Iterator[Term]:
    seen: set[Term] = set()
    while isinstance(head, BlankNode) and head not in seen:
        seen.add(head)
        firsts = store.quads_for_pattern(head, node(RDF + "first"), None, None)
        yield from (cast("Term", quad.object) for quad in firsts)
        rests = store.quads_for_pattern(head, node(RDF + "rest"), None, None)
        head = next((cast("Term", quad.object) for quad in rests), node(RDF + "nil"))


def _disjoint(store: Store) -> set[tuple[str, str]]:
    """Every pair of classes that an axiom says to share no member, once and in alphabetical order."""
    groups = [
        {member.value for member in _items(store, cast("Term", quad.object)) if isinstance(member, NamedNode)}
        for kind in (OWL + "members", OWL + "disjointUnionOf")
        for quad in store.quads_for_pattern(None, node(kind), None, None)
    ]
    groups += [
        {quad.subject.value, quad.object.value}
        for quad in store.quads_for_pattern(None, node(DISJOINT), None, None)
        if isinstance(quad.subject, NamedNode) and isinstance(quad.object, NamedNode)
    ]
    return {pair for group in groups for pair in combinations(sorted(group), 2)}


def _closure(store: Store) -> dict[str, frozenset[str]]:
    direct: dict[str, set[str]] = {}
    for source in (store, load_store()):
        for quad in source.quads_for_pattern(None, node(RDFS + "subClassOf"), None, None):
            if isinstance(quad.subject, NamedNode) and isinstance(quad.object, NamedNode):
                direct.setdefault(quad.subject.value, set()).add(quad.object.value)
    found = {}
    for start in direct:
        reached, todo = {start}, [start]
        while todo:
            fresh = direct.get(todo.pop(), set()) - reached
            reached |= fresh
            todo += fresh
        found[start] = frozenset(reached)
    return found
