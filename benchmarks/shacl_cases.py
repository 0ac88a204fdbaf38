"""The W3C's SHACL test suite and the DASH rule cases, read from pySHACL's source archive as data.

Source: https://w3c.github.io/data-shapes/data-shapes-test-suite/ for what a manifest says and how reports are compared.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote, urlparse

from pyoxigraph import (
    BlankNode,
    CanonicalizationAlgorithm,
    Dataset,
    NamedNode,
    Quad,
    RdfFormat,
    Triple,
    parse,
)

from benchmarks.archives import fetch
from onto_compiler.problems import OntoError
from onto_compiler.rdf import OWL, RDF, SH
from onto_compiler.shacl.compile import compile_graph
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.model import ShapeResult
from onto_compiler.shacl.paths import describe, read_path
from onto_compiler.shacl.rules import read_rule_base
from onto_compiler.shacl.validate import validate_graph
from onto_compiler.terms import text_of

__all__ = ["RuleCase", "ShaclCase", "corpus", "rule_cases", "run_rule_case", "run_shacl_case", "shacl_cases"]

_SHA256 = "011e3cf1a68b31747cb762ba3d755ae1bdcc464c8fad0dc212a9adc550719552"
_MF = "http://www.w3.org/2001/sw/DataAccess/tests/test-manifest#"
_SHT = "http://www.w3.org/ns/shacl-test#"
_DASH = "http://datashapes.org/dash#"
_INCLUDE, _ENTRIES, _ACTION, _RESULT = (NamedNode(_MF + name) for name in ("include", "entries", "action", "result"))
_DATA, _SHAPES, _VALIDATE, _FAILURE = (
    NamedNode(_SHT + name) for name in ("dataGraph", "shapesGraph", "Validate", "Failure")
)
_TYPE, _IMPORTS = NamedNode(RDF + "type"), NamedNode(OWL + "imports")
_COMPARED = ("focusNode", "value", "sourceConstraintComponent", "sourceShape", "resultSeverity")


@dataclass(frozen=True, slots=True)
class ShaclCase:
    """One entry of a manifest; ``iri`` is relative to the suite's folder."""

    iri: str
    file: Path
    node: NamedNode


@dataclass(frozen=True, slots=True)
class RuleCase:
    """One ``dash:InferencingTestCase``; ``iri`` is its own."""

    iri: str
    file: Path


def corpus() -> Path:
    """The folder that holds both suites; the archive is downloaded on the first call."""
    requirement, prefix = "pyshacl==0.40.1", "pyshacl-0.40.1/test/resources"
    return fetch(requirement, "pyshacl-0.40.1.tar.gz", _SHA256, prefix)


def _read(path: Path) -> Graph:
    found = parse(path=path, format=RdfFormat.TURTLE, base_iri=path.as_uri())
    return Graph(found)


def _path_of(iri: str) -> Path:
    return Path(unquote(urlparse(iri).path))


def shacl_cases(root: Path) -> Iterator[ShaclCase]:
    """Every entry of the W3C's manifests below ``root``, in the order of the manifests."""
    yield from _entries(root / "sht_tests" / "manifest.ttl", root / "sht_tests")


def _entries(path: Path, root: Path) -> Iterator[ShaclCase]:
    graph = _read(path)
    manifest = NamedNode(path.as_uri())
    for head in graph.objects(manifest, _ENTRIES):
        for entry in graph.items(head) or ():
            if isinstance(entry, NamedNode) and (entry, _TYPE, _VALIDATE) in graph:
                name = entry.value.removeprefix(root.as_uri() + "/")
                yield ShaclCase(name, path, entry)
    for included in graph.objects(manifest, _INCLUDE):
        yield from _entries(_path_of(text_of(included)), root)


def run_shacl_case(case: ShaclCase) -> str:
    """What is wrong with our report, as a sentence; empty if it is the expected one."""
    manifest = _read(case.file)
    (action,) = manifest.objects(case.node, _ACTION)
    (expected,) = manifest.objects(case.node, _RESULT)
    files = [_path_of(text_of(next(iter(manifest.objects(action, part))))) for part in (_DATA, _SHAPES)]
    graphs = {path: manifest if path == case.file else _read(path) for path in set(files)}
    data, shapes_graph = (graphs[path] for path in files)
    try:
        results = validate_graph(data, compile_graph(shapes_graph))
    except OntoError as error:
        return "" if expected == _FAILURE else f"cannot run: {error}"
    if expected == _FAILURE:
        return "runs where it must not"
    own = set(files) == {case.file}
    wanted = list(_expected(manifest, expected, own=own))
    found = list(_reported(shapes_graph, results, own=own))
    conforms = text_of(next(iter(manifest.objects(expected, NamedNode(SH + "conforms"))))) == "true"
    if conforms != (not results):
        return f"conforms is {not results}"
    return "" if _canonical(wanted) == _canonical(found) else _difference(wanted, found)


def _expected(manifest: Graph, report: Term, *, own: bool) -> Iterator[Triple]:
    for result in manifest.objects(report, NamedNode(SH + "result")):
        assert isinstance(result, BlankNode)  # noqa: S101 - the suite names no result
        for name in _COMPARED:
            predicate = NamedNode(SH + name)
            for value in manifest.objects(result, predicate):
                yield Triple(result, predicate, _fixed(value) if own else value)
        yield from _path(manifest, result, next(iter(manifest.objects(result, NamedNode(SH + "resultPath"))), None))


def _reported(shapes: Graph, results: Iterable[ShapeResult], *, own: bool) -> Iterator[Triple]:
    for result in results:
        node = BlankNode()
        values = {
            "focusNode": result.focus,
            "value": result.value,
            "sourceConstraintComponent": _whole(result.component),
            "sourceShape": result.shape,
            "resultSeverity": _whole(result.severity),
        }
        for name, value in values.items():
            if value is not None:
                yield Triple(node, NamedNode(SH + name), _fixed(value) if own else value)
        yield from _path(shapes, node, result.path)


def _whole(name: str) -> NamedNode:
    return NamedNode(name if ":" in name else SH + name)


def _fixed(term: Term) -> Term:
    """A blank node as a name: within one file expected and found are the same node, not merely alike."""
    return NamedNode(f"urn:blank:{term.value}") if isinstance(term, BlankNode) else term


def _path(graph: Graph, result: BlankNode, node: Term | None) -> Iterator[Triple]:
    """The path as a tree of its own: a shapes graph may use one node in two places, a report does not."""
    path = read_path(graph, node) if node is not None else None
    if path is not None:
        described, triples = describe(path)
        yield Triple(result, NamedNode(SH + "resultPath"), described)
        yield from triples


def _canonical(triples: Iterable[Triple]) -> Dataset:
    dataset = Dataset(Quad(t.subject, t.predicate, t.object) for t in triples)
    dataset.canonicalize(CanonicalizationAlgorithm.UNSTABLE)
    return dataset


def _difference(wanted: list[Triple], found: list[Triple]) -> str:
    left, right = {str(quad) for quad in _canonical(wanted)}, {str(quad) for quad in _canonical(found)}
    missing, extra = sorted(left - right)[:4], sorted(right - left)[:4]
    return f"the report lacks {missing} and has {extra}"


def rule_cases(root: Path) -> Iterator[RuleCase]:
    """Every inferencing case of the DASH suite below ``root``."""
    for path in sorted((root / "dash_tests" / "rules").rglob("*.ttl")):
        graph = _read(path)
        for case in graph.instances(NamedNode(_DASH + "InferencingTestCase")):
            yield RuleCase(text_of(case), path)


def run_rule_case(case: RuleCase) -> str:
    """What the rules conclude amiss, as a sentence; empty if it is exactly what the case expects."""
    shapes = _read(case.file)
    data = _read(case.file)
    for imported in shapes.values(_IMPORTS):
        beside = case.file.parent / f"{text_of(imported).rpartition('/')[2]}.ttl"
        if beside.is_file():
            for triple in _read(beside):
                data.add(triple)
    wanted = set()
    for result in shapes.objects(NamedNode(case.iri), NamedNode(_DASH + "expectedResult")):
        parts = (
            next(iter(shapes.objects(result, NamedNode(RDF + part)))) for part in ("subject", "predicate", "object")
        )
        wanted.add(tuple(parts))
    try:
        concluded = read_rule_base(shapes).apply(data)
    except OntoError as error:
        return f"cannot run: {error}"
    found = {(triple.subject, triple.predicate, triple.object) for triple in concluded}
    if found == wanted:
        return ""
    return f"lacks {sorted(map(str, wanted - found))[:3]} and concludes {sorted(map(str, found - wanted))[:3]}"
