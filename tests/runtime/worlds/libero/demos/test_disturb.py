from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytestmark = pytest.mark.sim
MOVE = np.array([0.3, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0])
HOLD = np.array([0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 1.0])


def played(seed, severity, steps=120, shut_from=40):
    from runtime.worlds.libero.demos.disturb import Disturber

    disturber = Disturber(np.random.default_rng(seed), severity)
    done = [disturber(HOLD if step >= shut_from else MOVE) for step in range(steps)]
    return np.array(done), disturber.events


def test_without_severity_nothing_is_disturbed():
    done, events = played(3, 0.0)
    np.testing.assert_array_equal(done[:40], [MOVE] * 40)
    np.testing.assert_array_equal(done[40:], [HOLD] * 80)
    assert events == []


@given(st.integers(0, 10_000), st.floats(0.0, 1.0))
@settings(max_examples=30, deadline=None)
def test_the_same_seed_disturbs_alike_and_every_action_stays_one(seed, severity):
    first, events = played(seed, severity)
    again, same = played(seed, severity)
    np.testing.assert_array_equal(first, again)
    assert events == same
    assert np.abs(first).max() <= 1.0


def test_what_rests_is_left_at_rest():
    from runtime.worlds.libero.demos.disturb import Disturber
    from runtime.worlds.libero.simulator.actions import DUMMY_ACTION

    disturber = Disturber(np.random.default_rng(0), 1.0)
    disturber.step = 500  # past any push
    np.testing.assert_array_equal(disturber(np.array(DUMMY_ACTION)), DUMMY_ACTION)


def test_pushes_and_slips_happen_as_often_as_they_are_said_to():
    kinds = [{event["kind"] for event in played(seed, 1.0)[1]} for seed in range(300)]
    assert 0.5 < np.mean(["push" in one for one in kinds]) < 0.7
    assert 0.12 < np.mean(["slip" in one for one in kinds]) < 0.28
    assert all("offset" in one for one in kinds)


def test_a_slip_opens_the_fingers_for_some_steps_and_is_noted():
    slipped = next(seed for seed in range(100) if any(e["kind"] == "slip" for e in played(seed, 1.0)[1]))
    done, events = played(slipped, 1.0)
    (slip,) = (event for event in events if event["kind"] == "slip")
    opened = np.flatnonzero(done[40:, 6] < 0) + 40
    assert opened.tolist() == list(range(slip["step"], slip["step"] + slip["steps"]))
    assert 4 <= slip["steps"] <= 6


def test_an_offset_holds_for_one_approach():
    from runtime.worlds.libero.demos.disturb import Disturber, Strength

    disturber = Disturber(np.random.default_rng(1), 1.0, Strength(noise=0.0, twist=0.0, push=0.0, slip=0.0))
    first = [disturber(MOVE) for _ in range(5)]
    shut = [disturber(HOLD) for _ in range(5)]
    second = [disturber(MOVE) for _ in range(5)]
    assert np.ptp(first, axis=0).max() == np.ptp(second[1:], axis=0).max() == 0.0
    assert np.abs(first[0] - second[1])[:2].max() > 0.0
    np.testing.assert_array_equal(shut, [HOLD] * 5)
