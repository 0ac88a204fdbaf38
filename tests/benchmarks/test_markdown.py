"""Tables are whole, and say where each part of a result comes from."""

from __future__ import annotations

import pytest

from benchmarks.markdown import origin, rate, table

MADE = {
    "command": "onto bench skills --full",
    "commit": "0123456789abcdef",
    "date": "2026-01-02T03:04:05+00:00",
    "seeds": [0, 1],
    "machine": {"cpu": "a processor", "cores": 2, "versions": {"mujoco": "3.3.7"}},
}


def test_a_table_has_a_rule_under_its_heads_and_a_line_for_each_row():
    lines = table(("suite", "n"), [("`a`", "1"), ("all", "2")]).splitlines()
    assert lines == ["| suite | n |", "| --- | --- |", "| `a` | 1 |", "| all | 2 |"]


@pytest.mark.parametrize("row", [("a",), ("a", "b", "c")])
def test_a_row_of_another_length_is_a_mistake(row):
    with pytest.raises(ValueError, match="under"):
        table(("suite", "n"), [row])


def test_a_rate_stands_with_its_interval():
    assert rate({"x": 0.5, "x.low": 0.25, "x.high": 0.75}, "x") == "0.500 [0.250, 0.750]"


def test_parts_that_were_run_apart_are_named_before_the_whole():
    whole = origin(MADE)
    assert whole == (
        "Made by `onto bench skills --full` at commit `0123456789ab` on 2026-01-02, seed 0, 1; a processor, 2 cores; "
        "mujoco 3.3.7."
    )
    part = {"command": "onto bench skills --full --part goal", "commit": "fedcba9876543210", "date": "2026-01-01"}
    told = "`goal`: `onto bench skills --full --part goal` at commit `fedcba987654` on 2026-01-01."
    assert origin(MADE | {"parts": {"goal": part}}) == f"{told}\n\n{whole}"
    later = part | {"date": "2026-01-03", "cpu": "another", "gpu": "a card"}
    told = (
        "`goal`, `spatial`: `onto bench skills --full --part goal` at commit `fedcba987654` on 2026-01-01; "
        "`object`: `onto bench skills --full --part goal` at commit `fedcba987654` on 2026-01-03 on another and a card."
    )
    assert origin(MADE | {"parts": {"goal": part, "object": later, "spatial": part}}) == f"{told}\n\n{whole}"
