"""Validators and pySHACL say the same of whole and of damaged ABoxes; the protocol's numbers follow from its rows."""

from __future__ import annotations

import pytest

from benchmarks.mutations import MUTATIONS
from benchmarks.validator import ABOXES, GRAPH, VALIDATOR, bench, damaged, found_by

EACH = 4
# What the two print differently; the verdict is the same (see benchmarks/validator.py).
PRINTED_DIFFERENTLY = {"malformed", "out of range", "two"}

pytestmark = pytest.mark.usefixtures("queries_parsed_once")


@pytest.mark.parametrize("kind", MUTATIONS)
def test_the_validator_says_what_pyshacl_says(kind):
    one = bench()
    number = list(MUTATIONS).index(kind)
    corpus = [damaged(one, kind, ABOXES * number + seed) for seed in range(EACH)]
    assert all(one.records(triples) > 5 for triples in corpus)
    for triples in corpus:
        mine, theirs = found_by(one.validator.validate(triples)), one.oracle_of(triples)
        assert bool(mine) == bool(theirs)
        if kind not in PRINTED_DIFFERENTLY:
            assert mine == theirs


def test_generated_episodes_conform_and_every_kind_of_damage_makes_some_that_do_not():
    one = bench()
    invalid = {
        kind: sum(bool(one.validator.validate(damaged(one, kind, seed))) for seed in range(40)) for kind in MUTATIONS
    }
    assert len(invalid) == 21
    assert invalid.pop("none") == 0
    assert [kind for kind, count in invalid.items() if count < 4] == []


def test_the_full_protocol_compares_enough():
    *aboxes, graph = VALIDATOR.trials(True)
    assert sum(trial["aboxes"] for trial in aboxes) >= 2000
    assert graph["at_least"] == GRAPH >= 100_000


def test_a_graph_is_validated_by_both_with_the_same_results():
    (row,) = VALIDATOR.run({"key": "graph", "kind": "graph", "at_least": 12_000})
    assert row["triples"] >= 12_000
    assert row["results"] > 0
    assert row["differ"] == row["plain_differ"] == 0


def test_the_metrics_follow_from_the_rows():
    whole = {"kind": "none", "aboxes": 2, "records": 10, "invalid": 0, "mismatches": 0, "results_differ": 0}
    rows = [
        {**whole, "validate_s": 1e-4},
        {**whole, "records": 30, "mismatches": 1, "validate_s": 3e-4},
        {"kind": "graph", "triples": 9, "results": 1, "differ": 0, "engine_s": 0.5, "plain_s": 1.0, "pyshacl_s": 50.0},
        {"crashed": "ValueError"},
    ]
    found = VALIDATOR.metrics(rows)
    assert found["records"] == 40
    assert found["mismatches"] == 1
    assert found["us_per_record"] == pytest.approx(10.0)
    assert found["graph_ratio"] == 100
    assert found["crashed"] == 1
