"""Each broken file is reported at the place where a person would mend it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from onto_compiler.bddl import lift, parse_file
from onto_compiler.bddl.codes import ALL_CODES
from onto_compiler.problems import OntoError, Problem

FOLDER = Path(__file__).parent / "broken"
PAGES = Path(__file__).parents[3] / "docs" / "errors"
# file: code, line, column of the first problem, how many problems there are, and a piece of its message or hint
EXPECTED = {
    "arguments_swapped": ("BDDL012", 46, 11, 1, "it takes `On(Object, Object)` or `On(Object, Area)`"),
    "attribute_twice": ("BDDL006", 20, 7, 1, "keep one"),
    "attribute_without_parentheses": ("BDDL001", 19, 7, 1, "expected an attribute such as `(:target main_table)`"),
    "backslash_left_over": ("BDDL032", 6, 4, 4, "readers pass over it; remove it"),
    "bare_fact": ("BDDL001", 41, 5, 1, "each fact stands in parentheses of its own"),
    "byte_order_mark": ("BDDL004", 1, 1, 1, "save it as UTF-8 without one; LIBERO cannot read it"),
    "category_in_two_lists": ("BDDL017", 32, 5, 1, "write them as one list before `- plate`"),
    "count_of_words": ("BDDL008", 47, 14, 1, "write a whole number up to 10,000"),
    "decimal_comma": ("BDDL008", 13, 18, 1, "write `0.04`, with a point"),
    "empty_file": ("BDDL001", 1, 1, 1, "expected `(define ...)`, found the end of the file"),
    "empty_goal_section": (
        "BDDL001",
        45,
        3,
        1,
        "expected a formula such as `(On plate_1 flat_stove_1_cook_region)`, found `)`",
    ),
    "every_way_contradicts": ("BDDL024", 45, 5, 1, "each asks for a fact and for its absence"),
    "file_name_in_language": ("BDDL029", 3, 14, 1, "a piece of a file's name: `KITCHEN_SCENE3`"),
    "goal_at_the_start": ("BDDL028", 45, 5, 1, "ask for what is not there yet"),
    "goal_of_nothing": ("BDDL018", 45, 5, 1, "name the facts that must hold"),
    "goal_twice": ("BDDL031", 47, 7, 1, "the first time on line 46; remove one of the two"),
    "imply_of_one": ("BDDL001", 47, 51, 1, "(imply ...) takes two formulas"),
    "latin_1": ("BDDL004", 3, 25, 1, "save the file with the encoding UTF-8"),
    "long_word": ("BDDL033", 31, 21, 1, "a word of 1,106 characters; at most 1,024 are read; shorten it"),
    "missing_category": ("BDDL001", 27, 3, 1, "expected a category, found `)`"),
    "misspelt_attribute": ("BDDL001", 16, 8, 1, "did you mean `:target`?"),
    "misspelt_section": ("BDDL001", 39, 4, 1, "did you mean `:init`?"),
    "more_than_there_are": ("BDDL021", 47, 7, 1, "declare more instances, or ask for fewer"),
    "negated_goal_at_the_start": ("BDDL028", 45, 5, 1, "the goal holds at the start"),
    "nested_fact": ("BDDL001", 41, 17, 1, "expected a name or `)`, found `(`"),
    "never_placed": ("BDDL030", 31, 13, 1, "say where it is, as in `(On plate_2 ...)`, or remove it"),
    "no_binding": ("BDDL020", 40, 6, 4, 'core:native "ontop" and core:nativeDomain "omnigibson"'),
    "no_goal": ("BDDL005", 1, 1, 1, "the task has no `(:goal ...)` section"),
    "no_grounding": ("BDDL019", 47, 8, 1, "declare a binding for it, or name its grounding function in the TBox"),
    "no_language": ("BDDL005", 1, 1, 1, "the task has no `(:language ...)` section"),
    "no_threshold": ("BDDL013", 47, 15, 1, "declare one for the category in the TBox"),
    "not_a_task": ("BDDL001", 1, 2, 1, "expected `define`, found `domain`"),
    "not_of_two": ("BDDL001", 45, 31, 1, "(Not ...) takes one formula"),
    "object_named_as_fixture": ("BDDL007", 31, 13, 1, "number the instances: `plate_1`, `plate_2`"),
    "object_twice": ("BDDL007", 31, 13, 1, "number the instances: `plate_1`, `plate_2`"),
    "on_and_not_on": ("BDDL024", 47, 12, 1, "must and must not hold (line 46); remove one of the two"),
    "on_each_other": ("BDDL026", 47, 7, 1, "by way of what else the goal asks for"),
    "on_itself": ("BDDL026", 46, 7, 1, "puts `akita_black_bowl_1` on or in itself"),
    "on_two_supports": (
        "BDDL025",
        47,
        7,
        1,
        "have to rest on `plate_1` and `flat_stove_1_cook_region` (line 46)",
    ),
    "only_a_comment": ("BDDL001", 2, 1, 1, "expected `(define ...)`, found the end of the file"),
    "open_a_plate": ("BDDL012", 47, 13, 1, "`Open(Drawer)`; nothing says which class a `plate` is of"),
    "open_and_closed": ("BDDL027", 48, 7, 1, "exclude each other; remove one of the two"),
    "opening_parenthesis_in_a_comment": ("BDDL002", 42, 3, 1, "the `(` at 39:5 stands in a comment"),
    "other_domain": ("BDDL016", 2, 12, 1, "write (:domain robosuite)"),
    "parenthesis_in_a_comment": ("BDDL002", 40, 5, 1, "the `)` at 40:64 stands in a comment; write the `)` before"),
    "parenthesis_in_language": ("BDDL001", 3, 22, 1, "the instruction may hold anything but parentheses"),
    "pi_for_a_number": ("BDDL008", 9, 28, 1, "write the value in radians, such as `3.141592653589793`"),
    "problem_without_name": ("BDDL001", 1, 17, 1, "expected the name of the problem, found `)`"),
    "prompt_in_language": ("BDDL029", 3, 14, 1, "announces instructions: `Here are 20 variations of the instruction`"),
    "quantifier_over_nothing": ("BDDL021", 47, 16, 1, "no `cup` is declared, so `?cup` stands for nothing"),
    "rectangle_of_three": ("BDDL009", 13, 17, 1, "write (x0 y0 x1 y1)"),
    "rectangle_without_list": ("BDDL001", 13, 17, 1, "each rectangle or pair of bounds has its own parentheses"),
    "region_of_nothing": ("BDDL015", 19, 16, 2, "did you mean `flat_stove_1`?"),
    "region_twice": ("BDDL007", 11, 6, 1, "`main_table_bowl_region` is declared twice"),
    "region_without_its_target": ("BDDL010", 46, 30, 1, "did you mean `flat_stove_1_cook_region`?"),
    "region_without_target": ("BDDL005", 18, 6, 1, "name the fixture or object that the region is part of"),
    "rotation_of_an_object": ("BDDL034", 9, 7, 1, "only a fixture that `:init` puts on the region is turned by it"),
    "section_twice": ("BDDL006", 44, 3, 1, "join the two into one"),
    "surplus_at_the_end": ("BDDL002", 50, 2, 1, "remove it, or add the `(` that it should close"),
    "surplus_parenthesis": ("BDDL002", 32, 4, 1, "remove it, or add the `(` that it should close"),
    "text_after_the_task": ("BDDL001", 51, 1, 1, "expected the end of the file, found `(`"),
    "too_deep": ("BDDL001", 2, 311, 1, "parentheses are nested more than 64 deep"),
    "too_few_arguments": ("BDDL011", 46, 7, 1, "write `On(Object, Object)`"),
    "too_many_alternatives": ("BDDL014", 47, 7, 1, "the goal has more than 1,024 alternatives"),
    "too_many_arguments": ("BDDL011", 47, 7, 1, "write `Open(Drawer)`"),
    "two_goal_formulas": ("BDDL001", 46, 5, 1, "a goal is one formula: join several with (And ...)"),
    "two_syntax_errors": ("BDDL001", 16, 8, 2, "did you mean `:target`?"),
    "unbound_variable": ("BDDL022", 47, 36, 1, "did you mean `?plate`?"),
    "unclosed_fact": ("BDDL002", 40, 5, 1, "`(On` is never closed; add the missing `)`"),
    "unclosed_goal": ("BDDL002", 1, 1, 1, "`(define` is never closed; add the missing `)`"),
    "unclosed_region": ("BDDL002", 11, 5, 1, "`(plate_region` is never closed; add the missing `)`"),
    "unclosed_section": ("BDDL002", 23, 3, 1, "`(:fixtures` is never closed; add the missing `)`"),
    "unknown_interest": ("BDDL010", 36, 5, 1, "did you mean `flat_stove_1`?"),
    "unknown_object": ("BDDL010", 46, 11, 1, "did you mean `akita_black_bowl_1`?"),
    "unknown_object_at_the_start": ("BDDL010", 41, 9, 1, "did you mean `plate_2`?"),
    "unknown_predicate": ("BDDL003", 46, 8, 1, "did you mean `On`?"),
    "unknown_predicate_far": (
        "BDDL003",
        47,
        8,
        1,
        "predicates are `Close`, `On`, `Open`, `Supported`, `Touching`, `Turnon`",
    ),
    "unknown_region": ("BDDL010", 46, 30, 1, "did you mean `flat_stove_1_cook_region`?"),
    "variable_without_category": ("BDDL001", 47, 22, 1, "expected `- category`, found `)`"),
    "variable_without_parentheses": ("BDDL001", 47, 15, 1, "write (exists (?x - category) formula)"),
    "without_end": ("BDDL023", 47, 16, 1, "number the instances instead of declaring them with `*`"),
    "word_for_a_number": ("BDDL008", 13, 23, 1, "write a decimal number such as `0.05`"),
    "yaw_of_one": ("BDDL009", 9, 23, 1, "write (min max)"),
}


def problems_of(path, schema) -> tuple[Problem, ...]:
    try:
        return lift(parse_file(path), schema, "task")[1]
    except OntoError as error:
        return error.problems


@pytest.mark.parametrize("name", EXPECTED)
def test_a_broken_file_is_reported_where_it_is_broken(name, schema):
    code, line, column, count, says = EXPECTED[name]
    problems = problems_of(FOLDER / f"{name}.bddl", schema)
    first = problems[0]
    assert (first.code, first.line, first.column, len(problems)) == (code, line, column, count)
    assert says in f"{first.message}; {first.hint}"
    assert first.file == str(FOLDER / f"{name}.bddl")


def test_every_broken_file_is_in_the_table():
    assert sorted(path.stem for path in FOLDER.glob("*.bddl")) == sorted(EXPECTED)
    assert len(EXPECTED) == 83


def test_every_code_has_a_failing_file_and_a_page():
    assert {row[0] for row in EXPECTED.values()} == set(ALL_CODES)
    assert sorted(path.stem for path in PAGES.glob("BDDL*.md")) == sorted(ALL_CODES)


@pytest.mark.parametrize("code", ALL_CODES)
def test_a_page_says_what_why_and_what_instead(code):
    text = (PAGES / f"{code}.md").read_text("utf-8")
    assert re.match(rf"# {code}: [a-z][a-z -]+\n", text)
    headings = re.findall(r"^## (.+)$", text, flags=re.MULTILINE)
    assert headings == ["What it means", "Why it matters", "Example", "Use instead"]


def test_a_sound_file_has_no_problems(task_file, schema):
    assert problems_of(task_file, schema) == ()


def test_a_missing_file_is_reported_with_its_nearest_neighbour(task_file):
    with pytest.raises(OntoError) as caught:
        parse_file(task_file.with_name("stove_and_draw.bddl"))
    (problem,) = caught.value.problems
    assert problem.code == "BDDL004"
    assert "no such file" in problem.message
    assert problem.hint == "did you mean `stove_and_drawer.bddl`?"


def test_a_folder_is_not_a_task_file(tmp_path):
    with pytest.raises(OntoError, match="BDDL004: the task file cannot be read: is a directory"):
        parse_file(tmp_path)


@pytest.mark.parametrize("target", ["loop.bddl", "nothing.bddl"])
def test_a_link_that_leads_nowhere_is_not_taken_for_a_misspelt_name(tmp_path, target):
    link = tmp_path / "loop.bddl"
    link.symlink_to(tmp_path / target)
    with pytest.raises(OntoError) as caught:
        parse_file(link)
    (problem,) = caught.value.problems
    assert problem.code == "BDDL004"
    assert problem.hint == "`loop.bddl` is a link that leads to no file: correct the link, or give the file itself"
