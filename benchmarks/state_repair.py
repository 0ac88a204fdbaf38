"""Repair by direct state application, from the official initial states of LIBERO's four suites of ten tasks.

Methods: ``typed`` is the shipped configuration. ``random_route`` draws the route of every attempt at random and leaves
the rest as it is: same facts, proposers, budget and judge. What ``none`` reaches is the share of states that the native
predicate accepts without a correction. Mode ``state``; the proposers see privileged simulator state.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from itertools import product

import numpy as np

from benchmarks.intervals import wilson
from benchmarks.protocol import Protocol, Row, Trial
from onto_compiler.knowledge import Knowledge, load_knowledge
from onto_compiler.schema import local_name
from onto_compiler.tables import RouteEntry, RuleTables
from runtime.loop.records import Episode
from runtime.worlds.episodes import EpisodeRunner
from runtime.worlds.libero.simulator.assets import find_task
from runtime.worlds.libero.world import WORLD

__all__ = ["STATE_REPAIR"]

SEED = 0
SUITES = ("libero_goal", "libero_spatial", "libero_object", "libero_10")
STATES = {"typed": range(50), "random_route": range(10)}  # of the full protocol; the small one takes state 0
METHODS = tuple(STATES)


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """Each method on each of its states, task by task."""
    return [
        {"key": f"{suite}/{task}/{state}/{method}", "suite": suite, "task": task, "state": state, "method": method}
        for suite, task, method in product(SUITES, range(10), METHODS)
        for state in (STATES[method] if full else range(1))
    ]


def run(trial: Trial) -> list[Row]:
    """One episode."""
    knowledge = load_knowledge()
    if trial["method"] == "random_route":
        knowledge = _random_routes(knowledge, np.random.default_rng([SEED, trial["task"], trial["state"]]))
    runner = _runner(trial["suite"], trial["task"]).knowing(knowledge)
    return [_row(runner.run(trial["state"]))]


@lru_cache(maxsize=1)
def _runner(suite: str, task: int) -> EpisodeRunner:
    """The scene of the task that this process works on; trials come task by task."""
    knowledge = load_knowledge()
    return EpisodeRunner.open(WORLD, find_task(suite, task), knowledge, seed=SEED)


def _random_routes(knowledge: Knowledge, rng: np.random.Generator) -> Knowledge:
    routes = sorted(iri for iri, route in knowledge.schema.routes.items() if route.level == "state")
    shuffled = {
        key: RouteEntry(routes[rng.integers(len(routes))], entry.decision, entry.rule)
        for key, entry in knowledge.tables.routing.items()
        if key[-1] == "state"
    }
    return Knowledge(knowledge.schema, RuleTables(knowledge.tables.diagnosis, shuffled))


def _row(episode: Episode) -> Row:
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
        "unmet": [str(diagnosis.fact) for diagnosis in first],
        "failures": [local_name(diagnosis.failure) for diagnosis in first],
        "routes": [local_name(attempt.selected.route) for attempt in episode.attempts if attempt.selected is not None],
    }


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Rates by method and suite with Wilson intervals; a crashed trial is a failure and is counted apart."""
    found: dict[str, float] = {"trials": len(rows), "crashed": sum("crashed" in row for row in rows)}
    for method, suite in product(METHODS, (*SUITES, "all")):
        chosen = [r for r in rows if r["method"] == method and suite in {r["suite"], "all"}]
        name = f"{method}.{suite}"
        found[f"{name}.n"] = len(chosen)
        for metric in ("accepted", "settled", "initially_true"):
            hits = sum(bool(row.get(metric)) for row in chosen)
            low, high = wilson(hits, len(chosen))
            found[f"{name}.{metric}"] = hits / max(len(chosen), 1)
            found[f"{name}.{metric}.low"], found[f"{name}.{metric}.high"] = low, high
        done = [row for row in chosen if "attempts" in row]
        found[f"{name}.attempts"] = sum(row["attempts"] for row in done) / max(len(done), 1)
        direct = sum(bool(row["accepted"]) and row["attempts"] <= len(row["unmet"]) for row in done)
        found[f"{name}.one_attempt_per_fact"] = direct / max(len(done), 1)
    return found


STATE_REPAIR = Protocol(
    name="state_repair",
    help="repair by writing the state, on the forty tasks of the four suites, beside randomly drawn routes",
    seeds=(SEED,),
    trials=trials,
    run=run,
    metrics=metrics,
)
