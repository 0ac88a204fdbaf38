"""What the parser reads, and where it says that it stands."""

from __future__ import annotations

import random
import re

import pytest

from onto_compiler.bddl import format_task, lift, parse, parse_file
from onto_compiler.bddl.ast import And, Atom, Declaration, Not, Or, Region, Symbol, atoms
from onto_compiler.problems import OntoError

HEAD = "(define (problem P) (:domain robosuite) (:language lift it) "


def task(rest: str):
    return parse(f"{HEAD}{rest})")


def test_a_task_file_reads_into_its_parts(task_file):
    spec = parse_file(task_file)
    assert (spec.problem, spec.domain) == ("LIBERO_Tabletop_Manipulation", "robosuite")
    assert spec.language == "put the bowl on the stove and open the middle drawer"
    assert spec.file == str(task_file)
    assert spec.objects == (
        Declaration("akita_black_bowl_1", "akita_black_bowl"),
        Declaration("plate_1", "plate"),
        Declaration("plate_2", "plate"),
    )
    assert [each.category for each in spec.fixtures] == ["table", "wooden_cabinet", "flat_stove"]
    assert spec.regions[0] == Region(
        "bowl_region", Symbol("main_table"), ranges=((-0.1, -0.01, -0.08, 0.01),), rgba=(0.0, 0.0, 1.0, 0.5)
    )
    assert [region.site for region in spec.regions[2:]] == [
        "wooden_cabinet_1_middle_region",
        "flat_stove_1_cook_region",
    ]
    assert spec.interest == (Symbol("akita_black_bowl_1"), Symbol("flat_stove_1"))
    assert spec.init[1] == Atom("On", (Symbol("plate_1"), Symbol("main_table_plate_region")))
    assert spec.goal == And(
        (
            Atom("On", (Symbol("akita_black_bowl_1"), Symbol("flat_stove_1_cook_region"))),
            Atom("Open", (Symbol("wooden_cabinet_1_middle_region"),)),
        )
    )


def test_an_atom_and_each_argument_know_their_place(task_file):
    lines = task_file.read_text("utf-8").splitlines()

    def at(span):
        assert span.line == span.end_line
        return lines[span.line - 1][span.column - 1 : span.end_column - 1]

    spec = parse_file(task_file)
    for atom in (*spec.init, *atoms(spec.goal)):
        assert at(atom.span) == str(atom)
        assert at(atom.name_span) == atom.predicate
        assert [at(symbol.span) for symbol in atom.arguments] == [symbol.name for symbol in atom.arguments]
    assert [at(each.span) for each in spec.declarations] == [each.name for each in spec.declarations]
    assert {atom.span.file for atom in spec.init} == {str(task_file)}


def test_sections_stand_in_any_order():
    forwards = task("(:objects a b - cup) (:init (On a b)) (:goal (On b a))")
    backwards = parse(
        "(define (:goal (On b a)) (:init (On a b)) (:objects a b - cup) (:language lift it) (:domain robosuite) "
        "(problem P))"
    )
    assert forwards == backwards


def test_keywords_and_names_are_read_without_regard_to_case():
    lower = task("(:objects cup_1 - cup) (:init) (:goal (and (not (On cup_1 cup_1))))")
    upper = task("(:OBJECTS Cup_1 - Cup) (:Init) (:GOAL (AND (Not (On CUP_1 cup_1))))")
    assert lower == upper


def test_a_predicate_may_begin_with_a_connective():
    assert task("(:init) (:goal (Andante a))").goal == Atom("Andante", (Symbol("a"),))
    assert task("(:init) (:goal (Notched or))").goal == Atom("Notched", (Symbol("or"),))


def test_formulas_nest():
    a, b = Atom("Open", (Symbol("a"),)), Atom("Open", (Symbol("b"),))
    goal = task("(:init) (:goal (Or (And (Open a) (Open b)) (Not (Open a))))").goal
    assert goal == Or((And((a, b)), Not(a)))
    assert atoms(goal) == (a, b, a)


def test_a_comment_ends_with_its_line():
    spec = parse(
        "(define ; (\n(problem P) (:domain robosuite) (:language lift;(the cup)\nit) (:init);)\n(:goal (Open a)))"
    )
    assert spec.language == "lift it"


@pytest.mark.parametrize(
    ("written", "read"),
    [
        ("Lift   it,\n  to  the left-hand side!", "Lift it, to the left-hand side!"),
        ("the cabinet\u2019s drawer", "the cabinet\u2019s drawer"),
        (":init and or not - 0.5", ":init and or not - 0.5"),
        ("", ""),
    ],
)
def test_an_instruction_holds_anything_but_parentheses(written, read):
    spec = parse(f"(define (problem P) (:domain robosuite) (:language {written}) (:init) (:goal (Open a)))")
    assert spec.language == read


def test_names_without_a_category_are_objects_or_fixtures():
    spec = task("(:fixtures f - stove g) (:objects a - cup b c) (:init) (:goal (Open a))")
    assert [each.category for each in spec.fixtures] == ["stove", "fixture"]
    assert [each.category for each in spec.objects] == ["cup", "object", "object"]


def test_a_region_may_have_many_rectangles_and_a_colour():
    spec = task(
        "(:regions (r (:target t) (:ranges ((0 0 1 1) (-1 +2 .5 1e-3))) (:rgba (0 0 1 0.5)))) (:init) (:goal (Open a))"
    )
    assert spec.regions == (Region("r", Symbol("t"), ranges=((0, 0, 1, 1), (-1, 2, 0.5, 0.001)), rgba=(0, 0, 1, 0.5)),)


def test_line_ends_of_other_systems_count_as_one(task_file):
    text = task_file.read_text("utf-8")
    spec = parse(text.replace("\n", "\r\n"))
    assert spec == parse(text)
    assert spec.init[1].span.line == parse(text).init[1].span.line


@pytest.mark.parametrize("number", ["nan", "inf", "1_000", "0x1", "1e", "--1", "1.2.3"])
def test_only_decimal_numbers_are_numbers(number):
    with pytest.raises(OntoError, match="is not a number"):
        task(f"(:regions (r (:target t) (:ranges ((0 0 1 {number}))))) (:init) (:goal (Open a))")


def test_all_problems_of_a_file_are_found_in_one_reading():
    with pytest.raises(OntoError) as caught:
        parse(
            "(define (problem P)\n(:domain robosuite)\n(:regions (r (:target t) (:ranges ((0 0 1)))))\n"
            "(:objects a a - cup)\n(:init (On (a) b) (On a :b))\n(:gaol (Open a)))"
        )
    assert [(each.code, each.line) for each in caught.value.problems] == [
        ("BDDL005", 1),  # no language
        ("BDDL009", 3),
        ("BDDL007", 4),
        ("BDDL001", 5),
        ("BDDL001", 5),
        ("BDDL001", 6),
    ]


@pytest.mark.parametrize("cut", range(1, 40))
def test_a_file_cut_off_anywhere_is_reported_as_unbalanced(cut, task_file):
    text = task_file.read_text("utf-8")
    with pytest.raises(OntoError) as caught:
        parse(text[: len(text) * cut // 40])
    assert [each.code for each in caught.value.problems] == ["BDDL002"]


EXTRAS = [
    "(",
    ")",
    ":init",
    ":goal",
    "-",
    "and",
    "or",
    "not",
    "(:target x)",
    "\ufeff",
    "\u00e9",
    "\r",
    ";",
    "0",
    "\x00",
]


def damaged(text: str, rng: random.Random) -> str:
    """``text`` with one to four of its tokens removed, replaced or joined by others."""
    tokens = re.findall(r"[()]|[^\s()]+|\s+", text)
    for _ in range(rng.randint(1, 4)):
        place = rng.randrange(len(tokens))
        keep = tokens[place] if rng.random() < 0.3 else ""
        tokens[place] = keep + rng.choice(["", rng.choice(tokens), rng.choice(EXTRAS)])
    return "".join(tokens)


@pytest.mark.parametrize("seed", range(10))
def test_a_damaged_file_is_read_or_reported_and_nothing_else(seed, task_file, schema):
    rng = random.Random(seed)  # noqa: S311 - damage needs no secrecy
    text = task_file.read_text("utf-8")
    reported = []
    for _ in range(50):
        try:
            spec = parse(damaged(text, rng))
            assert parse(format_task(spec)) == spec
            lift(spec, schema, "task")
        except OntoError as error:
            reported.append(error.problems)
    assert 0 < len(reported) < 50
    assert all(each.line > 0 and each.column > 0 for problems in reported for each in problems)
