"""Many task files at once: each parsed, linted, lifted, and its required ABox held to the shapes, or found in a cache.

A verdict follows from what a file holds and is called, from the ontology, and from this package; these are what the
cache goes by. A file is read once, so that what is judged is what its key was made of.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import ontology as shipped
from onto_compiler.bddl import codes, lift, parse
from onto_compiler.bddl.parse import decode, read_bytes
from onto_compiler.cache import VerdictCache, digest
from onto_compiler.compile_schema import compile_schema
from onto_compiler.pool import map_over_processes
from onto_compiler.problems import OntoError, Problem, Span
from onto_compiler.rdf import BASE
from onto_compiler.required import RequiredABox
from onto_compiler.required_rdf import entity_iri, required_quads
from onto_compiler.schema import Schema
from onto_compiler.shacl.graph import Term
from onto_compiler.sources import collect, load_store
from onto_compiler.terms import text_of
from onto_compiler.validator.records import Validator, problem_of, record_validator

__all__ = ["Batch", "FileResult", "available_jobs", "compile_files", "task_files"]

CHUNK = 64  # files for one worker at a time; with no more, starting a worker costs more than it saves
_TOP = f"{BASE}run/compile"


@dataclass(frozen=True, slots=True)
class FileResult:
    """The result for one file: how many facts it requires (none if it does not compile), and all its problems."""

    facts: int = 0
    premise: int = 0
    alternatives: int = 0
    problems: tuple[Problem, ...] = ()
    cached: bool = False

    @property
    def compiled(self) -> bool:
        """Whether the file compiles to a valid required ABox."""
        return all(problem.severity != "error" for problem in self.problems)


@dataclass(frozen=True, slots=True)
class Batch:
    """The verdict of each file, by the path that was given; ``remarks`` are what befell the cache, as sentences."""

    verdicts: Mapping[Path, FileResult]
    remarks: tuple[str, ...] = ()

    @property
    def problems(self) -> tuple[Problem, ...]:
        """Every problem, in file order."""
        return tuple(sorted(problem for verdict in self.verdicts.values() for problem in verdict.problems))

    @property
    def summary(self) -> dict[str, int]:
        """How many files there were, compiled, failed, and came from the cache."""
        found = self.verdicts.values()
        compiled = sum(verdict.compiled for verdict in found)
        cached = sum(verdict.cached for verdict in found)
        return {"files": len(found), "compiled": compiled, "failed": len(found) - compiled, "cached": cached}


def task_files(paths: Sequence[Path | str]) -> tuple[Path, ...]:
    """The task files among ``paths``; a folder stands for every ``*.bddl`` below it.

    Raises:
        OntoError: BDDL004, where a folder holds none.
    """
    found: dict[Path, None] = {}
    for given in map(Path, paths):
        files = sorted(path for path in given.rglob("*.bddl") if not path.is_dir()) if given.is_dir() else [given]
        if not files:
            message, hint = f"`{given}` holds no task file (*.bddl)", "give a task file, or a folder that holds some"
            raise OntoError.of(codes.UNREADABLE, message, hint, str(given))
        found.update(dict.fromkeys(files))
    return tuple(found)


def available_jobs() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def compile_files(
    files: Sequence[Path], ontology: Sequence[Path | str] = (), *, jobs: int = 1, cache: Path | None = None
) -> Batch:
    """Compile and validate ``files`` by the shipped ontology with ``ontology`` on top of it.

    ``jobs`` is the most worker processes; few files are compiled in this one. ``cache`` is the folder that verdicts
    are kept in between calls, or None. Whatever is wrong with the cache, the verdicts are those of compiling.

    Raises:
        OntoError: the ontology does not load (TTL, SCH), or one of its shapes cannot run (SHP002).
    """
    extra = tuple(str(path) for path in collect(ontology))
    sources = [*shipped.turtle_files(), *map(Path, extra)]
    stamp = _stamp(sources)
    kept = VerdictCache(cache, stamp) if cache is not None and stamp else None
    remarks = [f"the cache `{kept.path}` was damaged and is built anew"] if kept is not None and kept.damaged else []
    verdicts: dict[Path, FileResult] = {}
    todo: list[tuple[Path, str, bytes]] = []
    for file in dict.fromkeys(files):
        try:
            data = read_bytes(file)
        except OntoError as error:
            verdicts[file] = FileResult(problems=error.problems)
            continue
        key = hashlib.sha256(f"{file}\0".encode("utf-8", "surrogateescape") + data).hexdigest()
        found = None if kept is None else kept.get(key)
        if found is None:
            todo.append((file, key, data))
        else:
            verdicts[file] = _from_json(found)
    try:
        for (file, key, _), verdict in _compiled(todo, extra, stamp, jobs):
            verdicts[file] = verdict
            if kept is not None:
                kept.add({key: asdict(verdict)})
    finally:  # save also what was compiled before an interruption
        if kept is not None and _stamp(sources) == stamp:  # else the ontology changed under our hands
            try:
                kept.save()
            except OSError as error:
                remarks.append(f"the cache `{kept.path}` cannot be written: {(error.strerror or str(error)).lower()}")
    return Batch({file: verdicts[file] for file in dict.fromkeys(files)}, tuple(remarks))


def _stamp(sources: Sequence[Path]) -> str:
    """The digest of ``sources``; nothing where one cannot be read, which loading it says with a place."""
    try:
        return digest(sources)
    except OSError:
        return ""


def _from_json(kept: Mapping[str, Any]) -> FileResult:
    problems = tuple(Problem(**problem) for problem in kept["problems"])
    return FileResult(kept["facts"], kept["premise"], kept["alternatives"], problems, cached=True)


def _compiled(
    todo: Sequence[tuple[Path, str, bytes]], extra: tuple[str, ...], stamp: str, jobs: int
) -> Iterator[tuple[tuple[Path, str, bytes], FileResult]]:
    chunks = [todo[start : start + CHUNK] for start in range(0, len(todo), CHUNK)]
    judge = partial(_judge_all, extra=extra, stamp=stamp)
    for chunk, found in map_over_processes(judge, chunks, jobs):
        yield from zip(chunk, found, strict=True)


def _judge_all(chunk: Sequence[tuple[Path, str, bytes]], extra: tuple[str, ...], stamp: str) -> list[FileResult]:
    schema, validator = _knowledge(extra, stamp)
    return [_judge(str(file), file.stem, data, schema, validator) for file, _, data in chunk]


@lru_cache(maxsize=1)
def _knowledge(extra: tuple[str, ...], stamp: str) -> tuple[Schema, Validator]:  # noqa: ARG001 - the stamp is the key
    """The compiled ontology, loaded once in each process for each state of its files."""
    return compile_schema(load_store(extra)), record_validator(extra)


def _judge(file: str, task: str, data: bytes, schema: Schema, validator: Validator) -> FileResult:
    try:
        abox, warnings = lift(parse(decode(data, file), file), schema, task)
        invalid = _violations(abox, schema, validator)
    except OntoError as error:
        return FileResult(problems=error.problems)
    problems = tuple(sorted({*warnings, *invalid}))
    return FileResult(len(abox.facts), len(abox.premise), len(abox.alternatives), problems)


def _violations(abox: RequiredABox, schema: Schema, validator: Validator) -> Iterator[Problem]:
    """The violations of shapes by the ABox as RDF, each at the atom of its fact."""
    names, spans = _places(abox)

    def name(term: Term) -> str:
        return f"`{names.get(text_of(term), text_of(term))}`"

    try:
        results = validator.validate(required_quads(abox, schema, _TOP))
    except ValueError as error:
        hint = "correct the binding that lifts it; see `onto explain ABX004`"
        yield Problem(abox.source, 0, 0, "ABX004", "error", str(error), hint)
        return
    for result in results:
        span = spans.get(text_of(result.focus), Span(abox.source))
        yield problem_of(result, validator.home(result.shape), name, span)


def _places(abox: RequiredABox) -> tuple[dict[str, str], dict[str, Span]]:
    """How the records' IRIs are called, and the atoms that they come from."""
    names = {f"{_TOP}/required": abox.task}
    spans: dict[str, Span] = {}
    for part, facts in (("required", abox.facts), ("premise", abox.premise)):
        for index, fact in enumerate(facts):
            iris = {f"{_TOP}/{part}/fact/{index}": str(fact)}
            iris |= {entity_iri(_TOP, argument.name): argument.name for argument in fact.arguments}
            for iri, called in iris.items():
                names.setdefault(iri, called)
                if fact.span is not None:
                    spans.setdefault(iri, fact.span)
    return names, spans
