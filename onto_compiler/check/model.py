"""What ``onto check`` looks at: the files to report on, and the shipped ontology behind them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import cast

from pyoxigraph import NamedNode, Quad, QuerySolutions, RdfFormat, Store

import ontology
from onto_compiler.check.documents import Document
from onto_compiler.check.finding import Term
from onto_compiler.check.imports import UNKNOWN, Imports
from onto_compiler.problems import OntoError, Problem
from onto_compiler.rdf import OWL, RDF, prologue
from onto_compiler.reasoning.axioms import Axioms, read_axioms
from onto_compiler.shacl.graph import Graph
from onto_compiler.sources import collect, graph_of, read_into, size_problem

__all__ = ["Model", "load_model"]

_IS_ONTOLOGY = (NamedNode(RDF + "type"), NamedNode(OWL + "Ontology"))
_IMPORTS, _VERSION = NamedNode(OWL + "imports"), NamedNode(OWL + "versionIRI")


@dataclass(frozen=True)
class Model:
    """``store`` holds one named graph per file; ``files`` are those that problems are reported for.

    ``imported`` are those that they import, apart from them and from the shipped ontology.
    """

    store: Store
    files: tuple[Path, ...]
    background: tuple[Path, ...] = ()
    texts: dict[Path, str] = field(default_factory=dict)
    written: tuple[Quad, ...] = ()  # what the store holds, with literals as the files spell them
    imported: tuple[Path, ...] = ()
    lead: Imports = field(default_factory=Imports)

    @cached_property
    def graphs(self) -> Mapping[NamedNode, Path]:
        """The graph of each reported file."""
        return {graph_of(path): path for path in self.files}

    @cached_property
    def graph(self) -> Graph:
        """All files together, for shapes."""
        return Graph(self.written, self.store)

    @cached_property
    def axioms(self) -> Axioms:
        """What all files say of classes, properties and individuals."""
        return read_axioms(self.store)

    @cached_property
    def unresolved(self) -> Mapping[NamedNode, str]:
        """The imports that lead to no file, each with the reason; an empty one where nothing is known of it."""
        missed = (one for one in _unresolved(self.store) if one.value not in self.lead.followed)
        return {one: self.lead.missed.get(one.value, UNKNOWN).replace(UNKNOWN, "") for one in missed}

    @cached_property
    def triples(self) -> int:
        """How many triples the reported files hold."""
        return sum(1 for graph in self.graphs for _ in self.store.quads_for_pattern(None, None, None, graph))

    def rows(self, query: str) -> Iterator[Mapping[str, Term]]:
        """The solutions of a SELECT over all files, with the usual prefixes; unbound variables are left out."""
        solutions = cast("QuerySolutions", self.store.query(prologue() + query, use_default_graph_as_union=True))
        names = [variable.value for variable in solutions.variables]
        for solution in solutions:
            yield {name: cast("Term", solution[name]) for name in names if solution[name] is not None}

    def text(self, path: Path) -> str:
        """A reported file's text, read once; an unreadable file has none."""
        if path not in self.texts:
            try:
                self.texts[path] = path.read_bytes().decode("utf-8-sig")
            except (OSError, UnicodeDecodeError):
                self.texts[path] = ""
        return self.texts[path]


def load_model(
    paths: Sequence[Path | str] = (),
    texts: Mapping[Path, str] | None = None,
    unreadable: list[Problem] | None = None,
    lead: Imports | None = None,
) -> Model:
    """Load ``paths`` with the shipped ontology behind them; without paths, the shipped ontology is what is reported on.

    A given file that declares the same ``owl:Ontology`` as a shipped one takes its place, so that a copy can be edited.
    ``texts`` holds what some of the files (by resolved path) are to be, where that is not what is on disk.

    Given a list ``unreadable``, what is wrong with files that cannot be read is added to it, and the model is that of
    the others. Given ``lead``, imports that are in none of these files are followed.

    Raises:
        OntoError: TTL0nn, for every file that is missing or is not Turtle.

    """
    shipped = ontology.turtle_files()
    texts = texts or {}
    given = [path for path in paths if Path(path).resolve() not in texts]
    edited = [Path(path).resolve() for path in paths if Path(path).resolve() in texts]  # perhaps not on disk yet
    files = tuple(dict.fromkeys([*collect(given), *edited])) if paths else shipped
    store = Store()
    problems: list[Problem] = []
    read: list[Document] = []
    for path in files:
        problems += _read(store, path, read, texts.get(path))
    if problems and unreadable is None:
        raise OntoError(*problems)
    if unreadable is not None:
        unreadable += problems
        problems = []
    behind: list[Document] = []
    for path in shipped:
        if path not in files:
            problems += _read(store, path, behind)
    if problems:
        raise OntoError(*problems)
    _give_way(store, behind, read)
    imported = () if lead is None else _follow(store, lead, (*read, *behind))
    _give_way(store, behind, imported)
    if lead is not None and unreadable is not None:
        unreadable += (*lead.unreadable, *lead.problems)
    return Model(
        store,
        _paths(read),
        _paths(behind),
        dict(texts),
        tuple(cast("Quad", quad) for document in (*read, *behind, *imported) for quad in document.statements),
        _paths(imported),
        lead or Imports(),
    )


def _read(store: Store, path: Path, read: list[Document], text: str | None = None) -> list[Problem]:
    """Load a file and append it to ``read``, or return what is wrong with it."""
    if text is None and (large := size_problem(path)) is not None:
        return [large]
    quads: list[Quad] = []
    problems = read_into(store, path, text, quads)
    if not problems:
        read.append(Document(path, RdfFormat.TURTLE, tuple(quads)))
    return problems


def _give_way(store: Store, shipped: list[Document], given: Sequence[Document]) -> None:
    """Remove the shipped files whose ontology a given file declares."""
    declared = {name for document in given for name in _ontologies(store, graph_of(document.path))}
    for document in [one for one in shipped if declared & _ontologies(store, graph_of(one.path))]:
        store.remove_graph(graph_of(document.path))
        shipped.remove(document)


def _follow(store: Store, lead: Imports, documents: Sequence[Document]) -> tuple[Document, ...]:
    """The imports of ``documents`` that are in none of them, which ``store`` then holds too."""
    if not lead.mapped and not _unresolved(store):
        return ()
    lead.declare(documents)
    known = {document.path for document in documents}
    found = []
    for document in lead.closed(documents):
        if document.path not in known:
            graph = graph_of(document.path)
            quads = tuple(Quad(one.subject, one.predicate, one.object, graph) for one in document.statements)
            store.extend(quads)
            found.append(replace(document, statements=quads))
    return tuple(found)


def _paths(documents: Sequence[Document]) -> tuple[Path, ...]:
    return tuple(document.path for document in documents)


def _ontologies(store: Store, graph: NamedNode | None = None) -> set[object]:
    return {quad.subject for quad in store.quads_for_pattern(None, *_IS_ONTOLOGY, graph)}


def _unresolved(store: Store) -> list[NamedNode]:
    """The imports that no file declares, nor is a version of."""
    versions = {quad.object for quad in store.quads_for_pattern(None, _VERSION, None, None)}
    wanted = {quad.object for quad in store.quads_for_pattern(None, _IMPORTS, None, None)}
    return sorted(
        (one for one in wanted - versions - _ontologies(store) if isinstance(one, NamedNode)),
        key=lambda one: one.value,
    )
