"""Where traces live: an Oxigraph store on disk for writing, and any dump or store for reading."""

from __future__ import annotations

import contextlib
import gzip
import io
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pyoxigraph import DefaultGraph, NamedNode, Quad, RdfFormat, Store, parse, serialize

from onto_compiler.closing import Closing
from onto_compiler.lexical.store import LexicalStore
from onto_compiler.lexical.terms import respelled
from onto_compiler.problems import OntoError, Problem
from onto_compiler.rdf import ALIGNED, PREFIXES, RDF
from onto_compiler.schema import Schema
from onto_compiler.validator.records import record_validator
from runtime.loop.records import Episode
from runtime.trace.admission import admit, is_recorded, tagged
from runtime.trace.names import RUNS, episode_iri
from runtime.trace.read import episode_iris, read_episode
from runtime.trace.sparql import Answer, ask
from runtime.trace.vocabulary import holds_vocabulary, refresh, vocabulary

__all__ = ["FORMATS", "Trace", "TraceStore", "dump", "newest_trace", "open_trace"]

FORMATS = {
    ".trig": RdfFormat.TRIG,
    ".nq": RdfFormat.N_QUADS,
    ".jsonld": RdfFormat.JSON_LD,
    ".nt": RdfFormat.N_TRIPLES,
    ".ttl": RdfFormat.TURTLE,
}
_AGAIN = "export it again with `onto trace export`"
_COPIES = 3  # how often a copy of a store that is being written is tried


class TraceStore(Closing):
    """A store on disk that one process fills, an episode at a time, for one ``run``.

    It also holds the ontology, so that a query can follow superclasses, units and labels at any SPARQL endpoint. A
    record that does not conform to the ontology's shapes is refused.
    """

    def __init__(
        self,
        path: Path | str,
        schema: Schema,
        run: str,
        *,
        ontology: Sequence[Path | str] = (),
        tags: Iterable[tuple[str, str]] = (),
    ) -> None:
        """Open or create the store in the folder ``path``; every added episode gets ``tags`` in addition to its own.

        Raises:
            OntoError: TRC001 if the folder cannot be written or another process has it open; SHP002 if a shape
                in ``ontology`` cannot run.
        """
        self.path, self.schema, self.run, self.tags = Path(path), schema, run, tuple(tags)
        self._validator = record_validator(ontology)
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self._store = Store(str(self.path))
        except (OSError, RuntimeError) as error:
            raise _unwritable(self.path, error) from error
        refresh(self._store, ontology)

    def close(self) -> None:
        """Write everything out and release the folder."""
        self._store.flush()
        # Oxigraph has no close: the lock on the folder goes with the last reference.
        self._store = Store()

    def has(
        self,
        suite: str,
        task: str,
        state_index: int,
        seed: int = 0,
        trial: int = 0,
        *,
        given: str = "",
        tags: Iterable[tuple[str, str]] = (),
    ) -> bool:
        """Whether the run holds the episode of these names and the store's tags; a resumed run skips it."""
        marks = (*tags, *self.tags)
        iri = episode_iri(self.run, suite, task, state_index, seed, trial, given=given, tags=marks)
        return is_recorded(self._store, iri)

    def add(self, episode: Episode) -> str:
        """Record ``episode`` in one transaction and return its IRI.

        Nothing is overwritten: an equal episode is not recorded twice, and a different one of the same names becomes
        the next trial.

        Raises:
            OntoError: TRC001 if the folder can no longer be written; a shape's code (ABX001 to ABX004, SHP001)
                where a record does not conform, and then nothing is written.
        """
        iri, quads = admit(self._store, self._validator, tagged(episode, self.tags), self.schema, self.run)
        try:
            self._store.extend(quads)
        except OSError as error:
            raise _unwritable(self.path, error) from error
        return iri

    def query(self, sparql: str, *, name: str = "", file: str = "") -> Answer:
        """Query the store, all graphs together; raises as :func:`runtime.trace.sparql.ask`."""
        return ask(self._store, sparql, name=name, file=file)

    def episodes(self) -> tuple[str, ...]:
        """The IRIs of all recorded episodes."""
        return episode_iris(self._store)

    def episode(self, iri: str) -> Episode:
        """The episode ``iri`` as it was recorded."""
        return read_episode(self._store, iri)

    def export_trig(self, path: Path | str) -> None:
        """Write every run as TriG: the same episodes give the same bytes.

        Raises:
            OntoError: TRC001 if ``path`` cannot be written.
        """
        target = Path(path)
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(dump(self._store, RdfFormat.TRIG))
        except OSError as error:
            raise _unwritable(target, error) from error


@dataclass(frozen=True, slots=True)
class Trace:
    """A trace that is only read; ``source`` is the file or folder that it came from."""

    store: Store
    source: Path
    _copy: tempfile.TemporaryDirectory[str] | None = field(default=None, repr=False)  # lives as long as the store
    _written: LexicalStore | None = field(default=None, repr=False)  # the same, where the store spells values again

    def query(self, sparql: str, *, name: str = "", file: str = "") -> Answer:
        """Query the trace, all graphs together; raises as :func:`runtime.trace.sparql.ask`."""
        return ask(self._written or self.store, sparql, name=name, file=file)

    def episodes(self) -> tuple[str, ...]:
        """The IRIs of all recorded episodes."""
        return episode_iris(self.store)

    def episode(self, iri: str) -> Episode:
        """The episode ``iri`` as it was recorded."""
        return read_episode(self.store, iri)


def open_trace(path: Path | str, *, ontology: Sequence[Path | str] = ()) -> Trace:
    """Open a store folder or a dump for reading: ``.trig``, ``.nq``, ``.jsonld``, ``.nt``, ``.ttl``, each also ``.gz``.

    A folder is read from a copy, as another process may be writing it.

    Raises:
        OntoError: TRC002 if there is no trace; TRC003 if it cannot be parsed.
    """
    source = Path(path)
    if not source.exists():
        raise OntoError.of(
            "TRC002", f"`{path}` does not exist", "give a trace file or the folder of a store", str(path)
        )
    trace = _open_folder(source) if source.is_dir() else _open_file(source)
    if not holds_vocabulary(trace.store):
        terms = list(vocabulary(ontology))
        trace.store.extend(terms)
        if trace._written is not None:  # noqa: SLF001 - its own
            trace._written.extend(terms)  # noqa: SLF001
    return trace


def newest_trace(root: Path | str = "out") -> Path:
    """The trace below ``root`` that was written last.

    Raises:
        OntoError: TRC002 if there is none.
    """
    base = Path(root)
    stores = [marker.parent for marker in base.rglob("CURRENT")]
    found = [*stores, *(file for file in base.rglob("trace.*") if _format(file) is not None)]
    if not found:
        hint = "record one with `onto demo`, or name a trace file"
        raise OntoError.of("TRC002", f"there is no trace below `{base}`", hint)
    return max(found, key=lambda path: (_age(path), path.name))


def dump(store: Store, rdf_format: RdfFormat) -> bytes:
    """The runs in ``store`` (not the ontology), sorted, so that equal traces give equal bytes."""
    quads = sorted(_run_quads(store), key=_order)
    known = {name: namespace for name, namespace in PREFIXES.items() if name not in ALIGNED}
    prefixes = {**known, "run": RUNS} if rdf_format in {RdfFormat.TRIG, RdfFormat.JSON_LD} else None
    buffer = io.BytesIO()
    serialize(quads, buffer, format=rdf_format, prefixes=prefixes)
    return buffer.getvalue()


def _run_quads(store: Store) -> Iterator[Quad]:
    # A trace that came without graphs (Turtle, N-Triples) stands in the default graph.
    yield from store.quads_for_pattern(None, None, None, DefaultGraph())
    for graph in store.named_graphs():
        if isinstance(graph, NamedNode) and graph.value.startswith(RUNS):
            yield from store.quads_for_pattern(None, None, None, graph)


def _order(quad: Quad) -> tuple[str, str, bool, str, str]:
    kind = str(quad.predicate)
    return str(quad.graph_name), str(quad.subject), kind != f"<{RDF}type>", kind, str(quad.object)


def _open_folder(source: Path) -> Trace:
    if not (source / "CURRENT").exists():
        if (source / "store" / "CURRENT").exists():
            return _open_folder(source / "store")
        dumps = [file for file in sorted(source.glob("trace.*")) if _format(file) is not None]
        if dumps:
            return _open_file(dumps[0])
        raise OntoError.of("TRC002", f"`{source}` holds no trace", "give a trace file or the folder of a store")
    for _ in range(_COPIES):
        # Oxigraph's threads may still write while the copy is being removed; the rest is the system's to clean.
        copy = tempfile.TemporaryDirectory(prefix="onto-trace-", ignore_cleanup_errors=True)
        # A file that a writer removes while we copy leaves an incomplete copy: then the next one is tried.
        with contextlib.suppress(OSError, RuntimeError, shutil.Error):
            shutil.copytree(source, copy.name, dirs_exist_ok=True)
            store = Store.read_only(copy.name)
            # A store that somebody else filled lacks the ontology; only then must the copy be writable.
            return Trace(store if holds_vocabulary(store) else Store(copy.name), source, copy)
        copy.cleanup()
    hint = "record it again, or give a dump that `onto trace export` wrote"
    raise OntoError.of("TRC003", f"`{source}` is not a readable store", hint)


def _open_file(source: Path) -> Trace:
    rdf_format = _format(source)
    if rdf_format is None:
        hint = f"give a store's folder, or a file that ends in {', '.join(FORMATS)}"
        raise OntoError.of("TRC002", f"`{source}` is not a trace", hint)
    store = Store()
    try:
        data = gzip.decompress(source.read_bytes()) if source.suffix == ".gz" else source.read_bytes()
        read = parse(data, format=rdf_format, rename_blank_nodes=True)
        found = [one if isinstance(one, Quad) else Quad(one.subject, one.predicate, one.object) for one in read]
    except SyntaxError as error:
        message = f"the trace does not parse: {error.msg}"
        problem = Problem(str(source), error.lineno or 0, error.offset or 0, "TRC003", "error", message, _AGAIN)
        raise OntoError(problem) from error
    except (OSError, EOFError, UnicodeDecodeError) as error:
        raise OntoError.of("TRC003", f"the trace cannot be read: {error}", _AGAIN, str(source)) from error
    store.bulk_extend(found)
    written = LexicalStore(found) if respelled({quad.object for quad in found}) else None
    return Trace(store, source, _written=written)


def _format(file: Path) -> RdfFormat | None:
    name = file.with_suffix("") if file.suffix == ".gz" else file
    return FORMATS.get(name.suffix)


def _age(path: Path) -> float:
    files = [path, *path.iterdir()] if path.is_dir() else [path]
    return max(file.stat().st_mtime for file in files)


def _unwritable(path: Path, error: Exception) -> OntoError:
    busy = "lock" in str(error).casefold()
    message = f"`{path}` is in use by another process" if busy else f"cannot write `{path}`: {error}"
    hint = "wait for it, or name another folder" if busy else "name a folder that you may write, with space left"
    return OntoError.of("TRC001", message, hint, str(path))
