"""Writes episodes to one file, without a store, after validating every record against the shapes."""

from __future__ import annotations

import gzip
from collections.abc import Iterable, Sequence
from pathlib import Path

from pyoxigraph import Store

from onto_compiler.problems import OntoError
from onto_compiler.schema import Schema
from onto_compiler.validator.records import record_validator
from runtime.loop.records import Episode
from runtime.trace.admission import admit, tagged
from runtime.trace.store import FORMATS, dump

__all__ = ["require_format", "write_trace"]

_GRAPHS = (".trig", ".nq", ".jsonld")


def require_format(path: Path) -> None:
    """Raises ``TRC001`` if the ending of ``path`` names no format of a trace that has graphs."""
    if _ending(path) not in _GRAPHS:
        hint = f"end its name in {', '.join(_GRAPHS)}, and in .gz where it is to be packed"
        raise OntoError.of("TRC001", f"`{path}` is not the name of a trace", hint, str(path))


def write_trace(
    path: Path,
    runs: Iterable[tuple[str, Sequence[Episode]]],
    schema: Schema,
    ontology: Sequence[Path | str] = (),
    *,
    tags: Iterable[tuple[str, str]] = (),
) -> None:
    """Write the episodes of each of ``runs``, with ``tags``, to ``path``, in the format that its ending names.

    Of two different episodes with the same names, the second becomes the next trial.

    Raises:
        OntoError: as :func:`require_format`; ``TRC001`` if it cannot be written; a shape's code where a record does
            not conform, and then nothing is written.
    """
    require_format(path)
    validator, store = record_validator(ontology), Store()
    for run, episodes in runs:
        for episode in episodes:
            store.extend(admit(store, validator, tagged(episode, tags), schema, run)[1])
    packed = path.suffix == ".gz"
    data = dump(store, FORMATS[_ending(path)])
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(gzip.compress(data, mtime=0) if packed else data)
    except OSError as error:
        hint = "name a file that you may write, with space left"
        raise OntoError.of("TRC001", f"cannot write `{path}`: {error.strerror}", hint, str(path)) from error


def _ending(path: Path) -> str:
    """The ending that names the format, without that of the compression."""
    return Path(path.stem).suffix if path.suffix == ".gz" else path.suffix
