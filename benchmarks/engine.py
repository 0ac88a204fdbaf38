"""Fan trials out over processes, and keep each row as soon as it is there, so that a run resumes where it stopped."""

from __future__ import annotations

import json
import os
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

from benchmarks.protocol import Protocol, Row, Trial
from onto_compiler.pool import map_over_processes
from onto_compiler.problems import OntoError

__all__ = ["run_protocol", "run_trial"]


def run_protocol(
    protocol: Protocol, trials: Sequence[Trial], rows_file: Path, jobs: int, tick: Callable[[], None]
) -> tuple[Row, ...]:
    """Run every trial whose rows are not yet in ``rows_file`` (JSON lines) and return all rows in the trials' order.

    A trial that raises gives one row with ``crashed`` set, which counts as a failure. ``tick`` is called per trial.

    Raises:
        OntoError: BEN002 if ``rows_file`` cannot be written.
    """
    done = dict(_read(rows_file))
    todo = [trial for trial in trials if trial["key"] not in done]
    for _ in range(len(trials) - len(todo)):
        tick()
    try:
        rows_file.parent.mkdir(parents=True, exist_ok=True)
        with rows_file.open("a", encoding="utf-8") as sink:
            for key, rows in _run_all(protocol, todo, jobs):
                done[key] = rows
                sink.write(json.dumps([key, rows]) + "\n")
                sink.flush()
                tick()
    except OSError as error:
        raise OntoError.of("BEN002", f"cannot write `{rows_file}`: {error.strerror}", "choose another --out") from error
    return tuple(row for trial in trials for row in done[trial["key"]])


def _read(path: Path) -> Iterator[tuple[str, list[Row]]]:
    """Rows that an earlier run left, by trial; a last line that was cut off is passed over."""
    if not path.exists():
        return
    for line in path.read_text(encoding="utf-8").splitlines():
        try:
            key, rows = json.loads(line)
        except ValueError:
            continue
        yield key, rows


def _run_all(protocol: Protocol, trials: Sequence[Trial], jobs: int) -> Iterator[tuple[str, list[Row]]]:
    together = [trial for trial in trials if not protocol.alone(trial)]
    alone = [trial for trial in trials if protocol.alone(trial)]
    for chosen, processes in ((together, jobs), (alone, 1)):
        for trial, rows in map_over_processes(partial(run_trial, protocol), chosen, processes):
            yield trial["key"], rows


def run_trial(protocol: Protocol, trial: Trial) -> list[Row]:
    """The trial's rows as they are published; of a trial that raised one row with ``crashed`` set."""
    started = time.perf_counter()
    try:
        rows = list(protocol.run(trial))
    except Exception as error:  # noqa: BLE001 - a crashed trial is a result: a failure, counted apart
        detail = traceback.format_exc(limit=-3) if os.environ.get("ONTO_DEBUG") else ""
        rows = [{"crashed": f"{type(error).__name__}: {error}", "detail": detail}]
    seconds = round(time.perf_counter() - started, 3)
    return [{**trial, **row, "seconds": seconds} for row in rows]
