"""A training of seconds."""

from __future__ import annotations

import pytest

from runtime.training import heads, motion
from runtime.worlds.pointmaze import training as pointmaze


@pytest.fixture
def quick(monkeypatch):
    """Few rows in a batch, and few trajectories to test on."""
    for module, name in ((motion, "_BATCH"), (motion, "_SEGMENTS"), (heads, "_SEGMENTS")):
        monkeypatch.setattr(module, name, 16)
    monkeypatch.setattr(pointmaze, "_TEST", 8)
