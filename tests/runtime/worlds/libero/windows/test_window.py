"""Which windows are drawn: by the rule, from the seed, none twice."""

from __future__ import annotations

import dataclasses
from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from onto_compiler.problems import OntoError
from runtime.worlds.libero.demos.records import DemoFile, Demonstration
from runtime.worlds.libero.windows.window import FIXTURE_SEEDS, LENGTH, PUBLISHED, RULES, draw_windows

LENGTHS = st.lists(st.integers(LENGTH, 120), min_size=1, max_size=6)
EARLIEST = {PUBLISHED: 33, "n-37..n-25": 37, "n-30..n-25": 30}


def file_of(lengths, onsets=None, task="a_task"):
    demos = []
    for number, length in enumerate(lengths):
        empty = np.empty((length, 0))
        demo = Demonstration(f"demo_{number}", *[empty] * 4, obs={}, robot_states=None, init_state=np.empty(0))
        if onsets is not None:
            truth = (np.arange(1, length + 1) >= onsets[number])[:, None]
            demo = dataclasses.replace(demo, truth=truth)
        demos.append(demo)
    return DemoFile("a.hdf5", "libero_goal", task, "", "", tuple(demos))


@given(LENGTHS, st.integers(0, 3), st.sampled_from(sorted(EARLIEST)), st.data())
def test_windows_are_of_the_rule_and_none_is_drawn_twice(lengths, seed, name, data):
    possible = sum(len(range(max(0, n - EARLIEST[name]), n - LENGTH + 1)) for n in lengths)
    count = data.draw(st.integers(1, possible))
    found = draw_windows(file_of(lengths), seed, count=count, rule=RULES[name])
    assert len({(one.demo, one.start) for one in found}) == len(found) == count
    for one in found:
        n = lengths[one.demo]
        assert max(0, n - EARLIEST[name]) <= one.start
        assert one.start + LENGTH == one.stop <= n
        assert one.fixtures_seed in FIXTURE_SEEDS
        assert (one.task, one.sampling_seed, one.fold) == ("libero_goal/a_task", seed, one.demo % 4)
    assert list(found) == sorted(found)
    assert found == draw_windows(file_of(lengths), seed, count=count, rule=RULES[name])


def test_seeds_and_tasks_draw_differently_and_every_window_has_its_turn():
    file = file_of([60] * 8)
    draws = [draw_windows(file, seed, count=20) for seed in range(60)]
    assert len({tuple((one.demo, one.start) for one in draw) for draw in draws}) == 60
    assert draws[0] != draw_windows(file_of([60] * 8, task="another"), 0, count=20)
    drawn = Counter((one.demo, one.start) for draw in draws for one in draw)
    assert set(drawn) == {(demo, start) for demo in range(8) for start in range(27, 36)}
    assert {one.fixtures_seed for draw in draws for one in draw} == set(FIXTURE_SEEDS)


@given(st.integers(LENGTH, 80), st.data())
def test_windows_around_the_onset_hold_it(length, data):
    onset = data.draw(st.integers(1, length))
    starts = list(RULES["holding the lasting onset"](file_of([length], [onset]).demos[0]))
    assert starts == [t for t in range(length - LENGTH + 1) if t < onset <= t + LENGTH]
    undone = file_of([length], [length + 1]).demos[0]
    assert list(RULES["holding the lasting onset"](undone)) == []


@pytest.mark.parametrize(
    ("draw", "code", "words"),
    [
        (lambda: draw_windows(file_of([60, 24]), 0, count=1), "DEM008", "`demo_1` has 24 steps, and a window 25"),
        (lambda: draw_windows(file_of([60]), 0), "DEM008", "1 demonstration has 9 windows by this rule, and 50 were"),
        (lambda: RULES["holding the lasting onset"](file_of([60]).demos[0]), "DEM007", "without the truth"),
    ],
)
def test_what_cannot_be_drawn_is_said(draw, code, words):
    with pytest.raises(OntoError, match=words) as caught:
        draw()
    assert caught.value.problems[0].code == code


def test_only_the_first_forty_demonstrations_are_used():
    drawn = draw_windows(file_of([60] * 50), 0, count=360)
    assert {one.demo for one in drawn} == set(range(40))
