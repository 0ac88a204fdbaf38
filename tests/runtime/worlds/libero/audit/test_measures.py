"""Measures tell a fall straight down from sliding, tipping and turning."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from grounding.observation import Observation
from onto_compiler.required import Fact, NativeAtom, RequiredABox
from onto_compiler.schema import Schema
from runtime.worlds.libero.audit.measures import DECIDING, MEASURES, StateEvidence
from runtime.worlds.libero.audit.scene_state import SceneState

UPRIGHT = np.eye(3)


def about(axis, angle):
    """The rotation matrix about coordinate axis ``axis`` (0, 1, 2)."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = [k for k in range(3) if k != axis]
    matrix = np.eye(3)
    matrix[[i, j], [i, j]] = c
    matrix[i, j], matrix[j, i] = (-s, s) if axis != 1 else (s, -s)
    return matrix


def moment(position=(0, 0, 0), axes=UPRIGHT, hinges=(), slides=(), depths=(), sunk=()):
    return SceneState({"cup": (np.array(position, float), axes)}, dict(hinges), dict(slides), dict(depths), dict(sunk))


def stage(before, after):
    nothing = Observation("sim", 0, *(np.zeros(0, bool),) * 2, *(np.zeros(0),) * 2, ())
    required = RequiredABox("task", "", "", ())
    return StateEvidence(before, after, required, nothing, nothing, Schema.__new__(Schema))


def reading(name, before, after):
    (one,) = MEASURES[name](stage(before, after))
    assert one.subject == "cup"
    return one.value


def test_a_fall_straight_down_moves_nothing_sideways():
    before, after = moment((0.1, 0.2, 0.9)), moment((0.1, 0.2, 0.83))
    assert reading("displacement", before, after) == 0
    assert reading("tilt", before, after) == 0
    assert reading("turn", before, after) == 0
    assert reading("fall", before, after) == pytest.approx(0.07)


def test_displacement_is_seen_from_above():
    assert reading("displacement", moment((0, 0, 1)), moment((0.03, -0.04, 0.5))) == pytest.approx(0.05)


@pytest.mark.parametrize("first", [UPRIGHT, about(0, np.pi / 2), about(1, -np.pi / 2)])
@pytest.mark.parametrize("angle", [0.3, -0.3, 2.5])
def test_a_turn_about_the_vertical_is_no_tilt_whichever_axis_is_upright(first, angle):
    before, after = moment(axes=first), moment(axes=about(2, angle) @ first)
    assert reading("turn", before, after) == pytest.approx(abs(angle))
    assert reading("tilt", before, after) == pytest.approx(0, abs=1e-7)


@pytest.mark.parametrize("axis", [0, 1])
def test_tipping_is_no_turn(axis):
    before, after = moment(axes=UPRIGHT), moment(axes=about(axis, 0.4))
    assert reading("tilt", before, after) == pytest.approx(0.4)
    assert reading("turn", before, after) == pytest.approx(0)


def test_joints_are_compared_by_name():
    before = moment(hinges={"door": 0.1}, slides={"drawer": 0.0})
    after = moment(hinges={"door": -0.1}, slides={"drawer": 0.02})
    ((door,), (drawer,)) = (tuple(MEASURES[name](stage(before, after))) for name in ("hinge", "slide"))
    assert (door.subject, door.value) == ("door", pytest.approx(0.2))
    assert (drawer.subject, drawer.value) == ("drawer", 0.02)


def test_depths_are_read_before_and_after_settling():
    before = moment(depths={"cup, plate": 0.004}, sunk={"cup, table": 0.03})
    one = stage(before, moment(depths={"bowl, cup": 0.002}, sunk={"cup, table": 0.0001}))
    found = {name: {r.subject: r.value for r in MEASURES[name](one)} for name in ("overlap", "sunk", "penetration")}
    assert found == {
        "overlap": {"cup, plate": 0.004},
        "sunk": {"cup, table": 0.03},
        "penetration": {"bowl, cup": 0.002, "cup, table": 0.0001},
    }


@pytest.mark.parametrize(
    ("truth", "margin", "threshold", "holds", "value"),
    [
        (True, 0.01, 0.0, True, 0.01),
        (False, -0.01, 0.0, False, -0.01),
        (False, -0.01, -0.02, True, 0.01),  # tolerated
        (False, -0.03, -0.02, False, -0.01),
    ],
)
def test_an_initial_fact_is_judged_with_its_tolerance(schema, truth, margin, threshold, holds, value):
    fact = Fact(next(iter(schema.predicates)), (), NativeAtom("On", ()), "on_object", threshold=threshold)
    seen = Observation("sim", 0, np.array([True]), np.array([truth]), np.array([margin]), np.array([np.nan]), ("xy",))
    one = stage(moment(), moment())
    one = replace(one, required=replace(one.required, premise=(fact,)), premise=seen, schema=schema)
    (found,) = MEASURES["initial_fact"](one)
    assert (found.holds, found.value, found.limit, found.fact) == (holds, pytest.approx(value), "xy", 0)


@pytest.mark.parametrize(("truths", "holds"), [((True, True), False), ((True, False), True)])
def test_a_goal_that_holds_already_is_a_failure(schema, truths, holds):
    facts = tuple(
        Fact(next(iter(schema.predicates)), (), NativeAtom("On", (name,)), "on_object") for name in ("a", "b")
    )
    margins = np.where(truths, 0.02, -0.01)
    seen = Observation("sim", 0, np.ones(2, bool), np.array(truths), margins, np.full(2, np.nan), ("x", "y"))
    one = replace(stage(moment(), moment()), required=RequiredABox("task", "", "", facts), goal=seen, schema=schema)
    (found,) = MEASURES["goal"](one)
    assert found.holds is holds
    assert found.value == pytest.approx(0.01 if holds else -0.02)


def test_the_deciding_measures_are_measures():
    assert set(MEASURES) > DECIDING
    assert len(MEASURES) == 11
