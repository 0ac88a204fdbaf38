"""Plans are made on whatever device the model lies on, by the same random numbers."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from runtime.planning.cem import Budget
from runtime.worlds.pointmaze.maze import MACRO_STEPS
from runtime.worlds.pointmaze.planning import rows
from runtime.worlds.pointmaze.planning.mpc import play
from runtime.worlds.pointmaze.planning.playing import generator
from runtime.worlds.pointmaze.trials import trial
from tests.gpu import DEVICE, Gpu
from tests.runtime.planning.models import write_model

pytestmark = pytest.mark.sim
ROWS = ("feature_images", "event_blind", "onto", "search_blind")
"""Between them every score, every mechanism, and an estimate of what is not sensed."""


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    return write_model(tmp_path_factory.mktemp("model"))


@pytest.mark.parametrize("name", ROWS)
def test_a_row_plans_on_the_device_as_it_does_on_the_cpu(model, name, monkeypatch):
    monkeypatch.setitem(rows.ROWS, name, _small(rows.ROWS[name]))
    monkeypatch.setattr(rows, "ALLOWANCE", 400)
    here = _played(name, model, "cpu")
    with Gpu() as gpu:
        there = _played(name, model, DEVICE)
    assert gpu.operations > 100
    assert len(here.steps) == len(there.steps)
    for one, two in zip(here.steps, there.steps, strict=True):
        np.testing.assert_allclose(one.made.actions, two.made.actions, atol=1e-4)
        np.testing.assert_allclose(one.made.predicted.margin, two.made.predicted.margin, atol=1e-4)
        assert one.made.evaluations == two.made.evaluations


def test_what_was_left_behind_is_found_out():
    with Gpu(), pytest.raises(RuntimeError, match="expected all tensors on one device"):
        torch.ones(3, device=DEVICE) + torch.ones(3)
    with Gpu(), pytest.raises(RuntimeError, match="numpy"):
        torch.ones(3, device=DEVICE).numpy()


def _small(row):
    return rows.PlannerRow(row.score, row.sensed, Budget(40, 6, 3), row.after, row.truth)


def _played(name, model, device):
    who = rows.planner(name, model, device)
    return play(trial(3), who, rows.maze_rollout(), generator(3, 0), MACRO_STEPS, 1)
