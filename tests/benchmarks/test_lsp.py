"""The protocol types what it says, takes all of it back, and sums up what it timed."""

import pytest

import ontology
from benchmarks import lsp
from benchmarks.compiler_tables import lsp_table
from onto_compiler.lsp.client import Client

pytest.importorskip("pygls")


def test_typing_and_rubbing_out_leaves_the_file_as_it_was():
    path = ontology.ROOT / "rules/diagnosis.ttl"
    text = path.read_text()
    with Client() as client:
        assert client.open(path, text, "turtle") == []
        for where, line, character, typed in lsp._edits(text):
            places = lsp._places(line, character, typed)
            rows = [lsp._keystroke(client, path, where, *place) for place in places]
            rows += [lsp._keystroke(client, path, where, *place, erase=True) for place in reversed(places)]
            assert len(rows) == 2 * len(typed)
            assert rows[-1]["problems"] == 0
            assert all(row["all_ms"] > row["ms"] for row in rows)
            assert rows[0]["symbols"] == rows[-1]["symbols"] > 3
            assert rows[-1]["tokens"] > 100
            assert rows[-1]["parsed"]
            assert all(row["parsed"] for row in rows) is (where == "definition")


def test_percentiles_are_of_values_that_occurred():
    rows = [
        {"file": "a", "in": "block", "ms": float(ms), "all_ms": 2.0 * ms, "parsed": ms > 90} for ms in range(1, 101)
    ]
    rows += [{"file": "a", "in": "whole", "ms": 200.0}, {"crashed": "yes"}]
    found = lsp.metrics(rows)
    assert (found["p50_ms"], found["p95_ms"], found["max_ms"]) == (50.0, 95.0, 100.0)
    assert (found["keystrokes"], found["parsed"], found["parsed_p50_ms"]) == (100, 10, 95.0)
    assert (found["files"], found["crashed"], found["whole_max_ms"]) == (1, 1, 200.0)
    assert (found["all_p50_ms"], found["all_p95_ms"], found["all_max_ms"]) == (100.0, 190.0, 200.0)


def test_the_table_has_a_row_for_the_whole_answer_once_it_was_measured():
    rows = [{"file": "a", "in": "block", "ms": 1.0, "parsed": True}, {"file": "a", "in": "whole", "ms": 2.0}]
    before = lsp_table({"rows": rows, "metrics": lsp.metrics(rows)})
    rows[0]["all_ms"] = 1.5
    after = lsp_table({"rows": rows, "metrics": lsp.metrics(rows)})
    assert len(after.splitlines()) == len(before.splitlines()) + 1
    assert "| keystroke to problems, semantic tokens and symbols | 1 | 1.5 | 1.5 | 1.5 |" in after
