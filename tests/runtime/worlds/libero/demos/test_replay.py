from __future__ import annotations

import shutil

import pytest

from onto_compiler.problems import OntoError

h5py = pytest.importorskip("h5py")
pytestmark = pytest.mark.sim


ELSEWHERE = 1e-4
"""What the last digits of another processor's sums may grow to; the sample was recorded on one."""


def test_every_demonstration_succeeds_natively_at_its_own_step(sample):
    from runtime.worlds.libero.demos.replay import replay

    found = list(replay(sample))
    assert [one.recorded for one in found] == [237, 78]
    for one in found:
        assert one.reached == one.recorded > 0
        assert (one.same, one.holds, one.whole) == (True, True, True)
        assert one.drift < ELSEWHERE


def test_a_replay_tells_when_an_action_is_missing_or_the_record_is_wrong(sample, tmp_path):
    from runtime.worlds.libero.demos.replay import replay

    path = tmp_path / "put_the_bowl_on_the_plate_demo.hdf5"
    shutil.copy(sample, path)
    with h5py.File(path, "r+") as file:
        del file["data/demo_0"]
        file.copy("data/demo_1", "data/demo_0")  # the shorter one, twice
        file["data/demo_0/actions"][:] = 0.0  # nothing is done
        file["data/demo_1"].attrs["success_step"] += 1
    first, second = replay(path)
    assert (first.reached, first.same) == (0, False)
    assert first.drift > 0.01
    assert (second.reached, second.same) == (second.recorded - 1, False)


def test_without_a_window_record_a_replay_starts_from_the_flat_state_and_says_so(sample, tmp_path):
    from runtime.worlds.libero.demos.replay import replay

    path = tmp_path / "put_the_bowl_on_the_plate_demo.hdf5"
    shutil.copy(sample, path)
    with h5py.File(path, "r+") as file:
        del file["data/demo_1"]
        del file["data/demo_0/start"], file["data/demo_0/hidden"]
    (found,) = replay(path)
    assert not found.whole
    assert found.recorded == 0
    assert found.drift > 0.0


def test_a_file_of_another_task_is_refused(sample, tmp_path):
    from runtime.worlds.libero.demos.replay import replay

    path = tmp_path / "demo.hdf5"
    shutil.copy(sample, path)
    with h5py.File(path, "r+") as file:
        file["data"].attrs["bddl_file_content"] += " "
    assert code(lambda: list(replay(path))) == "DEM005"
    with h5py.File(path, "r+") as file:
        file["data"].attrs["bddl_file_name"] = "a/nowhere/b.bddl"
    assert code(lambda: list(replay(path))) == "DEM005"


def code(call):
    with pytest.raises(OntoError) as caught:
        call()
    return caught.value.problems[0].code
