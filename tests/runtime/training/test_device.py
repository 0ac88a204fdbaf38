"""A world model is trained on whatever device there is, from the same batches."""

from __future__ import annotations

import pytest
import torch

from grounding.world_model.checkpoint import load
from grounding.world_model.model import FILES, load_world_model
from runtime.training import STAGES
from runtime.training.stages import TrainingDir
from runtime.worlds.pointmaze.training import MazeTrainingConfig, train
from tests.gpu import DEVICE, Gpu
from tests.interruption import interrupted

pytestmark = pytest.mark.sim
COURSE = MazeTrainingConfig(
    encoder="pixels:8:64",
    trajectories=12,
    steps=60,
    components=6,
    members=2,
    motion=6,
    appearance=4,
    estimate=4,
    heads=4,
)


def trained(folder, device):
    place = TrainingDir(folder, device=device)
    return {stage: train(stage, COURSE, place, "", "", lambda _text: None) for stage in STAGES}


def test_every_stage_trains_on_the_device_as_it_does_on_the_cpu(quick, tmp_path):
    here = trained(tmp_path / "here", "cpu")
    with Gpu() as gpu:
        there = trained(tmp_path / "there", DEVICE)
    assert gpu.operations > 1000
    for stage in STAGES:
        assert there[stage] == pytest.approx(here[stage], rel=1e-3, abs=1e-4, nan_ok=True)
    one, two = load_world_model(tmp_path / "here"), load_world_model(tmp_path / "there")
    for ours, theirs in zip(one.dynamics.parameters(), two.dynamics.parameters(), strict=True):
        assert torch.allclose(ours, theirs, atol=1e-4)


def test_an_interrupted_training_goes_on_on_the_device(quick, tmp_path):
    with Gpu():
        trained(tmp_path / "whole", DEVICE)
        place = TrainingDir(tmp_path / "cut", device=DEVICE)
        train("projection", COURSE, place, "", "", lambda _text: None)
        with interrupted(saves=3):
            train("dynamics", COURSE, place, "", "", lambda _text: None)
        train("dynamics", COURSE, place, "", "", lambda _text: None)
    whole, cut = (load(tmp_path / name / FILES["dynamics"], "dynamics") for name in ("whole", "cut"))
    assert whole.identity == cut.identity
