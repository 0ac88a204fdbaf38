"""What an atom means among a task's initial facts, and where that differs from its meaning in the goal."""

import pytest

from onto_compiler.bddl.lift import required_abox
from onto_compiler.bddl.parse import parse_file
from onto_compiler.compile_schema import load_schema
from onto_compiler.rdf import MAN
from runtime.worlds.libero.simulator.assets import find_task, tasks

pytestmark = pytest.mark.sim
SUITES = {"libero_spatial": 10, "libero_object": 10, "libero_goal": 10, "libero_10": 10, "libero_90": 90}


def lifted(suite, task):
    return required_abox(parse_file(find_task(suite, task).bddl), load_schema(), str(task))


def test_a_region_in_the_goal_asks_for_height_and_one_in_the_premise_for_place_alone():
    abox = lifted("libero_goal", "push_the_plate_to_the_front_of_the_stove")
    (goal,) = abox.facts
    assert (goal.predicate, goal.grounded_by, goal.threshold) == (MAN + "in_region", "on_site", 0.0)
    (plate,) = (fact for fact in abox.premise if fact.arguments[0].name == "plate_1")
    assert (plate.predicate, plate.grounded_by, plate.threshold) == (MAN + "in_region", "placed_in_region", -0.02)


def test_other_initial_facts_mean_what_they_mean_in_a_goal():
    abox = lifted("libero_spatial", 5)
    (on,) = (fact for fact in abox.premise if fact.native.arguments[1] == "glazed_rim_porcelain_ramekin_1")
    assert (on.predicate, on.grounded_by, on.threshold) == (MAN + "on", "on_object", 0.0)


def test_every_initial_fact_of_the_suites_lifts():
    count = 0
    for suite, size in SUITES.items():
        refs = tasks(suite)
        assert len(refs) == size
        for ref in refs:
            spec = parse_file(ref.bddl)
            assert len(required_abox(spec, load_schema(), ref.name).premise) == len(spec.init)
            count += len(spec.init)
    assert count == 676


def test_task_76_of_libero_90_keeps_the_landmark_and_tests_the_region():
    abox = lifted("libero_90", "STUDY_SCENE3_pick_up_the_red_mug_and_place_it_to_the_right_of_the_caddy")
    (fact,) = abox.facts
    assert str(fact) == "right_of(red_coffee_mug_1, desk_caddy_1)"
    assert fact.native.arguments == ("red_coffee_mug_1", "study_table_desk_caddy_right_region")
    assert fact.grounded_by == "on_site"
