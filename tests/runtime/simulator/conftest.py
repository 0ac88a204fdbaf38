"""One task of LIBERO in an official initial state, in its own environment."""

from __future__ import annotations

import pytest


@pytest.fixture(scope="session")
def ref():
    from runtime.simulator.assets import find_task

    return find_task("libero_goal", "put_the_bowl_on_the_stove")


@pytest.fixture(scope="session")
def state(ref):
    from runtime.simulator.assets import initial_states

    return initial_states(ref)[3]


@pytest.fixture(scope="module")
def native(ref):
    from runtime.simulator.native import NativeTask

    with NativeTask.open(ref) as task:
        yield task
