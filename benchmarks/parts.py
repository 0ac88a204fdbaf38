"""Run a protocol part by part: the rows of the other parts stay, each with the run that made it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.protocol import Protocol, Row, Trial
from benchmarks.results import read_result
from onto_compiler.problems import OntoError, near

__all__ = ["chosen_trials", "joined"]

Made = Mapping[str, Any]  # how a part was made: command, commit, dirty, date, and the processor


def chosen_trials(protocol: Protocol, trials: Sequence[Trial], names: Sequence[str]) -> Sequence[Trial]:
    """Those of ``trials`` that belong to the parts ``names``; all of them where none is named.

    Raises:
        OntoError: BEN005 if the protocol has no parts, or none of a name.
    """
    if not names:
        return trials
    if not protocol.parts:
        raise OntoError.of("BEN005", f"`{protocol.name}` does not run in parts", "leave out --part")
    known = list(dict.fromkeys(trial[protocol.parts] for trial in trials))
    for name in names:
        if name not in known:
            message = f"`{protocol.name}` has no part `{name}`"
            raise OntoError.of("BEN005", message, near(name, known) or f"one of: {', '.join(known)}")
    return [trial for trial in trials if trial[protocol.parts] in names]


def joined(
    path: Path, protocol: Protocol, trials: Sequence[Trial], rows: Sequence[Row], made: Made
) -> tuple[list[Row], dict[str, Made]]:
    """``rows``, with those that the result at ``path`` has of other parts, in the order of ``trials``; and the origins.

    ``trials`` are all that the protocol lists; a part that ``rows`` hold replaces the one at ``path`` whole.
    """
    field = protocol.parts
    fresh = {row[field] for row in rows}
    before = read_result(path) if path.exists() else {"rows": [], "parts": {}}
    origins = {name: origin for name, origin in before.get("parts", {}).items() if name not in fresh}
    kept = [row for row in before["rows"] if row.get(field) in origins]
    order = {trial["key"]: place for place, trial in enumerate(trials)}
    every = sorted((row for row in [*kept, *rows] if row["key"] in order), key=lambda row: order[row["key"]])
    names = dict.fromkeys(row[field] for row in every)
    return every, {name: made if name in fresh else origins[name] for name in names}
