"""Repair by direct state application, from the official initial states of LIBERO's four suites of ten tasks.

The arms differ in how the route of an attempt is chosen, see :mod:`benchmarks.route_arms`: ``typed`` is the shipped
configuration, the others are its controls, with the same facts, proposers, budget and judge. What was accepted was
accepted again after settling. Mode ``state``; the proposers see privileged simulator state. The protocol is written
down in docs/protocols/state-repair.md.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import product

import numpy as np

from benchmarks.intervals import wilson
from benchmarks.paired import bootstrap, holm, mcnemar
from benchmarks.protocol import Protocol, Row, Trial
from benchmarks.route_arms import ARMS, SEED, Asked
from onto_compiler.knowledge import load_knowledge
from onto_compiler.schema import local_name
from runtime.loop.records import Episode
from runtime.worlds.episodes import EpisodeRunner
from runtime.worlds.libero.simulator.assets import find_task
from runtime.worlds.libero.world import WORLD

__all__ = ["CONTROLS", "ENDPOINTS", "METHODS", "STATE_REPAIR", "SUITES"]

SUITES = ("libero_goal", "libero_spatial", "libero_object", "libero_10")
TYPED = "typed"
METHODS = tuple(ARMS)
CONTROLS = tuple(method for method in METHODS if method != TYPED)
STATES = {method: range(50 if method == TYPED else 5) for method in METHODS}
"""Of the full protocol; the small one takes state 0."""


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """Each method on each of its states, task by task."""
    return [
        {"key": f"{suite}/{task}/{state}/{method}", "suite": suite, "task": task, "state": state, "method": method}
        for suite, task, method in product(SUITES, range(10), METHODS)
        for state in (STATES[method] if full else range(1))
    ]


def run(trial: Trial) -> list[Row]:
    """One episode."""
    suite, task, state = trial["suite"], trial["task"], trial["state"]
    runner = _runner(suite, task)
    random = np.random.default_rng([SEED, SUITES.index(suite), task, state])
    routing = Asked(ARMS[trial["method"]](random))
    episode = replace(runner, loop=replace(runner.loop, routing=routing)).run(state)
    return [_row(episode, routing.count)]


@lru_cache(maxsize=1)
def _runner(suite: str, task: int) -> EpisodeRunner:
    """The scene of the task that this process works on; trials come task by task."""
    return EpisodeRunner.open(WORLD, find_task(suite, task), load_knowledge(), seed=SEED)


def _row(episode: Episode, asked: int) -> Row:
    first = episode.attempts[0].diagnoses if episode.attempts else ()
    return {
        "name": episode.task,
        "mode": "state",
        "sees": "privileged-state",
        "premise_holds": episode.premise_holds,
        "outcome": episode.outcome,
        "accepted": episode.accepted,
        "initially_true": episode.outcome == "verified",
        "settled": bool(episode.accepted and episode.verification is not None and episode.verification.settled),
        "attempts": len(episode.attempts),
        "asked": asked,
        "unmet": [str(diagnosis.fact) for diagnosis in first],
        "failures": [local_name(diagnosis.failure) for diagnosis in first],
        "routes": [local_name(attempt.selected.route) for attempt in episode.attempts if attempt.selected is not None],
    }


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Rates by method and suite, and each control against ``typed``; a crashed trial is a failure, counted apart."""
    found: dict[str, float] = {"trials": len(rows), "crashed": sum("crashed" in row for row in rows)}
    for method in METHODS:
        chosen = [row for row in rows if row["method"] == method]
        found[method] = sum(map(_accepted, chosen)) / max(len(chosen), 1)
        for suite in (*SUITES, "all"):
            found |= _rates(f"{method}.{suite}", [row for row in chosen if suite in {row["suite"], "all"}])
    by_state = {(row["method"], row["suite"], row["task"], row["state"]): row for row in rows}
    for control in CONTROLS:
        pairs = list(_pairs(by_state, control))
        if pairs:
            found |= _compared(f"typed_vs_{control}", pairs)
    for endpoint in ENDPOINTS:
        names = [name for control in CONTROLS if (name := f"typed_vs_{control}.{endpoint}.p") in found]
        found |= holm({name: found[name] for name in names})
    return found


def _accepted(row: Row) -> bool:
    return bool(row.get("accepted"))


def _direct(row: Row) -> bool:
    """Whether no attempt was wasted: accepted with at most one for each fact that was unmet."""
    return _accepted(row) and row["attempts"] <= len(row["unmet"])


ENDPOINTS: Mapping[str, Callable[[Row], bool]] = {"accepted": _accepted, "one_attempt_per_fact": _direct}
"""What is tested between the arms."""
_COUNTS = ("attempts", "asked")


def _rates(name: str, rows: Sequence[Row]) -> dict[str, float]:
    found: dict[str, float] = {f"{name}.n": len(rows)}
    for metric in ("accepted", "settled", "initially_true"):
        hits = sum(bool(row.get(metric)) for row in rows)
        found[f"{name}.{metric}"] = hits / max(len(rows), 1)
        found[f"{name}.{metric}.low"], found[f"{name}.{metric}.high"] = wilson(hits, len(rows))
    done = [row for row in rows if "crashed" not in row]
    for count in _COUNTS:
        found[f"{name}.{count}"] = sum(row[count] for row in done) / max(len(done), 1)
    found[f"{name}.one_attempt_per_fact"] = sum(map(_direct, done)) / max(len(rows), 1)
    failed = [row for row in done if not row["accepted"]]
    found[f"{name}.failed"] = len(failed)
    found[f"{name}.failed_without_attempt"] = sum(not row["attempts"] for row in failed)
    return found


def _pairs(rows: Mapping[tuple[str, str, int, int], Row], control: str) -> Iterator[tuple[Row, Row]]:
    """The rows of ``typed`` and of ``control`` on each state that both were given."""
    for (method, suite, task, state), row in rows.items():
        if method == control and (other := rows.get((TYPED, suite, task, state))) is not None:
            yield other, row


def _compared(name: str, pairs: Sequence[tuple[Row, Row]]) -> dict[str, float]:
    """Discordant states and their exact p by endpoint; differences of counts, with intervals over tasks."""
    found: dict[str, float] = {f"{name}.pairs": len(pairs)}
    for endpoint, holds in ENDPOINTS.items():
        verdicts = [(holds(one), holds(other)) for one, other in pairs]
        only = verdicts.count((True, False)), verdicts.count((False, True))
        found[f"{name}.{endpoint}.only_typed"], found[f"{name}.{endpoint}.only_control"] = only
        found[f"{name}.{endpoint}.p"] = mcnemar(*only)
    whole = [(one, other) for one, other in pairs if "crashed" not in one and "crashed" not in other]
    for count in _COUNTS if whole else ():
        gaps: dict[tuple[str, int], list[int]] = {}
        for one, other in whole:
            gaps.setdefault((one["suite"], one["task"]), []).append(other[count] - one[count])
        means = np.array([np.mean(some) for some in gaps.values()])
        found[f"{name}.{count}"] = float(means.mean())
        found[f"{name}.{count}.low"], found[f"{name}.{count}.high"] = bootstrap(means)
    return found


STATE_REPAIR = Protocol(
    name="state_repair",
    help="repair by writing the state, on the forty tasks of the four suites, beside other ways to choose a route",
    seeds=(SEED,),
    trials=trials,
    run=run,
    metrics=metrics,
    arms="method",
)
