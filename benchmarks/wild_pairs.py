"""Generated shapes and data validated twice, by ``onto check --shapes`` and by pySHACL, and the two reports compared.

pySHACL reads no triple terms: in the files that it is given each stands as an IRI, and their shapes test nothing that
looks into a term.
"""

from __future__ import annotations

import contextlib
import io
import logging
import re
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pyoxigraph import BlankNode, Literal, NamedNode, RdfFormat, Triple, parse

from benchmarks.wild_corrections import CORRECTIONS, corrected
from benchmarks.wild_shapes import PREFIXES, Pair
from onto_compiler.check.data import check_data
from onto_compiler.rdf import RDFS, SH
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.paths import read_path, sparql_path
from onto_compiler.shacl.report import report

__all__ = ["Answer", "Compared", "Row", "by_pyshacl", "compare", "ours", "read_report", "write"]

_TRIPLE_TERM = re.compile(r"<<\( (\S+) (\S+) (\S+) \)>>")
_CONFORMS, _RESULT, _LABEL = NamedNode(SH + "conforms"), NamedNode(SH + "result"), NamedNode(RDFS + "label")
_COMPARED = ("focusNode", "resultPath", "value", "sourceConstraintComponent", "resultSeverity", "sourceShape")
Row = tuple[str, ...]  # in the order of `_COMPARED`


@dataclass(frozen=True, slots=True)
class Answer:
    """What an engine says: whether the data conform, and its results; or why it cannot run."""

    conforms: bool = False
    results: frozenset[Row] = frozenset()
    refused: str = ""

    def agrees(self, other: Answer) -> bool:
        """Whether both have the same results, or both refuse the shapes."""
        if self.refused or other.refused:
            return bool(self.refused) and bool(other.refused)
        return (self.conforms, self.results) == (other.conforms, other.results)


@dataclass(frozen=True, slots=True)
class Compared:
    """What both say of a pair: the names of what explains a difference, or in ``unexplained`` where they differ."""

    ours: Answer
    theirs: Answer
    explained: tuple[str, ...] = ()
    unexplained: tuple[str, ...] = ()


def compare(pair: Pair, folder: Path) -> Compared:
    """Validate a pair in ``folder`` by both; where they differ, find the fewest corrections after which they agree."""
    write(pair, folder)
    mine, theirs = ours(folder), by_pyshacl(folder)
    if mine.agrees(theirs):
        return Compared(mine, theirs)

    def suffice(names: Iterable[str]) -> bool:
        return mine.agrees(by_pyshacl(folder, names))

    for name in CORRECTIONS:
        if suffice([name]):
            return Compared(mine, theirs, (name,))
    if not suffice(CORRECTIONS):
        return Compared(mine, theirs, unexplained=tuple(_difference(mine, by_pyshacl(folder, CORRECTIONS))))
    needed = list(CORRECTIONS)
    for name in CORRECTIONS:
        fewer = [one for one in needed if one != name]
        needed = fewer if suffice(fewer) else needed
    return Compared(mine, theirs, tuple(needed))


def _difference(mine: Answer, theirs: Answer) -> Iterator[str]:
    for who, one, other in (("we", mine, theirs), ("pySHACL", theirs, mine)):
        if one.refused:
            yield f"{who} refused: {one.refused}"
        for row in sorted(one.results - other.results):
            yield f"only {who}: {' '.join(row)}"


def write(pair: Pair, folder: Path) -> None:
    """Write the pair's files below ``folder``, and what pySHACL reads of them below its ``plain``."""
    for name, text in pair.files.items():
        for path, written in ((folder / name, text), (folder / "plain" / name, _TRIPLE_TERM.sub(_as_iri, text))):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(written, encoding="utf-8")


def _as_iri(match: re.Match[str]) -> str:
    (term,) = parse(f"{PREFIXES} ex:a ex:p {match[0]} .", format=RdfFormat.TURTLE)
    return _iri_of(term.object)


def _iri_of(term: Term) -> str:
    return f"<https://example.org/triple_{str(term).encode().hex()}>"


def ours(folder: Path) -> Answer:
    """What ``onto check data.ttl --shapes shapes.ttl`` finds in ``folder``."""
    found = check_data([folder / "data.ttl"], [folder / "shapes.ttl"])
    refused = "; ".join(problem.message for problem in found.problems if problem.code not in {"SHP001", "IMP001"})
    if found.validation is None:
        return Answer(refused=refused or "not validated")
    validated = found.validation
    if not validated.complete:
        return Answer(refused=refused)
    return read_report(report(validated.results, validated.shapes))


def by_pyshacl(folder: Path, corrections: Iterable[str] = ()) -> Answer:
    """What pySHACL finds in the same files, with advanced features on, and corrected in these points."""
    import pyshacl  # noqa: PLC0415 - a second to import, where pairs are compared
    import rdflib  # noqa: PLC0415

    corrections = tuple(corrections)

    plain = folder / "plain"
    options: dict[str, Any] = {"inference": "none", "advanced": True, "meta_shacl": False, "do_owl_imports": True}
    # Without a correction pySHACL tries every way through recursive shapes, up to this depth.
    options |= {"max_validation_depth": 100 if "recursion" in corrections else 20}
    before, rdflib.NORMALIZE_LITERALS = rdflib.NORMALIZE_LITERALS, False
    logging.disable(logging.CRITICAL)
    try:
        with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()), corrected(*corrections):
            warnings.simplefilter("ignore")
            data = rdflib.Graph()
            for file in (plain / "data.ttl", *sorted(plain.glob("lib/data.ttl"))):
                data.parse(file, format="turtle")
            conforms, graph, _ = pyshacl.validate(data, shacl_graph=str(plain / "shapes.ttl"), **options)
    except Exception as error:  # noqa: BLE001 - whatever it raises is its answer
        return Answer(refused=f"{type(error).__name__}: {error}".splitlines()[0])
    finally:
        rdflib.NORMALIZE_LITERALS = before
        logging.disable(logging.NOTSET)
    if not isinstance(graph, rdflib.Graph):
        return Answer(refused=str(graph))
    found = read_report(parse(graph.serialize(format="nt"), format=RdfFormat.N_TRIPLES))
    return Answer(bool(conforms), found.results)


def read_report(triples: Iterable[Any]) -> Answer:
    """A validation report (SHACL, section 3.6); what is given as the detail of a result is no result of its own."""
    graph = Graph(triples)
    (conforms,) = graph.values(_CONFORMS)
    rows = frozenset(_row(graph, node) for nodes in graph.holders(_RESULT).values() for node in nodes)
    return Answer(conforms == Literal(True), rows)


def _row(graph: Graph, result: Term) -> Row:
    return tuple("|".join(sorted(_names(graph, result, name))) for name in _COMPARED)


def _names(graph: Graph, result: Term, name: str) -> Iterator[str]:
    for term in graph.objects(result, NamedNode(SH + name)):
        if name == "resultPath":
            path = read_path(graph, term)
            yield str(term) if path is None else sparql_path(path)
        elif isinstance(term, Triple):
            yield _iri_of(term)
        elif isinstance(term, BlankNode):
            yield from (str(label) for label in graph.objects(term, _LABEL) or ("blank",))
        else:
            yield str(term)
