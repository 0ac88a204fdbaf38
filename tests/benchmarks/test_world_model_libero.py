"""The protocol of LIBERO-Goal's world model: what its rows hold, and what follows from them."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("torch")

ON, OPEN, LIT = "on(bowl, plate)", "joint_state(drawer, open)", "joint_state(stove, on)"
UNITS = {ON: "m", OPEN: "m", LIT: "rad"}


def protocol():
    from benchmarks.world_model_libero import WORLD_MODEL_LIBERO

    return WORLD_MODEL_LIBERO


def told(truth, before, sharpness):
    """Of one fact: margins by 0.1 on their side, scores that are right where ``sharpness`` is positive."""
    truth, before = np.array(truth), np.array(before)
    score = 0.5 + sharpness * (truth - 0.5)
    return {
        "truth": truth.tolist(),
        "margin": (0.2 * truth - 0.1).tolist(),
        "still": before.tolist(),
        "still_margin": (0.2 * before - 0.1).tolist(),
        "imagined": score.tolist(),
        "imagined_margin": (0.2 * truth - 0.09).tolist(),
        "seen": truth.astype(float).tolist(),
        "seen_margin": (0.2 * truth - 0.1).tolist(),
    }


def filmed(film="demonstration", sharpness=0.8, lit=0, own=True):
    before, after = [0] * 6 + [1] * 4, [0] * 3 + [1] * 7
    facts = {ON: told(after, before, sharpness), OPEN: told(after, before, sharpness)}
    facts[LIT] = told([lit] * 2 + [0] * 8, [0] * 10, sharpness)
    events = {
        "success": [0.1] * 5 + [0.9] * 5, "succeeds": [0.0] * 5 + [1.0] * 5,
        "remaining": [1.5] * 10, "left": [None] * 5 + [1.0] * 5,
        "feasibility": [0.9] * 9 + [0.2], "clear": [1.0] * 9 + [0.0], "uncertainty": [0.1] * 10, "error": [0.3] * 10,
    }  # fmt: skip
    shared = {"mode": "none", "sees": "predicted", "windows": 10, "film": film, "demo": 0}
    rows = [{**shared, "fact": f, "unit": UNITS[f], "own": own and f == ON, "told": facts[f]} for f in facts]
    return [*rows, {**shared, "fact": "", "told": events}]


def figures(*films):
    return protocol().metrics([row for film in films for row in film])


def test_the_worst_fact_with_enough_positives_is_what_counts():
    found = figures(*[filmed() for _ in range(4)], filmed(lit=1, sharpness=-0.8))
    assert found[f"{ON}.positives"] == 35
    assert found[f"{LIT}.positives"] == 2  # too few, and told the wrong way round
    assert found["facts_ranked"] == 2
    assert found["auroc_min"] == found[f"{ON}.imagined_auroc"]
    wrong = 7 * 3 * 4 + 7 * 3 * 4 + 7 * 3  # pairs of a good and a bad row, and those within the bad one, the wrong way
    assert found["auroc_min"] < 1 - wrong / (35 * 15) / 2
    assert found[f"{ON}.imagined_auroc.low"] <= found[f"{ON}.imagined_auroc"] <= found[f"{ON}.imagined_auroc.high"]
    assert found["margin_mae_m"] == pytest.approx(0.01)
    assert found["seen_margin_mae_m"] == 0
    assert found["still_margin_mae_m"] == pytest.approx(0.3 * 0.2)
    assert found["ece_max"] == found[f"{ON}.imagined_ece"]


def test_persistence_stands_beside_and_fails_where_a_fact_begins_to_hold():
    found = figures(*[filmed() for _ in range(5)])
    assert found[f"{ON}.imagined_auroc"] == 1
    assert found[f"{ON}.still_auroc"] == pytest.approx((4 + 3 * 0.5) / 7)
    assert (found[f"{ON}.onsets"], found[f"{ON}.ends"]) == (15, 0)
    assert found[f"{ON}.still_own_onset_auroc"] == 0.5
    assert found[f"{ON}.imagined_own_onset_auroc"] == 1
    assert f"{OPEN}.still_own_auroc" not in found
    assert found[f"{ON}.still_wrong"] == pytest.approx(0.3)
    assert found["joint_state.positives"] == 35


def test_windows_of_other_tasks_do_not_count_among_a_facts_own():
    found = figures(*[filmed() for _ in range(5)], *[filmed(sharpness=-0.8, own=False) for _ in range(5)])
    assert found[f"{ON}.imagined_auroc"] < 0.6
    assert found[f"{ON}.imagined_own_auroc"] == found["imagined_own_auroc_min"] == 1
    assert found[f"{ON}.own_windows"] == 50


def test_altered_windows_and_crashes_are_counted_apart():
    altered = [filmed("altered", -0.8) for _ in range(5)]
    found = figures(*[filmed() for _ in range(5)], *altered, [{"crashed": "died", "task": 3}])
    assert (found["windows"], found["altered_windows"], found["crashed"]) == (50, 50, 1)
    assert found["auroc_min"] == 1
    assert found["altered.imagined_auroc_min"] == 0


def test_events_are_told_where_they_are_known():
    found = figures(*[filmed() for _ in range(2)])
    assert found["event.success_auroc"] == 1
    assert found["event.remaining_mae_s"] == pytest.approx(0.5)
    assert found["event.uncertainty_mae"] == pytest.approx(0.2)
    assert found["event.feasibility_auroc"] == 1


def test_what_cannot_be_ranked_is_left_out():
    films = [filmed() for _ in range(2)]
    for film in films:
        film[-1]["told"]["clear"] = [1.0] * 10
    found = figures(*films)
    assert "event.feasibility_auroc" not in found
    assert np.isfinite(list(found.values())).all()


def test_without_rows_there_is_no_figure_of_a_fact():
    assert protocol().metrics([{"crashed": "died", "task": 1}]) == {
        "demonstrations": 0, "windows": 0, "altered_windows": 0, "crashed": 1, "facts_ranked": 0
    }  # fmt: skip


@pytest.mark.sim
def test_a_row_holds_each_fact_that_a_task_asks_for(tmp_path):
    import torch

    from benchmarks.world_model_libero import _rows
    from grounding.world_model.dynamics import Dynamics
    from grounding.world_model.encoder import encoder
    from grounding.world_model.model import SceneModel
    from grounding.world_model.scene import SceneEventHead, SceneFactHead
    from onto_compiler.knowledge import load_knowledge
    from runtime.worlds.libero.training.hand import SIZE
    from runtime.worlds.libero.training.library import Filmed, _write
    from runtime.worlds.libero.training.scene import scene_facts
    from runtime.worlds.libero.training.windows import windows
    from tests.runtime.worlds.libero.training.conftest import made

    torch.manual_seed(0)
    asked, looks = scene_facts(load_knowledge()), encoder("pixels:8:128")
    motion = {"centre": [0.0] * SIZE, "scale": [1.0] * SIZE, "bound": [9.0] * SIZE, "actions": 7, "width": 8}
    network = Dynamics(motion, 192, 1.0, width=8)
    read = ([0.0] * SIZE, [1.0] * SIZE, 192, 1.0)
    count = len(asked.names)
    model = SceneModel(
        looks, network, SceneEventHead(count, *read, width=8), SceneFactHead(asked.names, [1.0] * count, *read, width=8)
    )
    films = []
    for trial, kind in enumerate(("demonstration", "altered")):
        films.append(Filmed(3, trial, trial, kind, tmp_path / "films.0" / "task" / f"{trial}.npz"))
        _write(films[-1].path, made(np.random.default_rng(trial), count))
    data = windows(films, asked, looks, tmp_path / "features.npy", lambda _text: None)
    rows = list(_rows(model, asked, data))
    assert [one["film"] for one in rows if not one["fact"]] == ["demonstration", "altered"]
    told = {one["fact"]: one["unit"] for one in rows if one["fact"]}
    assert set(told) == {asked.names[place] for place in asked.positive}
    assert set(told.values()) == {"m", "rad"}
    assert {one["fact"].partition("(")[0] for one in rows if one.get("own")} == {"inside", "joint_state"}
    assert {len(values) for one in rows for values in one["told"].values()} == {4}
    assert protocol().metrics(rows)["windows"] == 4
