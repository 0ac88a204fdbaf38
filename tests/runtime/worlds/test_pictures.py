"""Pictures are drawn where the machine can, and nothing breaks where it cannot."""

import subprocess
import sys

import pytest

pytestmark = pytest.mark.sim
DRAW = """
from runtime.worlds import pictures
drawing = pictures.enable()
print(drawing)
if drawing:
    import mujoco
    model = mujoco.MjModel.from_xml_string('''
<mujoco><worldbody><light pos="0 0 2"/><camera name="agentview" pos="0 -1 .2" xyaxes="1 0 0 0 0 1"/>
<geom type="box" size=".2 .2 .2" rgba="1 0 0 1" group="1"/></worldbody></mujoco>''')
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with pictures.Camera(model) as camera:
        print(camera.shoot(data)[:3] == bytes([0xFF, 0xD8, 0xFF]))
"""


def lines(environment=None, prelude=""):
    done = subprocess.run(
        [sys.executable, "-c", prelude + DRAW], capture_output=True, text=True, check=False, env=environment
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_a_picture_is_a_jpeg_where_one_can_be_drawn():
    assert lines() in (["True", "True"], ["False"])


def test_a_machine_that_cannot_draw_says_so():
    broken = "import subprocess\ndef run(*a, **k): raise OSError('no such driver')\nsubprocess.run = run\n"
    assert lines(prelude=f"import os; os.environ.pop('MUJOCO_GL', None)\n{broken}") == ["False"]


def test_a_choice_of_ones_own_is_kept(monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "disabled")
    assert lines() == ["False"]


CHANGE = """
from runtime.worlds import pictures
drawing = pictures.enable()
print(drawing)
if drawing:
    import mujoco
    XML = '''<mujoco><worldbody><light pos="0 0 2"/><camera name="agentview" pos="0 -1 .2" xyaxes="1 0 0 0 0 1"/>
<body><geom type="box" size=".2 .2 .2" rgba="1 {green} 0 1" group="1"/></body></worldbody></mujoco>'''
    def scene(x, green):
        model = mujoco.MjModel.from_xml_string(XML.format(green=green))
        model.body_pos[1] = x, 0, 0  # as LIBERO places fixtures
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        return model, data
    def alone(model, data):
        with pictures.Camera(model) as camera:
            return camera.shoot(data)
    scenes = [scene(0, 0), scene(0.3, 0), scene(0.3, 0.5)]
    with pictures.Cameras() as cameras:
        used = [cameras.of(model) for model, _ in scenes]
        print(used[0] is used[1], used[1] is used[2])
    with pictures.Cameras() as cameras:
        shots = [cameras.of(model).shoot(data) for model, data in scenes]
    print(shots == [alone(*one) for one in scenes], len(set(shots)))
"""


def test_one_camera_draws_scenes_that_differ_in_where_things_stand_and_no_others():
    done = subprocess.run([sys.executable, "-c", CHANGE], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() in (["True", "True", "False", "True", "3"], ["False"])
