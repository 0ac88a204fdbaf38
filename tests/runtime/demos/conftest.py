from __future__ import annotations

import pytest


@pytest.fixture(scope="session")
def ref():
    from runtime.simulator.assets import find_task

    return find_task("libero_goal", "put_the_bowl_on_the_plate")


@pytest.fixture(scope="session")
def order(ref, tmp_path_factory):
    from runtime.demos.collect import Order

    return Order(ref, 2, 0, tmp_path_factory.mktemp("demos"))


@pytest.fixture(scope="session")
def collected(order):
    from runtime.demos.collect import collect_task

    return collect_task(order, wait=True)
