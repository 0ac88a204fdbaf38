"""Scenes on disk, as several processes and bad disks leave them: never a wrong scene, and never a traceback."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from runtime.worlds.libero.simulator.scene_cache import SceneCache

pytestmark = pytest.mark.sim

STEP = """
import hashlib, json, logging, sys
from pathlib import Path
logging.basicConfig(stream=sys.stderr, format="%(message)s")
from runtime.worlds.libero.simulator.assets import find_task
from runtime.worlds.libero.simulator.compiled import compile_scene
from runtime.worlds.libero.simulator.scene_cache import SceneCache
from runtime.worlds.libero.simulator.simulation import Simulation
sys.stdout.write("ready\\n"); sys.stdout.flush(); sys.stdin.readline()
for task in (5, 6):
    scene = compile_scene(find_task("libero_object", task).bddl, cache=SceneCache(Path(sys.argv[1])))
    made = Simulation(scene)
    made.settle(2)
    print(json.dumps([scene.home.scene, hashlib.sha256(made.flat_state.tobytes()).hexdigest()]))
"""


WEIGH = """
import sys
from pathlib import Path
from runtime.worlds.libero.simulator.assets import find_task
from runtime.worlds.libero.simulator.compiled import compile_scene
from runtime.worlds.libero.simulator.scene_cache import SceneCache
scene = compile_scene(find_task("libero_goal", 8).bddl, cache=SceneCache(Path(sys.argv[1])))
print(scene.model.body_mass[scene.index.root_body("plate_1")])
"""


def started(folder, **environment):
    return subprocess.Popen(
        [sys.executable, "-c", STEP, str(folder)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, **environment},
    )


def finished(process):
    out, err = process.communicate("go\n")
    assert process.returncode == 0, err
    return [json.loads(line) for line in out.splitlines() if line != "ready"], err


@pytest.fixture(scope="module")
def ref():
    from runtime.worlds.libero.simulator.assets import find_task

    return find_task("libero_object", 5)


@pytest.fixture(scope="module")
def filled(tmp_path_factory):
    """A cache that three processes filled at the same time, and what each of them found."""
    folder = tmp_path_factory.mktemp("cache")
    processes = [started(folder) for _ in range(3)]
    for process in processes:
        assert process.stdout.readline() == "ready\n"
    return folder, [finished(process) for process in processes]


def test_processes_that_fill_the_cache_at_once_all_get_the_right_scene(filled):
    folder, found = filled
    assert all(errors == "" for _, errors in found)
    assert len(found[0][0]) == 2
    assert found[0][0] == found[1][0] == found[2][0] == finished(started(folder))[0]


def test_processes_that_fill_the_cache_at_once_leave_nothing_else_in_it(filled):
    folder, _ = filled
    assert sorted(path.name for path in folder.iterdir()) == ["models", "scenes"]
    assert len(list((folder / "scenes").iterdir())) == 2


def test_compiled_code_that_cannot_be_kept_is_compiled_again(filled, tmp_path):
    folder, found = filled
    blocked = tmp_path / "file"
    blocked.write_text("")
    nowhere = {"NUMBA_CACHE_DIR": str(blocked / "numba"), "NUMBA_CACHE_LOCATOR_CLASSES": "UserProvidedCacheLocator"}
    lines, errors = finished(started(folder, **nowhere))
    assert lines == found[0][0]
    assert "compiled code cannot be kept" in errors


def damaged_model(cache, content):
    """Put `content` in the place of every model, its digest in the records."""
    for path in (cache.folder / "models").iterdir():
        path.unlink()
    for path in (cache.folder / "scenes").iterdir():
        with np.load(path) as file:
            arrays = dict(file)
        values = json.loads(str(arrays.pop("record")))
        from hashlib import sha256

        values["model"] = sha256(content).hexdigest()
        (cache.folder / "models" / f"{values['model']}.mjb").write_bytes(content)
        np.savez_compressed(path, record=np.array(json.dumps(values)), **arrays)


def test_a_model_that_mujoco_cannot_read_is_built_again(ref, tmp_path, caplog):
    from runtime.worlds.libero.simulator.compiled import compile_scene

    cache = SceneCache(tmp_path)
    first = compile_scene(ref.bddl, cache=cache)
    for content in (b"", b"no model at all", bytes(100_000)):  # what one round built again, the next one damages
        damaged_model(cache, content)
        assert compile_scene(ref.bddl, cache=cache).home.scene == first.home.scene
        assert "built again" in caplog.text
        caplog.clear()
        assert compile_scene(ref.bddl, cache=cache).home.scene == first.home.scene
        assert caplog.text == ""


def test_a_disk_that_is_full_keeps_no_part_of_a_scene(ref, tmp_path, caplog, monkeypatch):
    import mujoco

    from runtime.worlds.libero.simulator.compiled import compile_scene

    whole = mujoco.mj_saveModel

    def half(model, path):
        whole(model, path)
        os.truncate(path, Path(path).stat().st_size // 2)

    monkeypatch.setattr(mujoco, "mj_saveModel", half)
    cache = SceneCache(tmp_path)
    assert compile_scene(ref.bddl, cache=cache).model.nq > 0
    assert "cannot be kept" in caplog.text
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


def test_a_scene_of_assets_that_the_user_configured_is_another_scene(own_assets, tmp_path):
    assets, configuration = own_assets
    plate = assets / "stable_scanned_objects" / "plate" / "plate.xml"
    text = plate.read_text()
    plate.unlink()
    plate.write_text(text.replace('density="100"', 'density="200"'))

    def weighed(**environment):
        command = [sys.executable, "-c", WEIGH, str(tmp_path / "cache")]
        done = subprocess.run(command, capture_output=True, text=True, check=True, env={**os.environ, **environment})
        return float(done.stdout)

    packaged = weighed()
    assert weighed(LIBERO_CONFIG_PATH=str(configuration)) == pytest.approx(2 * packaged)
    assert weighed() == packaged
    assert len(list((tmp_path / "cache" / "scenes").iterdir())) == 2
