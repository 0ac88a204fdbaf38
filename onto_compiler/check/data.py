"""``onto check DATA --shapes SHAPES``: anybody's data against anybody's shapes, the shipped ontology left out.

The clean path is Oxigraph's parser and one validation. Only where something was found are the files read again with our
own walker, and validated once more as it read them: every blank node then has its place too.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from pyoxigraph import NamedNode

from onto_compiler.check.catalog import NAME
from onto_compiler.check.documents import ENDINGS, HINT, Document, read_document
from onto_compiler.check.imports import Imports
from onto_compiler.check.query_terms import undeclared_in_queries
from onto_compiler.check.run import Report, Validated
from onto_compiler.folders import actual, below
from onto_compiler.problems import OntoError, Problem
from onto_compiler.rdf import SH
from onto_compiler.reasoning.axioms import TYPE
from onto_compiler.shacl.compile import compile_graph
from onto_compiler.shacl.graph import Graph
from onto_compiler.shacl.rules import infer
from onto_compiler.shacl.validate import validate_graph
from onto_compiler.shacl.wellformed import misspelt
from onto_compiler.validator.engine import with_implications

__all__ = ["ENDINGS", "Document", "check_data"]


def check_data(
    paths: Sequence[Path | str],
    shapes: Sequence[Path | str],
    imports: Mapping[str, Path] | None = None,
    known_imports: Mapping[str, Path] | None = None,
    texts: Mapping[Path, str] | None = None,
) -> Report:
    """Validate the data of ``paths`` with the shapes of ``shapes``; files, or folders of them, and what they import.

    A file that cannot be read is a problem as any other. Without one of the shapes nothing is validated; without one of
    the data the others are, and where a value has no class at all, no shape asks for it. ``imports`` are files by the
    IRIs that they are imported by, each of which must be imported; ``known_imports`` are such files that need not be.
    ``texts`` holds what some files (by resolved path) are to be, where that is not what is on disk.

    Raises:
        OntoError: CLI002 if no shape has a target.

    """
    unreadable: list[Problem] = []
    data = _documents(paths, unreadable, texts or {})
    broken: list[Problem] = []
    known = _documents(shapes, broken, texts or {})
    files = tuple(dict.fromkeys([*(document.path for document in data), *_files_of(unreadable)]))
    lead = Imports({**(known_imports or {}), **(imports or {})})
    lead.declare((*data, *known))
    known = lead.closed(known)
    broken += lead.unreadable
    data = lead.closed(data)
    unreadable += lead.unreadable
    consulted = tuple(sorted(lead.consulted))
    if broken or not data:
        faulty = tuple(sorted({*unreadable, *broken}))
        return Report(faulty, _files_of(faulty), 0, consulted=consulted)
    graph = _graph(data)
    known_graph = _graph(known)
    faults = misspelt(known_graph)
    compiled = with_implications(compile_graph(known_graph, faults))
    if not any(shape.targets for shape in compiled.known.values()) and not faults:
        named = ", ".join(f"`{path}`" for path in shapes)
        message = f"no shape of {named} has a target, so that nothing would be validated"
        raise OntoError.of("CLI002", message, "say what a shape is for: sh:targetClass, for one")
    remarks = tuple(undeclared_in_queries(known_graph, graph))
    written = len(graph)
    infer(graph, compiled.graph, faults)
    results = validate_graph(graph, compiled, faults)
    problems = [*unreadable, *lead.problems, *lead.missing(), *lead.unused(imports or {})]
    if results or faults or remarks:
        from onto_compiler.check.data_places import place  # noqa: PLC0415 - a clean run needs no places

        placed = place(data, known, results, faults, remarks)
        problems += (one for one in placed if not (unreadable and _lacks_a_class(one, graph)))
    validated = Validated(results, compiled.graph, not (faults or unreadable))
    return Report(tuple(sorted(set(problems))), files, written, validated, consulted)


def _files_of(problems: Iterable[Problem]) -> tuple[Path, ...]:
    return tuple(dict.fromkeys(Path(problem.file) for problem in problems))


def _lacks_a_class(problem: Problem, graph: Graph) -> bool:
    """Whether a shape misses the class of a term, of which a file that was not read may have said it."""
    result = problem.result or {}
    value = result.get("value") or {}
    if result.get("sourceConstraintComponent") != f"{SH}ClassConstraintComponent" or value.get("type") != "uri":
        return False
    return not graph.objects(NamedNode(value["value"]), TYPE)


def _graph(documents: Iterable[Document]) -> Graph:
    return Graph(statement for document in documents for statement in document.statements)


def _documents(paths: Sequence[Path | str], problems: list[Problem], texts: Mapping[Path, str]) -> list[Document]:
    """Every file of ``paths``; what cannot be read is appended to ``problems``."""
    read: dict[Path, Document] = {}
    for path in (actual(file) for given in map(Path, paths) for file in _files(given, problems)):
        try:
            if path not in read:
                read[path] = read_document(path, texts.get(path))
        except OntoError as error:
            problems += error.problems
    return list(read.values())


def _files(path: Path, problems: list[Problem]) -> list[Path]:
    if not path.is_dir():
        return [path]
    found = [
        file for file in below(path, "*") if file.suffix.lower() in ENDINGS and file.is_file() and file.name != NAME
    ]
    if not found:
        problems.append(Problem(str(path), 0, 0, "TTL002", "error", f"`{path}` holds no RDF file", HINT))
    return found
