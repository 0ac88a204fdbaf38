"""A flat state does not say where fixtures stand: another seed's success is one only with that seed's fixtures."""

import json
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from onto_compiler.command import CLEAN, FINDINGS, MISUSE
from runtime.cli import main
from runtime.worlds.libero.simulator.assets import find_task

pytestmark = pytest.mark.sim
STOVE = "libero_goal/put_the_bowl_on_the_stove"
OTHER = 23
STEPS = 30


def run(capsys, *arguments):
    code = main(list(arguments))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def placed(mjcf, model):
    """``mjcf`` with the bodies where they stand in ``model``, to six digits, as MuJoCo saves them."""
    root = ET.fromstring(mjcf)  # noqa: S314  of LIBERO
    for body in root.find("worldbody").findall("body"):
        for name, value in (("pos", model.body(body.get("name")).pos), ("quat", model.body(body.get("name")).quat)):
            body.set(name, " ".join(f"{number:.6g}" for number in value))
    return ET.tostring(root, encoding="unicode")


@pytest.fixture(scope="module")
def elsewhere(tmp_path_factory):
    """A native success whose fixtures seed 23 placed: its flat state, its MJCF, and a demonstration that ends there."""
    h5py = pytest.importorskip("h5py")
    from runtime.worlds.libero.simulator.native_import import control_env, quiet

    folder = tmp_path_factory.mktemp("elsewhere") / "libero_goal"
    folder.mkdir()
    ref = find_task(*STOVE.split("/"))
    with quiet():
        environment = control_env()(
            bddl_file_name=str(ref.bddl), use_camera_obs=False, has_offscreen_renderer=False, ignore_done=True
        )
        environment.seed(OTHER)
        environment.reset()
        sim = environment.env.sim
        (folder / "scene.xml").write_text(placed(environment.env.model.get_xml(), sim.model._model))
        region = sim.data.site_xpos[sim.model.site_name2id("flat_stove_1_cook_region")].copy()
        start, _ = sim.model.get_joint_qpos_addr("akita_black_bowl_1_joint0")
        # At the edge of the region that lies away from seed 0's stove.
        sim.data.qpos[start : start + 3] = np.add(region, [-0.07, 0.07, 0.02])
        sim.forward()
        rest = np.array([0, 0, 0, 0, 0, 0, -1.0])
        states = []
        for _ in range(STEPS):
            states.append(sim.get_state().flatten())
            environment.step(rest)
        assert environment.check_success()
        np.save(folder / "state.npy", sim.get_state().flatten())
        with h5py.File(folder / f"{ref.name}_demo.hdf5", "w") as file:
            data = file.create_group("data")
            data.attrs["bddl_file_name"] = f"libero/libero/bddl_files/{ref.suite}/{ref.bddl.name}"
            demo = data.create_group("demo_0")
            demo["states"], demo["actions"] = np.array(states), np.tile(rest, (STEPS, 1))
            demo["rewards"] = demo["dones"] = np.eye(STEPS)[-1]
            demo.create_group("obs")
            demo.attrs["num_samples"], demo.attrs["model_file"] = STEPS, (folder / "scene.xml").read_text()
        environment.close()
    return folder


def test_a_verdict_that_hangs_on_where_fixtures_stand_says_so(capsys, elsewhere):
    state = str(elsewhere / "state.npy")
    code, out, _ = run(capsys, "diagnose", STOVE, "--state-file", state, "--json")
    record = json.loads(out)
    (row,), (unmet,) = record["uncertain"], record["diagnoses"]
    assert (code, record["fixtures"]) == (FINDINGS, None)
    assert row["fixtures"] == ["flat_stove_1"]
    assert row["margin"] == unmet["margin"]
    assert 0 < -row["margin"] <= row["reach"] < 0.03
    _, out, _ = run(capsys, "diagnose", STOVE, "--state-file", state)
    assert "uncertain: on(akita_black_bowl_1, flat_stove_1_cook_region) hangs on where flat_stove_1 stood" in out
    assert "--model FILE or --seed N says where fixtures stand" in out


@pytest.mark.parametrize("source", ["seed", "mjcf", "demonstration"])
def test_the_fixtures_of_a_seed_a_saved_model_or_a_demonstration_make_it_a_success(capsys, elsewhere, source):
    option = {
        "seed": ["--seed", str(OTHER)],
        "mjcf": ["--model", str(elsewhere / "scene.xml")],
        "demonstration": ["--model", str(elsewhere / "put_the_bowl_on_the_stove_demo.hdf5")],
    }[source]
    code, out, _ = run(capsys, "ground", STOVE, "--state-file", str(elsewhere / "state.npy"), "--json", *option)
    record = json.loads(out)
    assert (code, record["native_success"], record["facts"][0]["truth"]) == (CLEAN, True, True)
    assert record["uncertain"] == []
    assert record["fixtures"] == ("seed 23" if source == "seed" else option[1])


def test_a_far_failure_and_what_is_said_of_a_fixture_alone_are_certain(capsys, tmp_path):
    from runtime.worlds.libero.simulator.assets import initial_states

    path = str(tmp_path / "state.npy")
    np.save(path, initial_states(find_task(*STOVE.split("/")))[0])
    _, out, _ = run(capsys, "diagnose", STOVE, "--state-file", path, "--json")
    assert len(json.loads(out)["diagnoses"]) == 1
    assert json.loads(out)["uncertain"] == []
    np.save(path, initial_states(find_task("libero_goal", 7))[0])
    _, out, _ = run(capsys, "diagnose", "libero_goal/7", "--state-file", path, "--json")
    assert json.loads(out)["diagnoses"][0]["predicate"] == "joint_state"
    assert json.loads(out)["uncertain"] == []


def test_a_record_says_what_was_assumed(capsys, elsewhere):
    _, out, _ = run(capsys, "repair", STOVE, "--state-file", str(elsewhere / "state.npy"), "--budget", "0", "--json")
    record = json.loads(out)
    assert record["provenance"]["fixtures"] == "seed 0, assumed"
    assert json.loads(record["provenance"]["uncertain"]) == record["uncertain"]
    assert len(record["uncertain"]) == 1
    file = str(elsewhere / "scene.xml")
    _, out, _ = run(capsys, "repair", STOVE, "--state-file", str(elsewhere / "state.npy"), "--model", file, "--json")
    record = json.loads(out)
    assert (record["outcome"], record["provenance"]["fixtures"], record["uncertain"]) == ("verified", file, [])


def test_a_demonstration_is_replayed_with_the_fixtures_of_its_model_file(elsewhere, tmp_path, capsys):
    import shutil

    import h5py

    folder = tmp_path / "libero_goal"
    shutil.copytree(elsewhere, folder)
    code, out, _ = run(capsys, "demos", "replay", str(folder), "--json", "--jobs", "1")
    (one,) = json.loads(out)["demos"]
    assert (code, one["placed"], one["whole"]) == (CLEAN, True, False)
    assert one["reached"] > 0
    assert one["drift"] < 0.01
    with h5py.File(folder / "put_the_bowl_on_the_stove_demo.hdf5", "r+") as file:
        del file["data/demo_0"].attrs["model_file"]
    code, out, _ = run(capsys, "demos", "replay", str(folder), "--jobs", "1")
    assert code == FINDINGS
    assert "of 1 nothing says where fixtures stood, and seed 0 is assumed" in out


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (None, "cannot be read"),
        ("<mujoco>", "not XML"),
        ("<mujoco/>", "not MJCF"),
        ("<mujoco><worldbody/></mujoco>", "it has no body"),
        ("<mujoco><worldbody><body name='a' pos='x'/></worldbody></mujoco>", "MuJoCo cannot read"),
    ],
)
def test_a_model_file_that_does_not_say_it_is_refused(capsys, elsewhere, tmp_path, content, says):
    path = tmp_path / "scene.xml"
    if content is not None:
        path.write_text(content)
    state = str(elsewhere / "state.npy")
    status, _, err = run(capsys, "ground", STOVE, "--state-file", state, "--model", str(path))
    assert (status, "error[SIM023]" in err) == (MISUSE, True)
    assert says in err
    assert "scene.xml" in err


def test_the_gymnasium_environment_takes_and_misses_the_fixtures_too(elsewhere):
    from runtime.worlds.libero.gym.environment import LiberoEnv

    state = np.load(elsewhere / "state.npy")
    made = LiberoEnv(STOVE)
    _, info = made.reset(options={"state": state})
    (row,) = info["uncertain"]
    assert (info["success"], row["fixtures"]) == (False, ["flat_stove_1"])
    _, info = made.reset(options={"state": state, "model": elsewhere / "scene.xml"})
    assert (info["success"], info["uncertain"]) == (True, ())
    _, info = made.reset(options={"state_index": 0})
    assert (info["success"], info["uncertain"]) == (False, ())
    made = LiberoEnv(STOVE, scene_seed=OTHER)
    _, info = made.reset(options={"state": state})
    assert (info["success"], info["uncertain"]) == (True, ())
