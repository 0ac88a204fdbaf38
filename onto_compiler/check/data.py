"""``onto check DATA --shapes SHAPES``: anybody's data against anybody's shapes, the shipped ontology left out.

The clean path is Oxigraph's parser and one validation. Only where something was found are the files read again with our
own walker, and validated once more as it read them: every blank node then has its place too.
"""

from __future__ import annotations

from codecs import BOM_UTF8
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from urllib.parse import unquote, urlparse

from pyoxigraph import NamedNode, RdfFormat, parse

from onto_compiler.check.documents import ENDINGS, Document
from onto_compiler.check.query_terms import undeclared_in_queries
from onto_compiler.check.run import Report, Validated
from onto_compiler.folders import actual, below
from onto_compiler.problems import OntoError, Problem
from onto_compiler.rdf import OWL
from onto_compiler.shacl.compile import compile_graph
from onto_compiler.shacl.graph import Graph
from onto_compiler.shacl.rules import infer
from onto_compiler.shacl.validate import validate_graph
from onto_compiler.shacl.wellformed import misspelt
from onto_compiler.sources import MANY, parse_problem
from onto_compiler.validator.engine import with_implications

__all__ = ["ENDINGS", "Document", "check_data"]

_NESTED = {RdfFormat.TURTLE, RdfFormat.TRIG}
_IMPORTS = NamedNode(OWL + "imports")
_HINT = f"give a file whose name ends in {', '.join(ENDINGS)}, or a folder that holds some"


def check_data(paths: Sequence[Path | str], shapes: Sequence[Path | str]) -> Report:
    """Validate the data of ``paths`` with the shapes of ``shapes``; files, or folders of them.

    A file that cannot be read is a problem as any other; nothing is then validated.

    Raises:
        OntoError: CLI002 if no shape has a target.

    """
    problems: list[Problem] = []
    data = _documents(paths, problems)
    known = _documents(shapes, problems, imports=True)
    files = tuple(dict.fromkeys(document.path for document in data))
    if problems:
        return Report(tuple(sorted(problems)), tuple(dict.fromkeys(Path(problem.file) for problem in problems)), 0)
    graph = _graph(data)
    known_graph = _graph(known)
    faults = misspelt(known_graph)
    compiled = with_implications(compile_graph(known_graph, faults))
    if not compiled.roots and not faults:
        named = ", ".join(f"`{path}`" for path in shapes)
        message = f"no shape of {named} has a target, so that nothing would be validated"
        raise OntoError.of("CLI002", message, "say what a shape is for: sh:targetClass, for one")
    remarks = tuple(undeclared_in_queries(known_graph, graph))
    written = len(graph)
    infer(graph, known_graph, faults)
    results = validate_graph(graph, compiled, faults)
    if results or faults or remarks:
        from onto_compiler.check.data_places import place  # noqa: PLC0415 - a clean run needs no places

        problems += place(data, known, results, faults, remarks)
    return Report(tuple(sorted(set(problems))), files, written, Validated(results, compiled.graph, not faults))


def _graph(documents: Iterable[Document]) -> Graph:
    return Graph(statement for document in documents for statement in document.statements)


def _documents(paths: Sequence[Path | str], problems: list[Problem], *, imports: bool = False) -> list[Document]:
    """Every file of ``paths``; with ``imports``, also the local files that they import."""
    todo = [actual(found) for path in map(Path, paths) for found in _files(path, problems)]
    read: dict[Path, Document] = {}
    while todo:
        path = todo.pop(0)
        if path in read:
            continue
        try:
            read[path] = document = _read(path)
        except OntoError as error:
            problems += error.problems
            continue
        if imports:
            todo += _imported(document)
    return list(read.values())


def _files(path: Path, problems: list[Problem]) -> list[Path]:
    if not path.is_dir():
        return [path]
    found = [file for file in below(path, "*") if file.suffix.lower() in ENDINGS and file.is_file()]
    if not found:
        problems.append(Problem(str(path), 0, 0, "TTL002", "error", f"`{path}` holds no RDF file", _HINT))
    return found


def _imported(document: Document) -> Iterator[Path]:
    for statement in document.statements:
        value = statement.object
        if statement.predicate == _IMPORTS and isinstance(value, NamedNode) and value.value.startswith("file:"):
            path = Path(unquote(urlparse(value.value).path))
            if path.is_file():
                yield path


def _read(path: Path) -> Document:
    kind = ENDINGS.get(path.suffix.lower())
    if kind is None:
        raise OntoError.of("TTL002", f"`{path.name}` has no ending that says what it holds", _HINT, str(path))
    try:
        data = path.read_bytes().removeprefix(BOM_UTF8)
        if kind in _NESTED and data.count(b"[") + data.count(b"(") > MANY:
            from onto_compiler.turtle.limits import nesting_problem  # noqa: PLC0415 - few files need it

            problem = nesting_problem(path, data.decode("utf-8", errors="replace"))
            if problem is not None:
                raise OntoError(problem)
        found = parse(data, format=kind, base_iri=path.as_uri(), rename_blank_nodes=True)
        return Document(path, kind, tuple(found))
    except SyntaxError as error:
        raise OntoError(_syntax(path, kind, error)) from error
    except OSError as error:
        message = f"cannot read `{path.name}`: {error.strerror or error}"
        raise OntoError.of("TTL002", message, _HINT, str(path)) from error


def _syntax(path: Path, kind: RdfFormat, error: SyntaxError) -> Problem:
    if kind in _NESTED:
        return parse_problem(path, error)
    reason = " ".join(str(error.msg or error).partition(" (line ")[0].split()).rpartition(": ")[2]
    hint = "see `onto explain TTL001`"
    if "LoadDocumentCallback" in reason:
        reason, hint = "its context is at another place, and nothing is fetched", "write the context into the file"
    message = f"not {kind.name}: {reason[:1].lower()}{reason[1:]}"
    return Problem(str(path), error.lineno or 0, error.offset or 0, "TTL001", "error", message, hint)
