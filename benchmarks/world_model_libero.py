"""LIBERO-Goal's scene: facts after 25 control steps, predicted from a picture, proprioception and actions.

The windows are of demonstrations that were made for this: other trials, from initial states that no demonstration of
the training starts from. Beside what the model tells of an imagined end stands what its heads tell of the end as it was
seen, and persistence: fact and margin as they truly are when the window begins, which no robot knows as exactly.
Windows of actions that leave a demonstration (``altered``) are counted apart.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks.protocol import Protocol, Row, Trial
from benchmarks.world_model_tables import WAYS
from grounding.world_model.model import SceneModel, load_scene_model
from onto_compiler.knowledge import load_knowledge
from runtime.training.measures import auroc, calibration_error
from runtime.wording import unit_of
from runtime.worlds.libero.simulator.assets import tasks
from runtime.worlds.libero.training.library import TEST_SEED, FilmRequest, filmed
from runtime.worlds.libero.training.measure import ENOUGH, predict_events, predict_facts
from runtime.worlds.libero.training.models import shipped
from runtime.worlds.libero.training.scene import SUITE, SceneFacts, scene_facts
from runtime.worlds.libero.training.windows import Windows, windows

__all__ = ["WORLD_MODEL_LIBERO"]

SEED = 0
COUNT = 10
"""Demonstrations of each task, one for each initial state that is for tests."""
SMALL = (1, 8)
FOLDER = Path("out/bench/world_model_libero")
_DRAWS = 300

Array = NDArray[np.float64]


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """Each task; small: the first demonstrations of two."""
    chosen = [ref for ref in tasks(SUITE) if full or ref.index in SMALL]
    return [{"key": f"{SUITE}/{ref.index}", "task": ref.index, "count": COUNT if full else 1} for ref in chosen]


def run(trial: Trial) -> list[Row]:
    """A row for each film of the task and each fact, and one for its events: predictions and truth at the ends."""
    torch.set_num_threads(1)
    model, asked = _model(), _suite_facts()
    shoot = FilmRequest(FOLDER, trial["count"], TEST_SEED, (trial["task"],), ("test",), exact=True)
    films = filmed(shoot, 1, lambda _text: None)
    data = windows(films, asked, model.encoder, FOLDER / f"features.{trial['task']}.npy", lambda _text: None)
    return list(_rows(model, asked, data))


def _rows(model: SceneModel, asked: SceneFacts, data: Windows) -> Iterator[Row]:
    wanted = list(asked.positive)  # what a task asks not to hold is never true here
    schema = load_knowledge().schema
    task = data.films[0].task  # a trial is of one task
    imagined, seen = predict_facts(model.dynamics, model.facts, [asked.facts[place] for place in wanted], data)
    events = predict_events(model.dynamics, model.events, asked, data)
    truth, margin = data.truth[..., wanted], data.margin[..., wanted]
    for number, film in enumerate(data.films):
        rows = np.flatnonzero(data.film == number)
        shared = {
            "mode": "none",
            "sees": "predicted",
            "task": task,
            "demo": film.trial,
            "state": film.state,
            "film": film.kind,
            "windows": len(rows),
        }
        for place, fact in enumerate(wanted):
            yield {
                **shared,
                "fact": asked.names[fact],
                "unit": unit_of(asked.facts[fact], schema),
                "own": fact in asked.needed[task],
                "told": {
                    "truth": truth[rows, -1, place].astype(int).tolist(),
                    "margin": _short(margin[rows, -1, place]),
                    "still": truth[rows, 0, place].astype(int).tolist(),
                    "still_margin": _short(margin[rows, 0, place]),
                    "imagined": _short(imagined.score[rows, place]),
                    "imagined_margin": _short(imagined.margin[rows, place]),
                    "seen": _short(seen.score[rows, place]),
                    "seen_margin": _short(seen.margin[rows, place]),
                },
            }
        yield {**shared, "fact": "", "told": {name: _short(values[rows]) for name, values in events.items()}}


def _short(values: NDArray[Any]) -> list[float | None]:
    return [round(float(value), 4) if np.isfinite(value) else None for value in values]


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """AUROC, margin errors and calibration of each fact, with intervals over demonstrations; then their worst."""
    whole = [row for row in rows if "crashed" not in row]
    units = {row["fact"]: row["unit"] for row in whole if row["fact"]}
    calm = [row for row in whole if row["film"] == "demonstration"]
    other = [row for row in whole if row["film"] != "demonstration"]
    found: dict[str, float] = {
        "demonstrations": sum(not row["fact"] for row in calm),
        "windows": sum(row["windows"] for row in calm if not row["fact"]),
        "altered_windows": sum(row["windows"] for row in other if not row["fact"]),
        "crashed": len(rows) - len(whole),
    }
    for prefix, some in (("", calm), ("altered.", other)):
        for name in units:
            mine = [row for row in some if row["fact"] == name]
            columns = _of_fact(mine, intervals=not prefix) | _in_own(mine)
            found |= {f"{prefix}{name}.{key}": value for key, value in columns.items()}
        for predicate in sorted({_predicate(name) for name in units}):
            mine = [row for row in some if _predicate(row["fact"]) == predicate]
            found |= {f"{prefix}{predicate}.{key}": value for key, value in _of_predicate(mine).items()}
    found |= _events([row for row in calm if not row["fact"]])
    ranked = [name for name in units if found.get(f"{name}.positives", 0) >= ENOUGH]
    found["facts_ranked"] = len(ranked)
    for way, prefix, among in product(WAYS, ("", "altered."), ("", "own_", "own_onset_")):
        worst = [found[key] for name in ranked if (key := f"{prefix}{name}.{way}_{among}auroc") in found]
        if worst:
            found[f"{prefix}{way}_{among}auroc_min"] = min(worst)
    if ranked:
        found["auroc_min"] = found["imagined_auroc_min"]
        metres = [name for name in ranked if units[name] == "m"]
        for way in WAYS:
            label = "margin_mae_m" if way == "imagined" else f"{way}_margin_mae_m"
            found[label] = float(np.mean([found[f"{name}.{way}_mae"] for name in metres]))
            found[f"{way}_ece_max"] = max(found[f"{name}.{way}_ece"] for name in ranked)
        found["ece_max"] = found["imagined_ece_max"]
    return {name: value for name, value in found.items() if np.isfinite(value)}


def _of_fact(rows: Sequence[Row], *, intervals: bool) -> dict[str, float]:
    """The figures of one fact over all windows of ``rows``."""
    parts = [_columns(row["told"]) for row in rows]
    if not parts:
        return {}
    every = _joined(parts)
    truth, before = every["truth"] > 0, every["still"] > 0
    found: dict[str, float] = {
        "positives": float(truth.sum()),
        "onsets": float((truth & ~before).sum()),
        "ends": float((~truth & before).sum()),
    }
    for way in WAYS:
        margin = every["still_margin" if way == "still" else f"{way}_margin"]
        found[f"{way}_mae"] = float(np.abs(margin - every["margin"]).mean())
        found[f"{way}_ece"] = calibration_error(every[way], truth)
        found[f"{way}_wrong"] = float(((every[way] > 0.5) != truth).mean())
        if truth.any() and not truth.all():
            found[f"{way}_auroc"] = auroc(_rank(every, way), truth)
            if intervals:
                found |= _interval(parts, way)
    return found


def _in_own(rows: Sequence[Row]) -> dict[str, float]:
    """How one fact is ranked among the windows of the tasks that ask for it, and where it does not hold at first.

    In the other tasks it is hardly ever about to hold, which is easily seen.
    """
    parts = [_columns(row["told"]) for row in rows if row["own"]]
    if not parts:
        return {}
    every = _joined(parts)
    truth, before = every["truth"] > 0, every["still"] > 0
    found: dict[str, float] = {"own_windows": float(len(truth))}
    for way in WAYS:
        rank = _rank(every, way)
        for key, some in (("own", np.ones_like(truth)), ("own_onset", ~before)):
            if truth[some].any() and not truth[some].all():
                found[f"{way}_{key}_auroc"] = auroc(rank[some], truth[some])
    return found


def _interval(parts: Sequence[Mapping[str, Array]], way: str) -> dict[str, float]:
    """The 95 % percentile interval of the AUROC, demonstrations drawn again."""
    random = np.random.default_rng(SEED)
    drawn = []
    for _ in range(_DRAWS):
        some = _joined([parts[place] for place in random.integers(len(parts), size=len(parts))])
        truth = some["truth"] > 0
        if truth.any() and not truth.all():
            drawn.append(auroc(_rank(some, way), truth))
    low, high = np.quantile(drawn, [0.025, 0.975])
    return {f"{way}_auroc.low": float(low), f"{way}_auroc.high": float(high)}


def _of_predicate(rows: Sequence[Row]) -> dict[str, float]:
    """The figures of all facts of one predicate together."""
    parts = [_columns(row["told"]) for row in rows]
    if not parts:
        return {}
    every = _joined(parts)
    truth = every["truth"] > 0
    found: dict[str, float] = {"positives": float(truth.sum())}
    for way in WAYS:
        found[f"{way}_ece"] = calibration_error(every[way], truth)
        if truth.any() and not truth.all():
            found[f"{way}_auroc"] = auroc(_rank(every, way), truth)
    return found


def _events(rows: Sequence[Row]) -> dict[str, float]:
    """Metrics of the events of the window's own task."""
    if not rows:
        return {}
    every = _joined([_columns(row["told"]) for row in rows])
    there = np.isfinite(every["left"])
    success = every["succeeds"] > 0
    return (
        {
            "event.success_auroc": auroc(every["success"], success),
            "event.success_ece": calibration_error(every["success"], success),
            "event.remaining_mae_s": float(np.abs(every["remaining"] - every["left"])[there].mean()),
            "event.feasibility_auroc": auroc(every["feasibility"], every["clear"] > 0),
            "event.uncertainty_mae": float(np.abs(every["uncertainty"] - every["error"]).mean()),
        }
        if success.any() and not success.all()
        else {}
    )


def _columns(columns: Mapping[str, Sequence[float | None]]) -> dict[str, Array]:
    return {name: np.array([np.nan if v is None else v for v in values]) for name, values in columns.items()}


def _joined(parts: Sequence[Mapping[str, Array]]) -> dict[str, Array]:
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _rank(every: Mapping[str, Array], way: str) -> Array:
    """What orders the windows: a score; of persistence the truth, and the margin within each side of it."""
    return every["still"] + np.tanh(every["still_margin"]) / 2 if way == "still" else every[way]


def _predicate(name: str) -> str:
    return name.partition("(")[0]


@cache
def _suite_facts() -> SceneFacts:
    return scene_facts(load_knowledge())


@cache
def _model() -> SceneModel:
    return load_scene_model(shipped(SEED))


WORLD_MODEL_LIBERO = Protocol(
    name="world_model_libero",
    help="facts after 25 steps on LIBERO-Goal, predicted from pictures and actions, compared with persistence",
    seeds=(SEED, TEST_SEED),
    trials=trials,
    run=run,
    metrics=metrics,
    of_processor=frozenset({"told"}),  # of pictures that the processor draws, and of states that come about by BLAS
)
