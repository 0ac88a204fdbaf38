"""How our grounding compares with LIBERO's own predicates: on how many states, how near to thresholds, at what cost.

There is no baseline: the native predicate is the oracle, and every disagreement counts.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from benchmarks.probing import CLOSE, GOAL_TASKS, OTHER_TASKS, Counts, Sample, probe
from benchmarks.protocol import Protocol, Row, Trial
from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.bddl.lift import required_abox
from onto_compiler.bddl.parse import parse_file
from onto_compiler.compile_schema import load_schema
from runtime.worlds.libero.simulator.assets import find_task
from runtime.worlds.libero.simulator.native import NativeTask

__all__ = ["GROUNDING"]

COUNTS = {True: Counts(randoms=200, settles=15, edges=10), False: Counts(randoms=20, settles=2, edges=2)}
REPEATS = 2000
KINDS = ("in_site", "joint_threshold", "on_object", "on_site")


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """Ten LIBERO-Goal tasks, and ten of other suites that use the remaining predicates."""
    return [
        {"key": f"{suite}/{task}", "suite": suite, "task": task, "full": full}
        for suite, task in (*GOAL_TASKS, *OTHER_TASKS)
    ]


def run(trial: Trial) -> list[Row]:
    """One row per grounding function that the task's goal uses: comparisons in the states made for the task."""
    schema = load_schema()
    samples = probe(trial["suite"], trial["task"], schema, COUNTS[trial["full"]])
    seconds = _seconds_per_fact(trial)
    rows = []
    for kind in sorted({sample.grounded_by for sample in samples}):
        chosen = [sample for sample in samples if sample.grounded_by == kind]
        made = [sample for sample in chosen if sample.target]
        rows.append(
            {
                "mode": "none",
                "sees": "privileged-state",
                "grounded_by": kind,
                "comparisons": len(chosen),
                "mismatches": sum(not sample.truth == sample.compiled == sample.native for sample in chosen),
                "sign_violations": sum(
                    (sample.margin > 0 and not sample.native) or (sample.margin < 0 and sample.native)
                    for sample in chosen
                ),
                "states": len(made),
                "true_states": sum(sample.native for sample in made),
                "near_true": _near(made, holds=True),
                "near_false": _near(made, holds=False),
                "us_per_fact": round(seconds[kind] * 1e6, 2) if kind in seconds else None,
            }
        )
    return rows


def _near(samples: Sequence[Sample], *, holds: bool) -> int:
    """States in which some term lies within 1 mm or 1 mrad of its threshold, on the given side of it."""
    return sum(any(abs(t.margin) < CLOSE and t.holds is holds for t in sample.terms) for sample in samples)


def _seconds_per_fact(trial: Trial) -> dict[str, float]:
    """The mean time that one fact of each grounding function takes in the task's own first state."""
    schema = load_schema()
    ref = find_task(trial["suite"], trial["task"])
    required = required_abox(parse_file(ref.bddl), schema, ref.name)
    facts = (*required.facts, *(replace(fact, threshold=0.0) for fact in required.premise))
    found: dict[str, float] = {}
    with NativeTask.open(ref) as native:
        scene = Scene(native.model)
        for kind in sorted({fact.grounded_by for fact in facts}):
            grounder = SimGrounder(scene, [fact for fact in facts if fact.grounded_by == kind], schema)
            times = []
            for _ in range(REPEATS // 20):
                started = time.perf_counter()
                for _ in range(20):
                    grounder.observe(native.data)
                times.append((time.perf_counter() - started) / 20 / len(grounder.facts))
            found[kind] = float(np.median(times))
    return found


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Totals, and for the ten LIBERO-Goal tasks the share of true states by grounding function."""
    whole = [row for row in rows if "crashed" not in row]
    goal = [row for row in whole if row["suite"] == "libero_goal"]
    found: dict[str, float] = {"crashed": len(rows) - len(whole)}
    for name in ("comparisons", "mismatches", "sign_violations", "states", "near_true", "near_false"):
        found[name] = sum(row[name] for row in whole)
    found["goal_states"] = sum(row["states"] for row in goal)
    for kind, (name, chosen) in product(KINDS, (("goal", goal), ("all", whole))):
        mine = [row for row in chosen if row["grounded_by"] == kind]
        states = sum(row["states"] for row in mine)
        found[f"{name}.{kind}.states"] = states
        found[f"{name}.{kind}.true_share"] = sum(row["true_states"] for row in mine) / max(states, 1)
        times = [row["us_per_fact"] for row in mine if row["us_per_fact"] is not None]
        if times:
            found[f"{name}.{kind}.us_per_fact"] = float(np.median(times))
    return found


GROUNDING = Protocol(
    name="grounding",
    help="truth and margin against LIBERO's own predicates, on random, settled and adversarial states",
    seeds=tuple(range(10)),
    trials=trials,
    run=run,
    metrics=metrics,
    timed=frozenset({"us_per_fact"}),
)
