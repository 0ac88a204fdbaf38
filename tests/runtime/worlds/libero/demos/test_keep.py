"""Interrupted, damaged, shared and short collections; the trials themselves are taken from a collection made before."""

from __future__ import annotations

import dataclasses
import json
import threading
from pathlib import Path

import pytest

from onto_compiler.problems import OntoError

h5py = pytest.importorskip("h5py")
pytestmark = pytest.mark.sim


@pytest.fixture
def trials(sample, monkeypatch):
    """Let a trial give one of the two demonstrations, but 1 and 4 none; the list of those that were run."""
    from runtime.worlds.libero.demos import collect, load

    file = load(sample)
    demos, attributes = file.demos, file.attributes
    run = []

    class Collector:
        def __init__(self, *arguments, **options):
            pass

        def collect(self, trial):
            run.append(trial)
            if trial in {1, 4}:
                return "not done in 300 steps: lost"
            demo = demos[trial % 2]
            return dataclasses.replace(demo, origin=dataclasses.replace(demo.origin, trial=trial))

        def close(self):
            pass

    shown = {key: value for key, value in attributes.items() if key not in {"num_demos", "total"}}
    monkeypatch.setattr(collect, "TaskCollector", Collector)
    monkeypatch.setattr(collect, "describe", lambda ref, images: (shown, "<mujoco/>"))
    return run


@pytest.fixture
def wanted(order, tmp_path):
    return dataclasses.replace(order, folder=tmp_path, count=4)


def go(order):
    from runtime.worlds.libero.demos.collect import collect_task

    return collect_task(order, wait=False)


def test_trials_that_fail_are_counted_and_replaced(trials, wanted):
    from runtime.worlds.libero.demos import load

    done = go(wanted)
    assert (done.demos, done.trials, done.rejected, done.short) == (4, 6, {"lost": 2}, False)
    file = load(done.path)
    assert [demo.origin.trial for demo in file.demos] == [0, 2, 3, 5]
    assert [demo.name for demo in file.demos] == ["demo_0", "demo_1", "demo_2", "demo_3"]
    assert sorted(file.about["rejected"]) == ["1", "4"]
    assert not list(Path(done.path).parent.glob("*.parts"))


def test_an_interrupted_collection_goes_on_where_it_stopped_and_ends_in_the_same_file(trials, wanted, tmp_path):
    whole = Path(go(dataclasses.replace(wanted, folder=tmp_path / "whole")).path).read_bytes()
    trials.clear()
    from runtime.worlds.libero.demos import collect

    collector = collect.TaskCollector.collect

    def interrupted(self, trial):
        if trial == 3:
            raise KeyboardInterrupt
        return collector(self, trial)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(collect.TaskCollector, "collect", interrupted)
        with pytest.raises(KeyboardInterrupt):
            go(wanted)
    assert trials == [0, 1, 2]
    assert Path(go(wanted).path).read_bytes() == whole
    assert trials == [0, 1, 2, 3, 4, 5]


def test_a_part_that_was_cut_off_is_run_again_and_nothing_else(trials, wanted, monkeypatch):
    from runtime.worlds.libero.demos import collect

    with monkeypatch.context() as patch:
        patch.setattr(collect.TaskStore, "finish", lambda *_: None)
        go(wanted)
    parts = sorted((wanted.folder / "libero_goal" / "put_the_bowl_on_the_plate_demo.parts").iterdir())
    assert [part.suffix for part in parts] == [".hdf5", ".json", ".hdf5", ".hdf5", ".json", ".hdf5"]
    for part in (parts[2], parts[4]):
        part.write_bytes(part.read_bytes()[:-20])
    trials.clear()
    assert go(wanted).demos == 4
    assert trials == [2, 4]


@pytest.mark.parametrize("share", [0.0, 0.5, 0.99])
def test_a_file_that_was_cut_off_is_made_again(trials, wanted, share):
    path = Path(go(wanted).path)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    trials.clear()
    assert go(wanted).demos == 4
    assert path.read_bytes() == whole
    assert trials == list(range(6))


def test_a_byte_that_changed_is_noticed(trials, wanted):
    path = Path(go(wanted).path)
    whole = bytearray(path.read_bytes())
    with h5py.File(path) as file:
        offset = file["data/demo_2/states"].id.get_chunk_info(0).byte_offset
    whole[offset + 100] ^= 0xFF
    path.write_bytes(whole)
    assert go(wanted).demos == 4
    assert path.read_bytes() != whole


def test_more_are_added_to_what_is_there(trials, wanted):
    from runtime.worlds.libero.demos import load

    go(wanted)
    trials.clear()
    done = go(dataclasses.replace(wanted, count=6))
    assert trials == [6, 7]
    assert [demo.origin.trial for demo in load(done.path).demos] == [0, 2, 3, 5, 6, 7]


def test_a_task_that_cannot_be_collected_ends_short_and_is_not_tried_for_ever(trials, wanted, monkeypatch):
    from runtime.worlds.libero.demos import collect

    monkeypatch.setattr(collect.TaskCollector, "collect", lambda _, trial: trials.append(trial) or "undone: dropped")
    done = go(wanted)
    assert (done.demos, done.trials, done.short, done.rejected) == (0, 22, True, {"dropped": 22})
    trials.clear()
    assert go(wanted).short
    assert trials == []


def test_one_process_at_a_time_collects_a_task_and_another_waits(trials, wanted):
    from runtime.worlds.libero.demos.collect import collect, collect_task
    from runtime.worlds.libero.demos.keep import TaskStore

    ours = TaskStore(wanted.folder, wanted.ref.suite, wanted.ref.name, {})
    told = []
    with ours.locked(wait=False) as mine:
        assert mine
        assert collect_task(wanted, wait=False).busy
        other = threading.Thread(target=lambda: collect([wanted], 1, told.append))
        other.start()
        other.join(0.2)
        assert told == []
        assert other.is_alive()
    other.join(20)
    assert [one.demos for one in told] == [4]


def test_a_folder_that_cannot_be_written_is_a_problem(trials, wanted, tmp_path):
    from runtime.worlds.libero.demos.collect import collect

    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    with pytest.raises(OntoError) as caught:
        collect([dataclasses.replace(wanted, folder=blocked)], 1, lambda _: None)
    assert [problem.code for problem in caught.value.problems] == ["DEM006"]


def test_the_other_tasks_are_collected_before_a_problem_is_raised(trials, wanted, order):
    from runtime.worlds.libero.demos.collect import collect

    path = wanted.folder / "libero_goal" / "put_the_bowl_on_the_plate_demo.hdf5"
    go(dataclasses.replace(wanted, seed=7))
    told = []
    from runtime.worlds.libero.simulator.assets import find_task

    other = dataclasses.replace(wanted, ref=find_task("libero_goal", 5))
    with pytest.raises(OntoError) as caught:
        collect([wanted, other], 1, told.append)
    (problem,) = caught.value.problems
    assert (problem.code, problem.file) == ("DEM003", str(path))
    assert [one.demos for one in told] == [0, 4]


def test_a_record_of_a_failed_trial_says_with_which_options(trials, wanted, monkeypatch):
    from runtime.worlds.libero.demos import collect

    monkeypatch.setattr(collect.TaskStore, "finish", lambda *_: None)
    go(wanted)
    (record, _) = sorted(wanted.folder.rglob("trial_*.json"))
    assert json.loads(record.read_text())["spec"]["seed"] == 0
    with pytest.raises(OntoError) as caught:
        go(dataclasses.replace(wanted, seed=1))
    assert caught.value.problems[0].code == "DEM003"
