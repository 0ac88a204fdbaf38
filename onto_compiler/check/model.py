"""What ``onto check`` looks at: the files to report on, and the shipped ontology behind them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import cast

from pyoxigraph import NamedNode, Quad, QuerySolutions, Store

import ontology
from onto_compiler.check.finding import Term
from onto_compiler.problems import OntoError, Problem
from onto_compiler.rdf import OWL, RDF, prologue
from onto_compiler.reasoning.axioms import Axioms, read_axioms
from onto_compiler.shacl.graph import Graph
from onto_compiler.sources import collect, graph_of, read_into

__all__ = ["Model", "load_model"]

_IS_ONTOLOGY = (NamedNode(RDF + "type"), NamedNode(OWL + "Ontology"))


@dataclass(frozen=True)
class Model:
    """``store`` holds one named graph per file; ``files`` are those that problems are reported for."""

    store: Store
    files: tuple[Path, ...]
    background: tuple[Path, ...] = ()
    texts: dict[Path, str] = field(default_factory=dict)
    written: tuple[Quad, ...] = ()  # what the store holds, with literals as the files spell them

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
) -> Model:
    """Load ``paths`` with the shipped ontology behind them; without paths, the shipped ontology is what is reported on.

    A given file that declares the same ``owl:Ontology`` as a shipped one takes its place, so that a copy can be edited.
    ``texts`` holds what some of the files (by resolved path) are to be, where that is not what is on disk.

    Given a list ``unreadable``, what is wrong with files that cannot be read is added to it, and the model is that of
    the others.

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
    written: list[Quad] = []
    read = []
    for path in files:
        faults = read_into(store, path, texts.get(path), written)
        problems += faults
        if not faults:
            read.append(path)
    if problems and unreadable is None:
        raise OntoError(*problems)
    if unreadable is not None:
        unreadable += problems
        problems = []
    declared = {quad.subject for quad in store.quads_for_pattern(None, *_IS_ONTOLOGY, None)}
    background = []
    for path in shipped:
        if path in files:
            continue
        own: list[Quad] = []
        problems += read_into(store, path, written=own)
        graph = graph_of(path)
        if any(quad.subject in declared for quad in store.quads_for_pattern(None, *_IS_ONTOLOGY, graph)):
            store.remove_graph(graph)
        else:
            background.append(path)
            written += own
    if problems:
        raise OntoError(*problems)
    return Model(store, tuple(read), tuple(background), dict(texts), tuple(written))
