from __future__ import annotations

import pytest

pytest.importorskip("h5py")
pytestmark = pytest.mark.sim


def demos():
    from benchmarks.demos import DEMOS

    return DEMOS


def test_the_full_run_makes_what_the_command_makes():
    trials = demos().trials(True)
    assert len(trials) == 40
    assert sum(trial["wanted"] for trial in trials) == 10 * 50 + 30 * 10


def test_a_small_run_replays_every_demonstration(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    trial = next(trial for trial in demos().trials(False) if trial["suite"] == "libero_goal")
    rows = [{**trial, **row} for row in demos().run(trial)]
    found = demos().metrics(rows)
    assert (found["demos"], found["replayed_share"], found["drift"], found["crashed"]) == (1, 1.0, 0.0, 0)
    assert rows[0]["reached"] == rows[0]["recorded"] > 0
    assert list(tmp_path.glob("out/bench/demos.*/libero_goal/*_demo.hdf5"))


def test_a_demonstration_that_goes_otherwise_counts_against_the_share():
    shared = {"suite": "libero_goal", "wanted": 3, "trials": 4, "failed_tries": 1, "steps": 100, "drift": 0.0}
    rows = [{**shared, "task": 0, "demo": f"demo_{i}", "same": i > 0} for i in range(3)]
    rows += [{**shared, "task": 1, "demo": None}, {"suite": "libero_10", "task": 2, "crashed": "died"}]
    found = demos().metrics(rows)
    assert found["replayed_share"] == pytest.approx(2 / 3)
    assert (found["demos"], found["wanted"], found["trials"], found["recovered"]) == (3, 6, 8, 3)
    assert (found["crashed"], found["libero_10.demos"], found["libero_10.replayed_share"]) == (1, 0, 0.0)
