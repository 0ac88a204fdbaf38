"""Pictures are LIBERO's own, pixel for pixel; each case runs in a process of its own, which chooses how to draw."""

from __future__ import annotations

import subprocess
import sys

import pytest

pytestmark = pytest.mark.sim

# LIBERO's environment must find MUJOCO_GL set when it is imported; ours needs nothing.
AS_LIBERO = """
import importlib, os
import numpy as np
from runtime.worlds import pictures, snapshot
os.environ["MUJOCO_GL"] = os.environ["PYOPENGL_PLATFORM"] = pictures.backend()
from runtime.worlds.libero.gym.environment import LiberoEnv
from runtime.worlds.libero.simulator.assets import initial_states, named_task
from runtime.worlds.libero.simulator.native_import import control_env
from runtime.worlds.native_import import quiet

task = "libero_goal/turn_on_the_stove"
ref = named_task(task)
control_env()
with quiet():
    np.random.seed(0)
    native = importlib.import_module("libero.libero.envs.env_wrapper").OffScreenRenderEnv(
        bddl_file_name=str(ref.bddl), camera_heights=64, camera_widths=64)
    native.seed(0)
    native.reset()
fresh = snapshot.take(native.env)
ours = LiberoEnv(task, exact=True, settle=0, images=True, image_size=64)
index, model = ours.simulation.scene.index, ours.simulation.model
knob = model.jnt_qposadr[index.joints("flat_stove_1")[0]]
pairs = 0
for angle in (0.0, 1.0):  # off, and on: the burner glows
    state = initial_states(ref)[2].copy()
    state[1 + knob] = angle
    snapshot.put(native.env, fresh)
    for observable in native.env._observables.values():
        observable._time_since_last_sample = native.env.model_timestep
    theirs, seen = native.set_init_state(state), ours.reset(options={"state": state})[0]
    for action in ([0.3, 0.1, -0.2, 0, 0.1, 0, 1], [0, 0, -0.5, 0, 0, 0.3, 1], None):
        for camera in ("agentview_image", "robot0_eye_in_hand_image"):
            assert seen[camera].dtype == theirs[camera].dtype
            assert np.array_equal(seen[camera], theirs[camera]), (angle, camera)
            assert seen[camera].std() > 10
            pairs += 1
        if action is not None:
            theirs, seen = native.step(action)[0], ours.step(np.array(action))[0]
    if angle:
        assert not np.array_equal(seen["agentview_image"], off)
    off = seen["agentview_image"]
print(pairs)
"""

# Whoever imported MuJoCo first may have chosen that nothing is drawn.
UPRIGHT = """
import os
os.environ["MUJOCO_GL"] = "disabled"
import mujoco
import numpy as np
import gymnasium
from gymnasium.utils.env_checker import check_env
shared = {"task": "libero_goal/8", "settle": 2, "render_mode": "rgb_array", "image_size": (48, 64)}
make = lambda **options: gymnasium.make("runtime.worlds.libero.gym:onto/Libero-v0", **shared, **options)
plain, upright, fast = make(images=True), make(images=True, image_convention="opencv"), make(fast_render=True)
a, b, c = (env.reset(options={"state_index": 1})[0] for env in (plain, upright, fast))
for name in ("agentview_image", "robot0_eye_in_hand_image"):
    assert a[name].shape == (48, 64, 3)
    assert plain.observation_space[name].contains(a[name])
    assert np.array_equal(a[name][::-1], b[name])
assert "agentview_image" not in c
assert np.array_equal(plain.render(), upright.render())
frames = [env.render().astype(int) for env in (plain, fast)]
gap = np.abs(frames[0] - frames[1]).mean()
assert 0 < gap < 12, gap  # shadows are gone, and little else
assert np.abs(frames[0] - frames[0][::-1]).mean() > 2 * gap
check_env(fast.unwrapped)
print("drawn")
"""

# Named and nested as in lerobot's src/lerobot/envs/libero.py.
LEROBOT = """
import gymnasium
import numpy as np
from runtime.worlds.libero.gym.lerobot import LeRobotView
from runtime.worlds.libero.simulator.assets import named_task
from runtime.worlds.libero.simulator.native import NativeTask

task = "libero_goal/8"
vector = gymnasium.make_vec("runtime.worlds.libero.gym:onto/Libero-v0", num_envs=1,
    vectorization_mode="sync", task=task, settle=0,
    images=True, image_size=24, fast_render=True, exact=True, wrappers=[LeRobotView])
observed, _ = vector.reset(seed=3)
assert {k: sorted(v) for k, v in observed.items()} == {
    "pixels": ["image", "image2"], "robot_state": ["eef", "gripper", "joints"]}
assert sorted(observed["robot_state"]["eef"]) == ["mat", "pos", "quat"]
assert observed["pixels"]["image"].shape == (1, 24, 24, 3)
assert vector.call("task_description") == ("Put the bowl on the plate",)
assert vector.call("_max_episode_steps") == (300,)
env = vector.envs[0].unwrapped
with NativeTask.open(named_task(task)) as native:
    native.reset_to(env._start.state)
    for action in np.random.default_rng(0).uniform(-1, 1, (5, 7)).astype(np.float32):
        native.step(action)
        observed = vector.step(action[None])[0]
        state = observed["robot_state"]
        theirs = native.env._get_observations()
        for part, keys in (("eef", ("pos", "quat")), ("gripper", ("qpos", "qvel"))):
            for key in keys:
                assert np.array_equal(state[part][key][0], theirs[f"robot0_{part}_{key}"])
        for key in ("pos", "vel"):
            assert np.array_equal(state["joints"][key][0], theirs[f"robot0_joint_{key}"])
        assert np.array_equal(state["eef"]["mat"][0], native.env.robots[0].controller.ee_ori_mat)
assert vector.single_observation_space.contains(vector.envs[0].observation(env._seen))
print("nested")
"""

FLAT = """
import gymnasium, os
env = gymnasium.make("runtime.worlds.libero.gym:onto/Libero-v0", task="libero_goal/8", images=True,
    image_size=24, fast_render=True, cameras=("agentview",), settle=1, render_mode="rgb_array")
page = os.sysconf("SC_PAGE_SIZE")
resident = lambda: int(open("/proc/self/statm").read().split()[1]) * page / 2**20
sizes = []
for trial in range(120):
    env.reset(seed=trial)
    env.render()
    if trial in (40, 119):
        sizes.append(resident())
assert sizes[1] - sizes[0] < 4, sizes  # MiB, of 79 resets
print("flat")
"""


def lines(program):
    from runtime.worlds.pictures import backend

    if backend() is None:
        pytest.skip("this machine cannot draw")
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout.split(), done.stderr


def test_pictures_equal_libero_s_pixel_for_pixel():
    assert lines(AS_LIBERO)[0] == ["12"]


def test_rows_come_as_asked_and_a_fast_picture_shows_the_same_scene():
    printed, said = lines(UPRIGHT)
    assert printed == ["drawn"]
    assert "Exception" not in said  # nobody closed anything, and EGL ends at exit


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_resets_with_pictures_need_no_more_memory():
    assert lines(FLAT)[0] == ["flat"]


def test_lerobot_finds_its_own_names_and_values():
    assert lines(LEROBOT)[0] == ["nested"]


def test_lerobot_s_view_wants_pictures_and_a_libero_environment():
    import gymnasium

    from onto_compiler.problems import OntoError
    from runtime.worlds.libero.gym.lerobot import LeRobotView

    blind = gymnasium.make("runtime.worlds.libero.gym:onto/Libero-v0", task="libero_goal/8")
    for env, said in ((blind, "agentview_image"), (gymnasium.make("CartPole-v1"), "not a LIBERO environment")):
        with pytest.raises(OntoError, match=said):
            LeRobotView(env)


def test_a_machine_that_cannot_draw_says_what_to_install(monkeypatch):
    from onto_compiler.problems import OntoError
    from runtime.worlds.libero.gym.environment import LiberoEnv
    from runtime.worlds.libero.simulator import offscreen

    monkeypatch.setattr(offscreen, "backend", lambda: None)
    made = LiberoEnv("libero_goal/8", images=True)
    with pytest.raises(OntoError) as caught:
        made.reset()
    assert caught.value.problems[0].code == "SIM031"
    assert "apt-get" in caught.value.problems[0].hint


def test_an_unknown_camera_is_refused():
    from onto_compiler.problems import OntoError
    from runtime.worlds.libero.gym.environment import LiberoEnv
    from runtime.worlds.pictures import backend

    if backend() is None:
        pytest.skip("this machine cannot draw")
    made = LiberoEnv("libero_goal/8", images=True, cameras=("agentvue",))
    with pytest.raises(OntoError, match="SIM030") as caught:
        made.reset()
    assert "agentview" in caught.value.problems[0].hint
    made.close()
