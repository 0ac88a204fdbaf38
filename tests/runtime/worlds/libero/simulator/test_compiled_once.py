"""What robosuite asks for again is a copy of what was compiled, and nobody sees the difference."""

import os

import mujoco
import numpy as np
import pytest

from runtime.worlds.libero.simulator.compiled_once import SceneCompiler, install

pytestmark = pytest.mark.sim
CUBE = "v -1 -1 -1\nv 1 -1 -1\nv 0 1 -1\nv 0 0 {top}\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


@pytest.fixture
def xml(tmp_path):
    (tmp_path / "thing.obj").write_text(CUBE.format(top=1))
    return f"""<mujoco><asset><mesh name="thing" file="{tmp_path / "thing.obj"}"/></asset>
<worldbody><body name="b" pos="0 0 1"><freejoint/><geom type="mesh" mesh="thing"/></body></worldbody></mujoco>"""


def bytes_of(model, tmp_path):
    mujoco.mj_saveModel(model, str(tmp_path / "m.mjb"))
    return (tmp_path / "m.mjb").read_bytes()


def test_a_second_model_equals_the_first_and_is_not_it(xml, tmp_path):
    compiler = SceneCompiler()
    first = compiler(xml)
    first.body_pos[:] = 7.0  # as LIBERO places fixtures
    second = compiler(xml)
    assert bytes_of(second, tmp_path) == bytes_of(mujoco.MjModel.from_xml_string(xml), tmp_path)
    assert not np.array_equal(first.body_pos, second.body_pos)


def test_a_changed_file_is_compiled_again(xml, tmp_path):
    compiler = SceneCompiler()
    low = compiler(xml)
    (tmp_path / "thing.obj").write_text(CUBE.format(top=10))
    os.utime(tmp_path / "thing.obj", (0, 0))  # MuJoCo keeps meshes itself, by the second in which they were written
    high = compiler(xml)
    assert high.body_mass[1] > low.body_mass[1]


def test_a_file_that_is_gone_is_missed_as_mujoco_misses_it(xml, tmp_path):
    compiler = SceneCompiler()
    compiler(xml)
    (tmp_path / "thing.obj").unlink()
    with pytest.raises(ValueError, match=r"thing\.obj"):
        compiler(xml)


def test_another_scene_is_another_model(xml):
    compiler = SceneCompiler()
    assert compiler(xml).nbody == compiler(xml.replace('name="b"', 'name="c"')).nbody
    assert compiler(xml).body("b").id == 1


def test_a_simulation_saves_its_own_model_whatever_was_loaded_since(xml):
    robosuite = pytest.importorskip("robosuite.utils.binding_utils")
    kept = robosuite.MjSim.__dict__["from_xml_string"]
    try:
        install()
        first = robosuite.MjSim.from_xml_string(xml)
        first.model._model.body_pos[1] = (0.5, 0.25, 1.0)
        before = first.model.get_xml()
        robosuite.MjSim.from_xml_string('<mujoco><worldbody><body name="other"/></worldbody></mujoco>')
        assert first.model.get_xml() == before
        assert 'name="b" pos="0.5 0.25 1"' in before
    finally:
        robosuite.MjSim.from_xml_string = kept
