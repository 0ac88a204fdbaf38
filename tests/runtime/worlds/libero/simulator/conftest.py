"""One task of LIBERO in an official initial state, in its own environment."""

from __future__ import annotations

import os
import shutil

import pytest


@pytest.fixture(scope="session")
def ref():
    from runtime.worlds.libero.simulator.assets import find_task

    return find_task("libero_goal", "put_the_bowl_on_the_stove")


@pytest.fixture(scope="session")
def state(ref):
    from runtime.worlds.libero.simulator.assets import initial_states

    return initial_states(ref)[3]


@pytest.fixture
def own_assets(tmp_path):
    """A folder of links to LIBERO's assets, and the folder of a configuration that names it."""
    from runtime.worlds.libero.simulator.assets import asset_folders

    (packaged,) = asset_folders()
    folder = tmp_path / "assets"
    shutil.copytree(packaged, folder, copy_function=os.symlink)
    (tmp_path / "config.yaml").write_text(f"assets: {folder}\n")
    return folder, tmp_path


@pytest.fixture(scope="module")
def native(ref):
    from runtime.worlds.libero.simulator.native import NativeTask

    with NativeTask.open(ref) as task:
        yield task
