"""Turtle files in, one in-memory store out; each file is a named graph, so that a fault can name its file."""

from __future__ import annotations

from codecs import BOM_UTF8
from collections.abc import Iterable, Sequence
from functools import lru_cache
from pathlib import Path

from pyoxigraph import NamedNode, Quad, RdfFormat, Store, parse

import ontology
from onto_compiler.folders import actual, below
from onto_compiler.problems import OntoError, Problem

__all__ = ["collect", "graph_of", "load_store", "parse_problem", "read_into", "size_problem"]

MANY = 100  # brackets: with no more, none can be nested too deep
LARGE = 1024 * 1024  # bytes: with no more, no literal can be too long
_LARGEST = 100_000_000  # bytes: a check takes some 70 times as much memory


def collect(paths: Iterable[Path | str]) -> tuple[Path, ...]:
    """Turtle files among ``paths``; a folder stands for every ``*.ttl`` :func:`~onto_compiler.folders.below` it.

    Raises:
        OntoError: TTL002 if a path does not exist or a folder holds no Turtle.

    """
    found: list[Path] = []
    problems = []
    for given in map(Path, paths):
        files = below(given, "*.ttl") if given.is_dir() else [given]
        if not given.exists():
            problems.append(_unreadable(given, f"`{given}` does not exist"))
        elif not files:
            problems.append(_unreadable(given, f"`{given}` holds no Turtle file (*.ttl)"))
        else:
            found += files
    if problems:
        raise OntoError(*problems)
    return tuple(dict.fromkeys(map(actual, found)))


def load_store(extra: Sequence[Path | str] = (), *, shipped: bool = True) -> Store:
    """The shipped ontology and the user's own files (``--ontology PATH...``) in one store.

    Raises:
        OntoError: TTL001 for every file that is not Turtle, TTL002 for one that cannot be read.

    """
    store = Store()
    problems: list[Problem] = []
    files = dict.fromkeys([*(ontology.turtle_files() if shipped else ()), *collect(extra)])
    for path in files:
        problems += read_into(store, path)
    if problems:
        raise OntoError(*problems)
    return store


def graph_of(path: Path) -> NamedNode:
    """The named graph that holds a file's triples."""
    return NamedNode(path.as_uri())


def read_into(store: Store, path: Path, text: str | None = None, written: list[Quad] | None = None) -> list[Problem]:
    """Load one file into its named graph; return what is wrong with it instead of raising.

    ``text`` takes the place of what is on disk, for a file that is being edited. ``written`` also gets the statements,
    with literals as the file spells them: a store keeps ``"05"^^xsd:byte`` as the integer 5.
    """
    try:
        data = path.read_bytes() if text is None else text.encode()
        data.decode("utf-8")
        data, base, graph = data.removeprefix(BOM_UTF8), path.as_uri(), graph_of(path)
        # The two counts are enough to know a common file sound, without the import.
        if data.count(b"[") + data.count(b"(") > MANY and (problem := _too_deep(path, data)) is not None:
            return [problem]
        if written is None:
            store.load(data, format=RdfFormat.TURTLE, base_iri=base, to_graph=graph)
        else:
            # An editor's keystroke and a round of `--fix` read the files around the one that changed again.
            read = _statements if text is None and len(data) < LARGE else _statements.__wrapped__
            statements = read(data, base)
            store.extend(statements)
            written += statements
        if len(data) > LARGE and (problem := _too_long(store, path, data)) is not None:
            return [problem]
    except SyntaxError as error:
        return [parse_problem(path, error, text)]
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8")
        line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
        message = f"`{path.name}` is not UTF-8: byte 0x{data[error.start]:02X}"
        return [Problem(str(path), line, column, "TTL002", "error", message, "save the file as UTF-8")]
    except OSError as error:
        return [_unreadable(path, f"cannot read `{path.name}`: {error.strerror or error}")]
    return []


@lru_cache(maxsize=64)
def _statements(data: bytes, base: str) -> tuple[Quad, ...]:
    """The triples of a text in the graph of its address."""
    read = parse(data, format=RdfFormat.TURTLE, base_iri=base, rename_blank_nodes=True)
    graph = NamedNode(base)
    return tuple(Quad(one.subject, one.predicate, one.object, graph) for one in read)


def size_problem(path: Path) -> Problem | None:
    """A problem where a file is larger than a check reads; a file that is not there is none here."""
    try:
        size = path.stat().st_size
    except OSError:
        return None
    if size <= _LARGEST:
        return None
    said = f"`{path.name}` has {size / 1e6:,.0f} MB, and a file of at most {_LARGEST / 1e6:,.0f} MB is checked"
    return Problem(str(path), 0, 0, "TTL009", "error", said, "split it, and check the parts with what they import")


def _too_deep(path: Path, data: bytes) -> Problem | None:
    from onto_compiler.turtle.limits import nesting_problem  # noqa: PLC0415 - few files need it

    return nesting_problem(path, data.decode("utf-8"))


def _too_long(store: Store, path: Path, data: bytes) -> Problem | None:
    from onto_compiler.turtle.limits import MAX_LITERAL, literal_problem  # noqa: PLC0415 - as above

    long = f"ASK {{ GRAPH {graph_of(path)} {{ ?s ?p ?o FILTER (STRLEN(STR(?o)) > {MAX_LITERAL}) }} }}"
    return literal_problem(path, data.decode("utf-8")) if bool(store.query(long)) else None


def parse_problem(path: Path, error: SyntaxError, text: str | None = None) -> Problem:
    """Oxigraph's syntax error as a problem with a place; ``text`` is the file's, where it is not the one on disk."""
    from onto_compiler.turtle.syntax import syntax_problem  # noqa: PLC0415 - a clean run never needs it

    return syntax_problem(path, error, text)


def _unreadable(path: Path, message: str) -> Problem:
    return Problem(
        str(path), 0, 0, "TTL002", "error", message, "give an existing Turtle file or a folder that holds some"
    )
