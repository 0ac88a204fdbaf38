"""Native atoms become typed facts by the first binding that fits."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import pytest

from onto_compiler.bddl import lift, parse, parse_file, required_abox
from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import OntoError
from onto_compiler.required import Entity, NativeAtom

EX = "https://example.org/"
SCENE = """
(define (problem P) (:domain robosuite) (:language do it)
(:regions (left_of_plate_1 (:target table_1)) (left_of_stove (:target table_1)) (left_of_cup (:target table_1))
  (corner (:target table_1)) (cook_region (:target stove_1)) (middle_region (:target cabinet_1))
  (rim (:target bowl_1)))
(:fixtures table_1 - table cabinet_1 - wooden_cabinet stove_1 - flat_stove)
(:objects bowl_1 - akita_black_bowl plate_1 - plate cup_1 cup_2 - cup)
(:init (On bowl_1 stove_1_cook_region) (On plate_1 stove_1_cook_region) (On cup_1 stove_1_cook_region)
  (On cup_2 stove_1_cook_region) INIT) (:goal GOAL))
"""


@pytest.fixture
def lifted(schema):
    def lifted(goal, init=""):
        return lift(parse(SCENE.replace("INIT", init).replace("GOAL", goal)), schema, "task")

    return lifted


@pytest.fixture
def facts(lifted):
    return lambda goal: [str(fact) for fact in lifted(goal)[0].facts]


def problems(lifted, goal):
    with pytest.raises(OntoError) as caught:
        lifted(goal)
    return [(each.code, each.severity) for each in caught.value.problems]


def test_a_task_lifts_whole(task_file, schema):
    abox = required_abox(parse_file(task_file), schema, "libero_goal/7")
    assert (abox.task, abox.problem) == ("libero_goal/7", "LIBERO_Tabletop_Manipulation")
    assert (abox.language, abox.source) == ("put the bowl on the stove and open the middle drawer", str(task_file))
    on, opened = abox.facts
    assert on.predicate == EX + "on"
    assert on.arguments == (
        Entity("akita_black_bowl_1", EX + "Bowl"),
        Entity("flat_stove_1_cook_region", EX + "Cooktop"),
    )
    assert on.native == NativeAtom("On", ("akita_black_bowl_1", "flat_stove_1_cook_region"))
    assert on.grounded_by == "on_site"
    assert opened.arguments == (
        Entity("wooden_cabinet_1_middle_region", EX + "Drawer"),
        Entity("cabinetOpen", EX + "cabinetOpen"),
    )
    assert [str(fact) for fact in abox.premise] == [
        "on(akita_black_bowl_1, main_table_bowl_region)",
        "on(plate_1, main_table_plate_region)",
        "on(plate_2, main_table_plate_region)",
    ]


def test_a_fact_points_at_its_atom(task_file, schema):
    (first, _) = required_abox(parse_file(task_file), schema, "task").facts
    text = task_file.read_text("utf-8").splitlines()[first.span.line - 1]
    assert text[first.span.column - 1 : first.span.end_column - 1] == (
        "(On akita_black_bowl_1 flat_stove_1_cook_region)"
    )


@pytest.mark.parametrize(
    ("goal", "fact"),
    [
        ("(On bowl_1 plate_1)", "stacked(bowl_1, plate_1)"),
        ("(oN bowl_1 plate_1)", "stacked(bowl_1, plate_1)"),
        ("(On bowl_1 table_1_corner)", "on(bowl_1, table_1_corner)"),
        ("(On bowl_1 stove_1_cook_region)", "on(bowl_1, stove_1_cook_region)"),
        ("(Touching bowl_1 cup_1)", "touching(bowl_1, cup_1)"),
        ("(OPEN cabinet_1_middle_region)", "jointState(cabinet_1_middle_region, cabinetOpen)"),
    ],
)
def test_the_first_binding_whose_types_fit_is_taken(facts, goal, fact):
    assert facts(goal) == [fact]


def test_a_landmark_is_an_instance_or_the_only_one_of_its_category(facts, lifted):
    assert facts("(On bowl_1 table_1_left_of_plate_1)") == ["leftOf(bowl_1, plate_1)"]
    assert lifted("(On bowl_1 table_1_left_of_plate_1)")[0].facts[0].native.arguments[1] == "table_1_left_of_plate_1"


def test_a_landmark_that_is_not_there_or_not_alone_leaves_the_region(facts):
    # No `stove` is declared, and there are two cups.
    assert facts("(On bowl_1 table_1_left_of_stove)") == ["on(bowl_1, table_1_left_of_stove)"]
    assert facts("(On bowl_1 table_1_left_of_cup)") == ["on(bowl_1, table_1_left_of_cup)"]


def test_a_landmark_of_a_single_category_is_its_instance(schema):
    text = SCENE.replace("cup_1 cup_2 - cup", "cup_1 - cup").replace("(On cup_2 stove_1_cook_region) INIT", "")
    spec = parse(text.replace("GOAL", "(On bowl_1 table_1_left_of_cup)"))
    assert [str(fact) for fact in required_abox(spec, schema, "task").facts] == ["leftOf(bowl_1, cup_1)"]


def test_regions_are_typed_by_what_they_are_part_of(lifted):
    goal = "(And (On cup_1 table_1_corner) (On cup_1 bowl_1_rim) (On cup_1 stove_1_cook_region))"
    types = [fact.arguments[1].type for fact in lifted(goal)[0].facts]
    assert types == [EX + "Area", EX + "Region", EX + "Cooktop"]


@pytest.mark.parametrize(
    ("goal", "polarities"),
    [
        ("(And (On bowl_1 plate_1) (Not (On cup_1 plate_1)))", [True, False]),
        ("(Not (Or (On bowl_1 plate_1) (On cup_1 plate_1)))", [False, False]),
        ("(Not (Not (On bowl_1 plate_1)))", [True]),
        ("(Not (And (On bowl_1 plate_1)))", [False]),
        ("(Or (On bowl_1 plate_1))", [True]),
        ("(And (And (On bowl_1 plate_1)) (Not (Or (On cup_1 plate_1) (Not (On cup_2 plate_1)))))", [True, False, True]),
    ],
)
def test_negation_becomes_polarity(lifted, goal, polarities):
    assert [fact.polarity for fact in lifted(goal)[0].facts] == polarities


@pytest.mark.parametrize(
    ("goal", "facts", "alternatives"),
    [
        (
            "(Or (On bowl_1 plate_1) (On cup_1 plate_1))",
            ["stacked(bowl_1, plate_1)", "stacked(cup_1, plate_1)"],
            ((0,), (1,)),
        ),
        (
            "(Not (And (On bowl_1 plate_1) (On cup_1 plate_1)))",
            ["not stacked(bowl_1, plate_1)", "not stacked(cup_1, plate_1)"],
            ((0,), (1,)),
        ),
        (
            "(And (On bowl_1 plate_1) (Or (On cup_1 plate_1) (oN cup_1 plate_1) (On cup_2 plate_1)))",
            ["stacked(bowl_1, plate_1)", "stacked(cup_1, plate_1)", "stacked(cup_2, plate_1)"],
            ((0, 1), (0, 2)),
        ),
        (
            "(forall (?cup - cup) (On ?cup plate_1))",
            ["stacked(cup_1, plate_1)", "stacked(cup_2, plate_1)"],
            (),
        ),
        (
            "(exists (?cup - cup) (not (On ?cup plate_1)))",
            ["not stacked(cup_1, plate_1)", "not stacked(cup_2, plate_1)"],
            ((0,), (1,)),
        ),
        (
            "(forn (1) (?cup - cup) (On ?cup plate_1))",
            [
                "stacked(cup_1, plate_1)",
                "not stacked(cup_1, plate_1)",
                "stacked(cup_2, plate_1)",
                "not stacked(cup_2, plate_1)",
            ],
            ((0, 3), (1, 2)),
        ),
        (
            "(imply (On cup_1 plate_1) (On bowl_1 plate_1))",
            ["not stacked(cup_1, plate_1)", "stacked(bowl_1, plate_1)"],
            ((0,), (1,)),
        ),
        (
            "(Or (On cup_1 plate_1) (And (On cup_1 plate_1) (On cup_2 plate_1)))",
            ["stacked(cup_1, plate_1)"],
            (),
        ),
        (
            "(And (Not (On cup_1 plate_1)) (Or (On cup_1 plate_1) (On cup_2 plate_1)))",
            ["not stacked(cup_1, plate_1)", "stacked(cup_2, plate_1)"],
            (),
        ),
    ],
)
def test_a_choice_becomes_alternatives(lifted, goal, facts, alternatives):
    abox, _ = lifted(goal)
    assert [str(fact) for fact in abox.facts] == facts
    assert abox.alternatives == alternatives
    assert abox.ways == (alternatives or (tuple(range(len(facts))),))


def test_a_ground_fact_points_at_the_atom_under_its_quantifier(lifted):
    goal = "(forall (?cup - cup) (On ?cup plate_1))"
    first, second = lifted(goal)[0].facts
    assert first.span == second.span
    assert first.span.end_column - first.span.column == len("(On ?cup plate_1)")


def test_an_atom_under_a_quantifier_has_one_problem(lifted):
    assert problems(lifted, "(forall (?cup - cup) (Sparkles ?cup))") == [("BDDL003", "error")]


def test_a_binding_of_another_domain_lifts_the_predicates_of_that_domain_alone(schema):
    text = SCENE.replace("INIT", "(not (On cup_1 plate_1))").replace("GOAL", "(Stacked bowl_1 plate_1)")
    mine = dataclasses.replace(schema.bindings[0], native="ontop", domain="omnigibson")
    other = dataclasses.replace(schema, bindings=(*schema.bindings, mine))
    behavior = text.replace("robosuite", "omnigibson")
    with pytest.raises(OntoError, match="`Stacked` of the domain `omnigibson` has no binding"):
        lift(parse(behavior), other, "task")
    spec = parse(behavior.replace("Stacked", "ontop").replace("(not (On", "(not (ontop"))
    abox, warnings = lift(spec, other, "task")
    assert [str(fact) for fact in abox.facts] == ["stacked(bowl_1, plate_1)"]
    assert [str(fact) for fact in abox.premise] == ["not stacked(cup_1, plate_1)"]
    assert {each.code for each in warnings} == {"BDDL020"}  # the four initial facts that say On
    with pytest.raises(OntoError, match="`ontop` is not a predicate of the ontology"):
        lift(parse(text.replace("Stacked", "ontop")), other, "task")


def test_every_problem_of_a_goal_is_found(lifted):
    goal = "(And (Onn bowl_1 plat_1) (On bowl_1) (Open stove_1_cook_region) (Clean bowl_1) (On cup_3 bowl_2))"
    assert [code for code, _ in problems(lifted, goal)] == [
        "BDDL003",
        "BDDL010",
        "BDDL011",
        "BDDL012",
        "BDDL019",
        "BDDL010",
        "BDDL010",
    ]


def test_an_initial_fact_that_does_not_lift_is_a_warning(lifted):
    abox, warnings = lifted("(On bowl_1 plate_1)", init="(On bowl_1 plate_1) (Sparkles bowl_1) (On bowl_1 table_1)")
    assert [str(fact) for fact in abox.premise][4:] == ["stacked(bowl_1, plate_1)"]
    assert [(each.code, each.severity) for each in warnings] == [
        ("BDDL003", "warning"),
        ("BDDL012", "warning"),
        ("BDDL028", "warning"),  # the goal holds at the start
    ]


def test_an_unknown_name_suggests_the_nearest(lifted):
    with pytest.raises(OntoError) as caught:
        lifted("(On bowl1 stove_1_cook)")
    assert [each.hint for each in caught.value.problems] == [
        "did you mean `bowl_1`?",
        "did you mean `stove_1_cook_region`?",
    ]


def test_a_region_of_something_undeclared_is_an_error_where_it_is_used(schema):
    text = SCENE.replace("(corner (:target table_1))", "(corner (:target drainer_1))").replace("INIT", "")
    abox, warnings = lift(parse(text.replace("GOAL", "(On bowl_1 plate_1)")), schema, "task")
    assert [(each.code, each.severity) for each in warnings] == [("BDDL015", "info")]
    assert len(abox.facts) == 1
    with pytest.raises(OntoError) as caught:
        lift(parse(text.replace("GOAL", "(On bowl_1 drainer_1_corner)")), schema, "task")
    assert [(each.code, each.severity) for each in caught.value.problems] == [
        ("BDDL015", "info"),
        ("BDDL015", "error"),
    ]


def test_a_binding_that_breaks_its_predicates_signature_is_refused(schema):
    spec = parse(SCENE.replace("INIT", "").replace("GOAL", "(On bowl_1 plate_1)"))
    on = dataclasses.replace(schema.bindings[0], lifts=EX + "on")
    with pytest.raises(OntoError, match=r"BDDL012: `On` lifts to `Supported\(Object, Region\)`, which does not take"):
        lift(spec, dataclasses.replace(schema, bindings=(on,)), "task")


def test_lifting_twice_gives_the_same(task_file, schema):
    assert lift(parse_file(task_file), schema, "task") == lift(parse_file(task_file), schema, "task")


def test_every_libero_task_lifts(libero_files):
    compile_schema = pytest.importorskip("onto_compiler.compile_schema")
    schema = compile_schema.load_schema()
    seen = turned = 0
    for file in libero_files:
        spec = parse_file(file)
        abox, warnings = lift(spec, schema, file.stem)
        assert abox.facts
        assert len(abox.premise) == len(spec.init)
        # LIBERO-Goal's files place two regions on a drainer that they do not declare.
        assert all(each.severity == "info" for each in warnings if each.code == "BDDL015")
        found = {each.code for each in warnings}
        # Nine files of the study table turn a caddy's region that nobody starts on, and a book, which LIBERO ignores.
        assert found <= ({"BDDL015"} if file.parent.name == "libero_goal" else {"BDDL034"})
        turned += any(each.severity == "warning" for each in warnings)
        assert (file.parent.name == "libero_goal") == (found == {"BDDL015"})
        seen += 1
    assert (seen, turned) == (130, 9)


def test_the_binding_that_the_documentation_shows_lifts_a_task_of_behavior(tmp_path):
    page = (Path(__file__).parents[3] / "docs/tasks.md").read_text("utf-8")
    (block,) = re.findall(r"```turtle\n(.*?)```", page, re.DOTALL)
    (tmp_path / "my.ttl").write_text(block, "utf-8")
    schema = load_schema(tmp_path / "my.ttl")
    text = """(define (problem p) (:domain omnigibson) (:objects a b - bowl.n.01 t - tray.n.01) (:init)
        (:goal (exists (?b - bowl.n.01) (ontop ?b ?t))))"""
    abox, _ = lift(parse(text), schema, "task")
    assert [str(fact) for fact in abox.facts] == ["on(a, t)", "on(b, t)"]
    assert abox.alternatives == ((0,), (1,))
