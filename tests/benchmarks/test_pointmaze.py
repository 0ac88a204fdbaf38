"""PointMaze's protocol: a trial leaves its row and its trace, and success is counted by the time that plans take."""

from __future__ import annotations

import pytest

from benchmarks.pointmaze import BLOCKS, COMPARED, POINTMAZE, TRACES
from benchmarks.pointmaze_tables import pointmaze_table
from runtime.trace.store import open_trace
from runtime.worlds.pointmaze.planning.rows import ROWS

pytestmark = pytest.mark.sim


def played(row, trial, distance, time, success=True):
    return {
        "row": row, "model": 0, "trial": trial, "block": "published", "success": success, "plans": 1, "time": time,
        "distance": distance, "position": 0.1, "velocity": 0.1, "evaluations": 9, "planning_s": 0.1, "predicted": [],
    }  # fmt: skip


def test_a_trial_leaves_its_row_and_its_trace(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (row,) = POINTMAZE.run({"key": "random/0/3", "row": "random", "model": 0, "trial": 3})
    assert (row["mode"], row["sees"], row["block"], row["predicted"]) == ("controller", "nothing", "published", [])
    trace = open_trace(TRACES / "random/0/3.trig.gz")
    (iri,) = trace.episodes()
    episode = trace.episode(iri)
    assert (episode.state_index, len(episode.plans)) == (3, row["plans"])
    assert (episode.outcome == "accepted") == row["success"]


def test_success_is_counted_by_time_and_differences_by_trial():
    rows = [played("search", k, 0.2, 1 + k % 2) for k in range(10)]
    rows += [played("undirected_search", k, 0.5 + 0.01 * k, 1, success=k > 0) for k in range(10)]
    found = POINTMAZE.metrics(rows)
    assert (found["search_success_1"], found["search_success_2"], found["search_success"]) == (0.5, 1.0, 1.0)
    assert found["undirected_search_success"] == 0.9
    assert found["search_minus_undirected"] == pytest.approx(-0.345)
    assert found["search_vs_undirected_p"] < 0.01
    assert "search_vs_random_p" not in found


def test_a_difference_that_one_model_lacks_is_not_shown_and_parts_have_tests_of_their_own():
    rows = [
        {**played("search", k, 0.3 - (0.1, 0.0, 0.12)[model] + 0.02 * (k % 3), 1), "model": model, "position": 0.2}
        for k in range(30)
        for model in range(3)
    ]
    rows += [
        {**played("random_search", k, 0.3 + 0.02 * (k % 2), 1), "model": model} for k in range(30) for model in range(3)
    ]
    found = POINTMAZE.metrics(rows)
    assert found["search_minus_random.low"] < 0 < found["search_minus_random.high"]
    assert found["search_minus_random.model_1"] == pytest.approx(0.01)
    assert found["search_minus_random_position"] == pytest.approx(0.1)
    assert found["search_vs_random_position_p"] < 0.001
    assert found["search_vs_random_p"] > 0.05
    told = pointmaze_table({"metrics": found})
    assert "No difference is shown in distance: `search` and `random_search`; in velocity:" in told
    assert "Worse is, in position: `search` than `random_search`." in told


def test_a_distance_is_divided_by_that_of_a_search_on_the_true_dynamics_with_the_same_budget():
    distances = {
        "ceiling": 0.2,
        "ceiling_large": 0.1,
        "onto": 0.4,
        "search": 0.4,
        "large": 0.4,
        "constant_mechanism": 0.4,
    }
    rows = [played(name, k, distance, 1) for name, distance in distances.items() for k in range(2)]
    lines = pointmaze_table({"metrics": POINTMAZE.metrics(rows)}).splitlines()
    over = {cells[0]: cells[6] for line in lines if len(cells := line.strip("| ").split(" | ")) == 11}
    assert over["`onto`"] == "2.00 (`ceiling`)"
    assert {over[f"`{name}`"] for name in ("search", "large", "constant_mechanism")} == {"4.00 (`ceiling_large`)"}


def test_mechanisms_that_were_drawn_are_counted_by_themselves_and_as_the_rules_name_them():
    seen = {"truth": [[True, False]] * 3, "margin": [[0.1, -0.1]] * 3}
    tried = [
        ["VelocityMismatch", "match_velocity", False, 9],
        ["VelocityMismatch", "resample_around_margin", True, 9],
        ["TargetDistance", "resample_around_margin", True, 9],
        ["TargetDistance", "waypoint", False, 0],
    ]
    found = POINTMAZE.metrics([{**played("random_search", 0, 0.2, 1), "predicted": [{**seen, "tried": tried}]}])
    assert (found["random_search_by_rule.bettered"], found["random_search_by_rule.answered"]) == (0.5, 2)
    assert found["random_search_resample_around_margin.bettered"] == 1.0
    assert "random_search_waypoint.bettered" not in found


def test_no_row_is_named_as_the_block_of_another():
    assert not {f"{row}_{block}" for row in ROWS for block in BLOCKS} & set(ROWS)


def test_a_fact_that_was_not_observed_is_predicted_neither_falsely_nor_truly():
    seen = {"truth": [[True, False], [None, False], [True, True]], "margin": [[0.1, -0.1], [None, -1], [0.4, 0.4]]}
    rows = [{**played("search_blind", k, 0.2, 1), "predicted": [seen]} for k in range(2)]
    lines = pointmaze_table({"metrics": POINTMAZE.metrics(rows)}).splitlines()
    assert "| `search_blind` | 1.000 | 0.000 | — | — | 0.000 | 0.000 |" in lines


def test_comparisons_are_of_rows_that_exist():
    assert {name for pair in COMPARED.values() for name in pair} <= set(ROWS)
    assert len(COMPARED) == 10


def test_every_row_is_run_on_every_trial_and_what_asks_no_model_once():
    full = [trial for trial in POINTMAZE.trials(True) if trial["row"] != "speed"]
    learned = sum(row.learned for row in ROWS.values())
    assert len(full) == 350 * (3 * learned + len(ROWS) - learned)
    assert len({trial["key"] for trial in full}) == len(full)


def test_the_page_has_a_line_for_each_row_that_was_run_and_each_pair_of_them():
    seen = {"truth": [[True, False], [False, False], [True, True]], "margin": [[0.1, -0.1], [-0.2, -0.3], [0.4, 0.4]]}
    tried = [
        ["VelocityMismatch", "match_velocity", True, 2700],
        ["EntityMissing", "waypoint", False, 3000],
        ["EntityMissing", "longer_horizon", False, 0],
    ]
    rows = [{**played("search", k, 0.2, 1), "predicted": [{**seen, "tried": tried[k:]}]} for k in range(4)]
    rows += [played("undirected_search", k, 0.4, 1) for k in range(4)]
    lines = pointmaze_table({"metrics": POINTMAZE.metrics(rows)}).splitlines()
    assert sum(line.startswith("| `search` |") for line in lines) == 3  # how it did, by block, what it predicted
    assert sum(line.startswith("| `undirected_search` |") for line in lines) == 2
    assert any(line.startswith("| `search` less `undirected_search` | -0.200 [-0.200, -0.200] p ") for line in lines)
    assert "| `search` | 1.000 | 0.000 | 0.000 | 0.000 | 0.000 | 0.000 |" in lines
    assert "Of the mechanisms that were drawn" not in "".join(lines)  # none was
    answers = [
        "| `missing_entity_on_target` | `waypoint` | 0.00 of 2 |",
        "| `velocity_mismatch` | `match_velocity` | 1.00 of 1 |",
    ]
    assert [line for line in lines if line.startswith(("| `missing", "| `velocity"))] == answers
