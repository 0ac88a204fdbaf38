"""Published rows are made again, and what differs is named."""

from __future__ import annotations

from dataclasses import replace

import pytest

from benchmarks import replay
from benchmarks.protocol import Protocol, load_protocols, protocol_named
from benchmarks.replay import BUDGET, MOST, REPLAY, added_fields, compared, run, sampled, trials_of
from benchmarks.replay_table import replayed_table
from benchmarks.results import processors
from onto_compiler.problems import OntoError

NOT_CHEAP = {  # none of their trials takes less than some seconds, or they are not published yet
    *("audit_versions", "compiler", "demo", "demos", "house", "lsp", "robosuite", "validator", "world_model_libero"),
    "wild",
}
NAMES = sorted(name for name, protocol in load_protocols().items() if name != "replay" and protocol.of_folder is None)


def listed(full):
    return [{"key": f"t{number}"} for number in range(20)]


SHORT = Protocol("short", "for this test", (), listed, lambda trial: [], lambda rows: {})


def published(seconds):
    return {f"t{number}": [{"key": f"t{number}", "seconds": each}] for number, each in enumerate(seconds)}


def test_a_sample_is_the_same_each_time_and_within_its_budget():
    rows = published([1.0] * 19 + [1000.0])
    first = sampled(SHORT, rows, full=True)
    assert first == sampled(SHORT, rows, full=True)
    assert len({trial["key"] for trial in first}) == MOST
    assert [trial["key"] for trial in sampled(SHORT, published([1000.0, 400.0, BUDGET + 1]), full=True)] == ["t2"]
    assert sampled(SHORT, published([1000.0]), full=False) == []


def test_arms_are_sampled_in_turn_and_each_that_is_cheap_at_least_once():
    arms = 15
    several = replace(
        SHORT, trials=lambda full: [{"key": f"t{n}", "arm": n % arms} for n in range(5 * arms)], arms="arm"
    )
    rows = {f"t{n}": [{"key": f"t{n}", "seconds": 3.0 if n % arms else 20.0}] for n in range(5 * arms)}
    drawn = [trial["arm"] for trial in sampled(several, rows, full=True)]
    assert set(range(1, arms)) <= set(drawn)
    assert len(drawn) == len(set(drawn))
    cheap = sampled(several, {key: [{**row, "seconds": 0.1} for row in some] for key, some in rows.items()}, full=True)
    assert sorted(trial["arm"] for trial in cheap) == list(range(arms))


def test_a_row_that_the_protocol_lists_no_more_is_not_drawn():
    rows = {"gone": [{"key": "gone", "seconds": 0.1}]}
    assert sampled(SHORT, rows, full=True) == []


def test_every_field_that_differs_is_found_and_so_are_missing_rows():
    old, new = {"a": 1, "b": [0.1], "gone": 0}, {"a": 1, "b": [0.1 + 1e-17, 2], "come": None}
    assert [each["field"] for each in compared([old], [new])] == ["b", "gone"]
    assert list(added_fields(old, new)) == ["come"]
    assert [each["field"] for each in compared([old, old], [old])] == ["rows"]
    assert list(compared([old], [dict(old)])) == []
    assert [each["now"] for each in compared([old], [{"crashed": "Boom"}])] == ["Boom"]


def test_a_field_that_was_added_within_a_record_is_no_difference_and_a_changed_one_is():
    old = {"tries": [{"route": "a", "steps": 3}]}
    assert list(compared([old], [{"tries": [{"route": "a", "steps": 3, "reason": ""}]}])) == []
    assert list(added_fields(old, {"tries": [{"route": "a", "steps": 3, "reason": ""}]})) == ["tries[].reason"]
    assert [each["field"] for each in compared([old], [{"tries": [{"route": "a", "steps": 4}]}])] == ["tries"]
    assert [each["field"] for each in compared([old], [{"tries": []}])] == ["tries"]
    assert [each["field"] for each in compared([{"truth": 1}], [{"truth": True}])] == ["truth"]


def test_the_figures_count_what_differs():
    row = {"key": "x", "protocol": "short", "rows": 3, "differ": 2, "added": ["a"], "of_another_processor": []}
    other = row | {"protocol": "other", "differ": 0, "of_another_processor": ["told"]}
    rows = [row, other, {"key": "y", "protocol": "other", "crashed": "Boom"}]
    figures = {"protocols": 2, "trials": 2, "rows": 6, "differences": 2, "added_fields": 2, "crashed": 1}
    assert REPLAY.metrics(rows) == figures
    told = replayed_table({"rows": rows})
    assert "| `short` | 1 | 3 | 2 | 0 |" in told
    assert told.endswith("another one published it: `other` `told`.")
    assert "another" not in replayed_table({"rows": [row]})


@pytest.mark.parametrize(
    ("machine", "parts", "compared_too"),
    [
        (processors(), {}, True),
        ({"cpu": "another"}, {}, False),
        ({"cpu": "another"}, {"a": {"commit": "c", **processors()}}, True),
        (processors(), {"a": {"commit": "c", "cpu": "another"}}, False),
        (processors(), {"a": {"commit": "c"}}, False),  # nobody noted it
        ({**processors(), "gpu": "another"}, {}, False),
    ],
)
def test_what_depends_on_the_processor_is_compared_where_the_same_one_published_it(
    monkeypatch, machine, parts, compared_too
):
    protocol = replace(
        SHORT, run=lambda trial: [{"exact": 1, "told": 0.1}], parts="part", of_processor=frozenset({"told"})
    )
    trial = {"key": "t0", "part": "a"}
    rows = [{**trial, "exact": 2, "told": 0.2, "seconds": 1.0}]
    monkeypatch.setattr(replay, "protocol_named", lambda name: protocol)
    monkeypatch.setattr(replay, "read_result", lambda path: {"machine": machine, "parts": parts, "rows": rows})
    replay._record.cache_clear()
    replay._published.cache_clear()
    (row,) = run({"key": "short t0", "protocol": "short", "trial": trial})
    assert [each["field"] for each in row["differences"]] == (["exact", "told"] if compared_too else ["exact"])
    assert row["of_another_processor"] == ([] if compared_too else ["told"])


@pytest.mark.sim
@pytest.mark.parametrize("name", NAMES)
def test_a_published_row_of_each_protocol_is_made_again_to_the_last_digit(name):
    pytest.importorskip("libero")
    try:
        chosen = trials_of(protocol_named(name), full=False)
    except OntoError as error:
        if error.problems[0].code == "BEN003":
            pytest.skip(error.problems[0].message)  # the package index is out of reach
        raise
    assert chosen or name in NOT_CHEAP
    for trial in chosen:
        (row,) = run(trial)
        assert row["rows"] >= 1
        assert row["differences"] == []
