"""PointMaze: planners in a world model, compared on the same trials and budgets, over three trained models.

The trials are the 50 published ones and 300 fresh ones of the same kind, numbers 250 and up: those between were looked
at while the rows were made, and are in no table. What verifies is the true state: a trial is a
success within 0.5 m of the target, and its distance is that over (x, y, vx, vy) at its end. Predictions are counted
apart: for each executed plan, what was predicted of its end and what the simulator showed of it. The protocol is
written down in docs/protocols/pointmaze.md.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, lru_cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks.intervals import wilson
from benchmarks.paired import bootstrap, crossed, holm
from benchmarks.pointmaze_speed import from_nothing_minutes, grounding_ms, table_minutes
from benchmarks.protocol import Protocol, Row, Trial
from onto_compiler.knowledge import load_knowledge
from onto_compiler.schema import local_name
from onto_compiler.tables import FIRST
from runtime.trace.file import write_trace
from runtime.worlds.pointmaze.grounded import MazeFacts, required_facts
from runtime.worlds.pointmaze.maze import MACRO_STEPS, maze_named
from runtime.worlds.pointmaze.planning.models import SEEDS, shipped
from runtime.worlds.pointmaze.planning.mpc import ExecutedStep, Planner, TrialResult, play
from runtime.worlds.pointmaze.planning.playing import episodes, generator
from runtime.worlds.pointmaze.planning.rows import MAZE, ROWS, maze_rollout, planner
from runtime.worlds.pointmaze.planning.trace import SUITE
from runtime.worlds.pointmaze.trials import PUBLISHED, trial

__all__ = ["BLOCKS", "COMPARED", "MEASURES", "POINTMAZE", "SPEED_METRICS", "TRACES", "fact_names"]

BLOCKS = {"published": range(PUBLISHED), "fresh": range(250, 550)}
SMALL = 2
"""Trials of each row, with the first model."""
TRACES = Path("out/bench/pointmaze")
"""Where each trial leaves its trace: predicted and simulated ABoxes side by side, and what was tried."""
_DRAWN = "random_search"
_SPEED, _TIMED = "speed", ("grounding", "table", "from_nothing")
SPEED_METRICS = ("grounding_300x5_ms", "table_min", "training_min", "from_nothing_min")
COMPARED = {
    "onto_vs_event": ("onto", "event"),
    "onto_vs_feature": ("onto", "feature"),
    "onto_vs_feature_dinowm": ("onto", "feature_dinowm"),
    "onto_vs_feature_images": ("onto", "feature_images"),
    "onto_vs_untyped": ("onto", "onto_untyped"),
    "search_vs_onto": ("search", "onto"),
    "search_vs_random": ("search", "random_search"),
    "search_vs_undirected": ("search", "undirected_search"),
    "search_vs_constant": ("search", "constant_mechanism"),
    "search_vs_large": ("search", "large"),
}
"""Which rows are tested against each other."""
MEASURES: Mapping[str, Callable[[Row], float]] = {
    "distance": lambda row: float(row["distance"]),
    "position": lambda row: float(row["position"]),
    "velocity": lambda row: float(row["velocity"]),
    "first_plan": lambda row: float(row["success"] and row["time"] <= 1),
}
"""What is tested, each with an adjustment of its own: the final distance, its two parts, success after one plan."""


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """Each row with each model on each trial; what asks no model is run once."""
    numbers = [number for block in BLOCKS.values() for number in block] if full else range(SMALL)
    played: list[Trial] = [
        {"key": f"{name}/{seed}/{number}", "row": name, "model": seed, "trial": number}
        for name, row in ROWS.items()
        for seed, number in product(SEEDS if row.learned and full else SEEDS[:1], numbers)
    ]
    measured: list[Trial] = [
        {"key": f"{_SPEED}/{what}", "row": _SPEED, "measured": what} for what in (_TIMED if full else _TIMED[:1])
    ]
    return played + measured


def timed(trial_: Trial) -> bool:
    """Whether the trial is how long something takes, and not a row of the table."""
    return bool(trial_["row"] == _SPEED)


def run(trial_: Trial) -> list[Row]:
    """One trial, or one thing that is timed."""
    if timed(trial_):
        return [_timed(trial_["measured"])]
    torch.set_num_threads(1)
    name, seed, number = trial_["row"], trial_["model"], trial_["trial"]
    played = play(trial(number), _planner(name, shipped(seed)), maze_rollout(), generator(number, seed), MACRO_STEPS)
    knowledge = load_knowledge()
    records = episodes(name, [played], _facts(), knowledge, seed, shipped(seed))
    write_trace(TRACES / name / str(seed) / f"{number}.trig.gz", [(f"{SUITE}-{name}", records)], knowledge.schema)
    return [
        {
            "mode": "controller",
            "sees": ROWS[name].sees,
            "block": next(block for block, numbers in BLOCKS.items() if number in numbers),
            **played.figures,
            "planning_s": played.seconds,
            "predicted": list(_predicted(played)),
        }
    ]


@lru_cache(maxsize=1)
def _planner(name: str, folder: Path) -> Planner:
    """Trials come row by row, and a planner forgets the last one as the next begins."""
    return planner(name, folder)


def _timed(what: str) -> Row:
    row: Row = {"mode": "none", "sees": "predicted"}
    if what == "grounding":
        return {**row, "grounding_300x5_ms": round(grounding_ms(shipped(SEEDS[0])), 3)}
    if what == "table":
        return {**row, "table_min": round(table_minutes(shipped(SEEDS[0])), 3)}
    made, table = from_nothing_minutes()
    return {**row, "training_min": round(made, 3), "from_nothing_min": round(made + table, 3)}


def _predicted(played: TrialResult) -> Iterator[dict[str, Any]]:
    """Of each plan: facts as predicted (None where not observed) and as simulated of its end, and what was tried."""
    facts = _facts()
    for step in played.steps:
        seen = step.made.predicted
        if seen is None:
            continue
        true = facts.observe(step.states[-1], played.trial.goal)
        known = seen.observed
        yield {
            "truth": [[bool(p) if k else None, bool(s)] for k, p, s in zip(known, seen.truth, true.truth, strict=True)],
            "margin": [
                [round(float(p), 4) if k else None, round(float(s), 4)]
                for k, p, s in zip(known, seen.margin, true.margin, strict=True)
            ],
            **_tried(step),
        }


def _tried(step: ExecutedStep) -> dict[str, Any]:
    found = step.made.searched
    if found is None:
        return {}
    return {
        "retained": found.retained,
        "tried": [[local_name(t.diagnosis.failure), t.mechanism, t.better, t.evaluations] for t in found.tried],
    }


@cache
def _facts() -> MazeFacts:
    knowledge = load_knowledge()
    return MazeFacts(maze_named(MAZE), required_facts(knowledge), knowledge)


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Each row's rates and distances, with intervals over trials, and the paired comparisons."""
    played = [row for row in rows if row["row"] != _SPEED]
    whole = [row for row in played if "crashed" not in row]
    found: dict[str, float] = {
        "trials": len({row["trial"] for row in played}),
        "training_seeds": len({row["model"] for row in played}),
        "crashed": sum("crashed" in row for row in rows),
    }
    for row in rows:
        found |= {name: row[name] for name in SPEED_METRICS if name in row}
    for name in ROWS:
        found |= _of_row(name, [row for row in whole if row["row"] == name])
    p: dict[str, dict[str, float]] = {measure: {} for measure in MEASURES}
    for (name, (one, other)), (measure, value) in product(COMPARED.items(), MEASURES.items()):
        models, gaps = _differences(whole, one, other, value)
        if gaps.size:
            suffix = "" if measure == "distance" else f"_{measure}"
            gap = f"{name.replace('_vs_', '_minus_')}{suffix}"
            found[gap] = float(gaps.mean())
            found[f"{gap}.low"], found[f"{gap}.high"], p[measure][f"{name}{suffix}_p"] = crossed(gaps)
            found |= {
                f"{gap}.model_{model}": float(mean) for model, mean in zip(models, gaps.mean(axis=1), strict=True)
            }
    for some in p.values():
        found |= holm(some)
    return found | _by_chance(whole)


def _differences(
    rows: Sequence[Row], one: str, other: str, value: Callable[[Row], float]
) -> tuple[list[int], NDArray[np.float64]]:
    """The models that both rows have, and ``value`` of ``one`` less that of ``other`` (models, trials they share)."""
    of = {(row["row"], row["model"], row["trial"]): value(row) for row in rows if row["row"] in {one, other}}
    models = sorted({model for name, model, _ in of if name == one} & {model for name, model, _ in of if name == other})
    numbers = sorted({number for _, _, number in of})
    shared = [n for n in numbers if all((name, model, n) in of for name, model in product((one, other), models))]
    gaps = [[of[one, model, n] - of[other, model, n] for n in shared] for model in models]
    return models, np.array(gaps, dtype=np.float64).reshape(len(models), len(shared))


def _of_row(name: str, rows: Sequence[Row]) -> dict[str, float]:
    if not rows:
        return {}
    count = len(rows)
    means = np.array(list(_by_trial(rows).values()))
    found: dict[str, float] = {f"{name}_n": count, f"{name}_success": _share(rows, lambda row: row["success"])}
    found[f"{name}_success.low"], found[f"{name}_success.high"] = wilson(sum(r["success"] for r in rows), count)
    for plans in (1, 2):  # by their time: a plan of two horizons is two
        found[f"{name}_success_{plans}"] = _share(rows, lambda row, most=plans: row["success"] and row["time"] <= most)
    found[f"{name}_distance"] = float(means.mean())
    found[f"{name}_distance.low"], found[f"{name}_distance.high"] = bootstrap(means)
    for part in ("position", "velocity", "evaluations", "planning_s"):
        found[f"{name}_{part}"] = float(np.mean([row[part] for row in rows]))
    for block in BLOCKS:
        some = [row for row in rows if row["block"] == block]
        if some:
            found[f"{name}_{block}_success"] = _share(some, lambda row: row["success"])
            found[f"{name}_{block}_distance"] = float(np.mean([row["distance"] for row in some]))
    made = [plan for row in rows for plan in row["predicted"]]
    for place, fact in enumerate(fact_names() if made else ()):
        pairs = np.array([plan["truth"][place] for plan in made if plan["truth"][place][0] is not None])
        if len(pairs):
            found[f"{name}_{fact}.false_satisfied"] = float((pairs[:, 0] & ~pairs[:, 1]).mean())
            found[f"{name}_{fact}.false_missing"] = float((~pairs[:, 0] & pairs[:, 1]).mean())
    return found | _answers(name, made)


def _answers(name: str, plans: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """How often each mechanism answered each predicted failure, and in what share its plan took the best one's place.

    A mechanism that has no plan to offer spends no evaluations, and is no answer.
    """
    answers: dict[str, list[bool]] = {}
    for plan in plans:
        for failure, mechanism, better, *spent in plan.get("tried", ()):
            if spent and spent[0]:
                answers.setdefault(f"{name}.{failure}.{mechanism}", []).append(better)
    shares = {f"{key}.better": float(np.mean(some)) for key, some in answers.items()}
    return {f"{key}.answers": len(some) for key, some in answers.items()} | shares


def _by_chance(rows: Sequence[Row]) -> dict[str, float]:
    """Of ``random_search``, whose mechanisms meet every failure: the shares in which each bettered its plan.

    By mechanism, whatever failed; and of those answers whose mechanism is the one that the rules name first.
    """
    kept: dict[str, list[bool]] = {}
    for plan in (plan for row in rows if row["row"] == _DRAWN for plan in row["predicted"]):
        for failure, mechanism, better, *spent in plan.get("tried", ()):
            if spent and spent[0]:
                kept.setdefault(f"{mechanism}", []).append(better)
                if mechanism == _first_routes().get(failure):
                    kept.setdefault("by_rule", []).append(better)
    shares = {f"{_DRAWN}_{name}.bettered": float(np.mean(some)) for name, some in kept.items()}
    return shares | {f"{_DRAWN}_{name}.answered": len(some) for name, some in kept.items()}


@cache
def _first_routes() -> dict[str, str]:
    """The plan route that the rules name first for each failure, both by local name."""
    routing = load_knowledge().tables.routing.items()
    return {
        local_name(failure): local_name(entry.route)
        for (_, failure, status, _, level), entry in routing
        if (status, level) == (FIRST, "plan")
    }


@cache
def fact_names() -> tuple[str, ...]:
    """The predicates of the required facts, in their order."""
    return tuple(local_name(fact.predicate) for fact in _facts().required.facts)


def _share(rows: Sequence[Row], holds: Any) -> float:  # noqa: ANN401 - a predicate of a row
    return sum(bool(holds(row)) for row in rows) / len(rows)


def _by_trial(rows: Sequence[Row]) -> dict[int, float]:
    """The final distance of each trial, a mean over the models."""
    found: dict[int, list[float]] = {}
    for row in rows:
        found.setdefault(row["trial"], []).append(row["distance"])
    return {number: float(np.mean(some)) for number, some in found.items()}


POINTMAZE = Protocol(
    name="pointmaze",
    help="PointMaze by features, events, typed facts and guided search, on equal budgets",
    seeds=SEEDS,
    trials=trials,
    run=run,
    metrics=metrics,
    alone=timed,
    parts="row",
    arms="row",
    timed=frozenset({"planning_s", *SPEED_METRICS}),
)
