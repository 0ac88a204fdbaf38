from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("h5py")
pytestmark = pytest.mark.sim


def test_pictures_stand_under_liberos_keys_one_for_each_action(ref, monkeypatch, tmp_path):
    """Drawing itself is tested with the environment; here the pictures count how often they were asked for."""
    from onto_compiler.knowledge import load_knowledge
    from runtime.worlds.libero.demos import load, trial
    from runtime.worlds.libero.demos.write import write

    class Drawn:
        def __init__(self, model, cameras, size, convention, *, fast):
            assert (size, convention, fast) == ((128, 128), "opengl", False)
            self.cameras, self.asked = cameras, 0

        def look(self, data):
            self.asked += 1
            return {
                f"{name}_image": np.full((128, 128, 3), (self.asked + place) % 256, dtype=np.uint8)
                for place, name in enumerate(self.cameras)
            }

        def close(self):
            pass

    compile_scene = trial.compile_scene
    monkeypatch.setattr(trial, "Views", Drawn)
    monkeypatch.setattr(trial, "compile_scene", lambda bddl, pictures: compile_scene(bddl))
    collector = trial.TaskCollector(ref, load_knowledge(), 0, "<mujoco/>", images=True)
    demo = collector.collect(0)
    collector.close()
    expected = (1 + np.arange(len(demo))) % 256  # the first belongs to the last settling step
    for place, key in enumerate(("agentview_rgb", "eye_in_hand_rgb")):
        assert demo.obs[key].shape == (len(demo), 128, 128, 3)
        np.testing.assert_array_equal(demo.obs[key][:, 0, 0, 0], (expected + place) % 256)
    write(tmp_path / "demo.hdf5", {}, {}, [demo])
    (again,) = load(tmp_path / "demo.hdf5", images=True).demos
    np.testing.assert_array_equal(again.obs["agentview_rgb"], demo.obs["agentview_rgb"])
    (without,) = load(tmp_path / "demo.hdf5").demos
    assert without.pictures == ("agentview_rgb", "eye_in_hand_rgb")
    assert "agentview_rgb" not in without.obs
