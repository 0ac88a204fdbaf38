from __future__ import annotations

from pathlib import Path

import pytest

SAMPLE = Path(__file__).resolve().parents[5] / "docs/examples/put_the_bowl_on_the_plate_demo.hdf5"


@pytest.fixture(scope="session")
def ref():
    from runtime.worlds.libero.simulator.assets import find_task

    return find_task("libero_goal", "put_the_bowl_on_the_plate")


@pytest.fixture(scope="session")
def sample():
    """The shipped file: two demonstrations, one with a recovery."""
    return SAMPLE


@pytest.fixture(scope="session")
def order(ref, tmp_path_factory):
    from runtime.worlds.libero.demos.collect import CollectionRequest

    return CollectionRequest(ref, 1, 0, tmp_path_factory.mktemp("demos"))


@pytest.fixture(scope="session")
def collected(order):
    """One demonstration, made now."""
    from runtime.worlds.libero.demos.collect import collect_task

    return collect_task(order, wait=True)
