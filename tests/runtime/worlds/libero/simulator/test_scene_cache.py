from __future__ import annotations

import numpy as np
import pytest

from onto_compiler.problems import OntoError
from runtime.worlds.libero.simulator.scene_cache import SceneCache, SceneRecord, key_of, stamp


@pytest.fixture
def asset(tmp_path):
    path = tmp_path / "mug.obj"
    path.write_text("v 0 0 0")
    return path


@pytest.fixture
def kept(tmp_path, asset):
    """A cache that holds one scene under `key`, whose model file says `model`."""
    cache = SceneCache(tmp_path / "cache")
    cache.save("key", SceneRecord({"site": 3}, {"home": np.arange(4.0)}, stamp([asset])), write_model)
    return cache


def write_model(path):
    path.write_text("model")


def files(cache, kind):
    return list((cache.folder / kind).iterdir())


def test_what_was_kept_is_found_again(kept):
    record, model = kept.load("key")
    assert record.values["site"] == 3
    assert np.array_equal(record.arrays["home"], np.arange(4.0))
    assert model.read_text() == "model"


def test_another_key_finds_nothing(kept):
    assert kept.load("other") is None
    assert key_of({"a": "1", "b": "2"}) == key_of({"b": "2", "a": "1"}) != key_of({"a": "1", "b": "3"})


def test_scenes_of_one_model_share_its_file(kept, asset):
    kept.save("second", SceneRecord({}, {}, stamp([asset])), write_model)
    assert len(files(kept, "models")) == 1
    assert len(files(kept, "scenes")) == 2


def test_a_changed_asset_makes_the_scene_stale(kept, asset):
    asset.write_text("v 0 0 1")
    assert kept.load("key") is None


def test_a_touched_asset_of_the_same_content_does_not(kept, asset):
    import os

    os.utime(asset, (1, 1))
    assert kept.load("key") is not None


def test_a_missing_asset_makes_the_scene_stale(kept, asset):
    asset.unlink()
    assert kept.load("key") is None


@pytest.mark.parametrize("kind", ["models", "scenes"])
@pytest.mark.parametrize("damage", ["truncate", "empty", "flip", "remove"])
def test_a_damaged_file_counts_as_none_and_is_written_again(kept, asset, kind, damage):
    (path,) = files(kept, kind)
    content = path.read_bytes()
    if damage == "remove":
        path.unlink()
    else:
        middle = len(content) // 2
        flipped = content[:middle] + bytes([content[middle] ^ 255]) + content[middle + 1 :]
        path.write_bytes({"truncate": content[:middle], "empty": b"", "flip": flipped}[damage])
    assert kept.load("key") is None
    kept.save("key", SceneRecord({}, {}, stamp([asset])), write_model)
    assert kept.load("key") is not None


def test_a_folder_that_cannot_be_written_keeps_nothing_and_says_so(tmp_path, asset, caplog):
    blocked = tmp_path / "file"
    blocked.write_text("")
    cache = SceneCache(blocked / "cache")
    cache.save("key", SceneRecord({}, {}, stamp([asset])), write_model)
    assert cache.load("key") is None
    (told,) = caplog.messages
    assert told.startswith(f"the scene cannot be kept in {blocked / 'cache'}: ")


def test_without_a_folder_nothing_is_kept(asset):
    cache = SceneCache(None)
    cache.save("key", SceneRecord({}, {}, stamp([asset])), write_model)
    assert cache.load("key") is None


@pytest.mark.sim
def test_a_scene_from_the_cache_is_the_one_that_was_built(tmp_path):
    import mujoco

    from runtime.worlds.libero.simulator.assets import find_task
    from runtime.worlds.libero.simulator.compiled import compile_scene

    bddl = find_task("libero_spatial", 5).bddl
    cache = SceneCache(tmp_path)
    built, loaded = compile_scene(bddl, cache=cache), compile_scene(bddl, cache=cache)
    assert len(files(cache, "scenes")) == 1
    assert built.home.controller.keys() == loaded.home.controller.keys()
    for name, value in built.home.controller.items():
        assert np.array_equal(value, loaded.home.controller[name])
    for name in dir(built.model):
        value = getattr(built.model, name)
        if isinstance(value, np.ndarray):
            assert np.array_equal(value, getattr(loaded.model, name), equal_nan=value.dtype.kind == "f"), name
    assert built.model.ntex == 0
    assert compile_scene(bddl, pictures=True, cache=cache).model.ntex > 0
    assert isinstance(loaded.model, mujoco.MjModel)


@pytest.mark.sim
def test_a_task_file_that_is_none_is_reported(tmp_path):
    from runtime.worlds.libero.simulator.compiled import compile_scene

    with pytest.raises(OntoError) as caught:
        compile_scene(tmp_path / "none.bddl", cache=SceneCache(tmp_path))
    assert caught.value.problems[0].code == "SIM016"
