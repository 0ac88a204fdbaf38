from __future__ import annotations

import json
import shutil

import pytest

h5py = pytest.importorskip("h5py")
pytestmark = pytest.mark.sim


def onto(*words):
    from runtime.cli import main

    return main(["demos", *map(str, words)])


def shorter(sample, path, **attributes):
    """A copy with the shorter demonstration alone, and ``attributes`` of it changed."""
    shutil.copy(sample, path)
    with h5py.File(path, "r+") as file:
        del file["data/demo_0"]
        file["data/demo_1"].attrs.update(attributes)


def test_show_tells_of_which_task_a_file_is_and_how_it_came_about(sample, capsys):
    assert onto("show", sample) == 0
    shown = capsys.readouterr().out
    assert shown.startswith("libero_goal/put_the_bowl_on_the_plate: put the bowl on the plate\n")
    assert "demo_0: 260 steps, success at 237; state 0, severity 0.92: 3 offset, slip, 1 failed try\n" in shown


def test_show_as_json_has_every_disturbance_and_try(sample, capsys):
    assert onto("show", sample, "--json") == 0
    (file,) = json.loads(capsys.readouterr().out)["files"]
    assert file["spec"]["seed"] == 6
    assert [demo["window_record"] for demo in file["demos"]] == [True, True]
    assert [event["kind"] for event in file["demos"][0]["disturbances"]] == ["offset", "slip", "offset", "offset"]


def test_replay_takes_folders_and_exits_clean_where_all_went_alike(sample, capsys, tmp_path):
    (tmp_path / "deep").mkdir()
    shorter(sample, tmp_path / "deep" / "demo.hdf5")
    assert onto("replay", tmp_path, "--json") == 0
    demos = json.loads(capsys.readouterr().out)["demos"]
    assert [(one["recorded"], one["reached"], one["same"]) for one in demos] == [(78, 78, True)]


def test_replay_exits_with_findings_and_names_the_demonstration(sample, capsys, tmp_path):
    path = tmp_path / "demo.hdf5"
    shorter(sample, path, success_step=77)
    assert onto("replay", path) == 1
    assert "  demo_1: success at step 78, recorded at 77\n" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (("collect",), "CLI002"),
        (("collect", "libero_goal", "--all"), "CLI002"),
        (("collect", "libero_goal", "--count", "0"), "CLI002"),
        (("collect", "libero_goal", "--seed", "-1"), "CLI002"),
        (("collect", "libero_goal", "--jobs", "0"), "CLI002"),
        (("collect", "libero_gaol"), "SIM011"),
        (("collect", "libero_goal", "99"), "SIM012"),
        (("show", "nowhere.hdf5"), "DEM001"),
        (("replay", "nowhere.hdf5"), "DEM001"),
    ],
)
def test_what_makes_no_sense_is_a_problem(words, code, capsys):
    assert onto(*words) == 2
    assert f"error[{code}]" in capsys.readouterr().err


def test_an_empty_folder_has_nothing_to_show(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out/demos").mkdir(parents=True)
    assert onto("show") == 2
    assert "error[DEM001]: there are no demonstrations in out/demos" in capsys.readouterr().err


def test_all_means_forty_tasks_with_their_own_numbers():
    import argparse
    from pathlib import Path

    from runtime.worlds.libero.demos.command import _orders

    options = argparse.Namespace(all=True, suite=None, task=None, count=None, seed=0, out=Path("x"), images=False)
    orders = _orders(options)
    assert len(orders) == 40
    assert sum(order.count for order in orders) == 10 * 50 + 30 * 10


def test_one_demonstration_is_told_in_the_singular(sample, capsys, tmp_path):
    path = tmp_path / "demo.hdf5"
    shorter(sample, path)
    assert onto("show", path) == 0
    assert "  1 demonstration of 112 steps\n" in capsys.readouterr().out
