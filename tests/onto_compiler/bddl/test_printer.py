"""Printing then parsing changes nothing, for us and for LIBERO's own reader."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from onto_compiler.bddl import format_task, parse, parse_file
from onto_compiler.bddl.ast import (
    And,
    Atom,
    Declaration,
    Imply,
    Not,
    Or,
    Quantified,
    Region,
    Symbol,
    TaskSpec,
    Variable,
)
from onto_compiler.bddl.sections import QUANTIFIERS

NAMES = st.from_regex(r"[a-z_][a-z0-9_.?-]{0,7}", fullmatch=True)
PREDICATES = st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,7}", fullmatch=True).filter(
    lambda name: name.lower() not in {"and", "or", "not", "imply"} | QUANTIFIERS
)
WORDS = st.text(st.characters(exclude_characters="();", exclude_categories=("C", "Z")), min_size=1, max_size=6)
NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
SYMBOLS = st.builds(Symbol, NAMES)
ATOMS = st.builds(Atom, PREDICATES, st.lists(SYMBOLS, max_size=3).map(tuple))
VARIABLES = st.builds(Variable, NAMES.map("?{}".format), NAMES)


def quantified(inner):
    one, two = (st.tuples(*[VARIABLES] * count) for count in (1, 2))
    numbers = st.integers(0, 10_000)
    return st.one_of(
        st.builds(Quantified, st.sampled_from(["forall", "exists"]), one, inner),
        st.builds(Quantified, st.just("forn"), one, inner, numbers),
        st.builds(Quantified, st.just("forpairs"), two, inner),
        st.builds(Quantified, st.just("fornpairs"), two, inner, numbers),
    )


FORMULAS = st.recursive(
    ATOMS,
    lambda inner: st.one_of(
        st.builds(And, st.lists(inner, max_size=3).map(tuple)),
        st.builds(Or, st.lists(inner, max_size=3).map(tuple)),
        st.builds(Not, inner),
        st.builds(Imply, inner, inner),
        quantified(inner),
    ),
    max_leaves=6,
)
REGIONS = st.builds(
    Region,
    NAMES,
    SYMBOLS,
    ranges=st.lists(st.tuples(*[NUMBERS] * 4), max_size=2).map(tuple),
    yaw=st.none() | st.tuples(NUMBERS, NUMBERS),
    rgba=st.none() | st.tuples(*[NUMBERS] * 4),
)


@st.composite
def specs(draw):
    names = draw(st.lists(NAMES, unique=True, max_size=8))
    declared = [Declaration(name, draw(NAMES)) for name in names]
    cut = draw(st.integers(0, len(declared)))
    regions = draw(st.lists(REGIONS, max_size=3, unique_by=lambda region: region.site))
    return TaskSpec(
        problem=draw(PREDICATES),
        domain=draw(NAMES | st.sampled_from(["robosuite", "igibson", "omnigibson"])),
        language=" ".join(draw(st.lists(WORDS, max_size=6))),
        regions=tuple(region for region in regions if region.site not in names),
        fixtures=tuple(declared[:cut]),
        objects=tuple(declared[cut:]),
        interest=tuple(draw(st.lists(SYMBOLS, max_size=3))),
        init=tuple(draw(st.lists(ATOMS, max_size=3))),
        absent=tuple(draw(st.lists(ATOMS, max_size=2))),
        goal=draw(FORMULAS),
        requirements=tuple(draw(st.lists(st.sampled_from([":strips", ":adl"]), max_size=2))),
        scene=tuple(draw(st.lists(st.tuples(st.sampled_from([":floor", ":wall"]), NAMES), max_size=2))),
    )


@settings(deadline=None)  # a busy machine is not a fault
@given(specs())
def test_any_task_prints_and_reads_back_equal(spec):
    text = format_task(spec)
    assert parse(text) == spec
    assert format_task(parse(text)) == text


def test_the_layout_is_canonical(task_file):
    text = task_file.read_text("utf-8")
    assert format_task(parse(f"; a comment\n{' '.join(text.split())}")) == format_task(parse(text))
    assert "    plate_1 plate_2 - plate\n" in format_task(parse(text))


def test_every_libero_task_reads_back_equal(libero_files):
    for file in libero_files:
        spec = parse_file(file)
        assert parse(format_task(spec)) == spec
    assert len(libero_files) == 130


@pytest.mark.sim
def test_libero_reads_the_printed_task_as_it_reads_the_original(libero_files, tmp_path):
    reader = pytest.importorskip("libero.libero.envs.bddl_utils").robosuite_parse_problem
    printed = tmp_path / "printed.bddl"
    for file in libero_files:
        printed.write_text(format_task(parse_file(file)), "utf-8")
        assert reader(str(printed)) == reader(str(file))
    assert len(libero_files) == 130


@pytest.mark.sim
def test_libero_and_we_read_the_same_things(libero_files):
    reader = pytest.importorskip("libero.libero.envs.bddl_utils").robosuite_parse_problem
    for file in libero_files:
        theirs, ours = reader(str(file)), parse_file(file)
        assert [region.site for region in ours.regions] == list(theirs["regions"])
        assert {each.name for each in ours.objects} == {name for names in theirs["objects"].values() for name in names}
        assert [[a.predicate.lower(), *map(str, a.arguments)] for a in ours.init] == theirs["initial_state"]
        assert ours.language.lower().split() == theirs["language_instruction"]
        assert ours.problem.lower() == theirs["problem_name"]
        for region in ours.regions:
            read = theirs["regions"][region.site]
            assert [list(rectangle) for rectangle in region.ranges] == read["ranges"]
            assert list(region.yaw or (0, 0)) == read["yaw_rotation"]
    assert len(libero_files) == 130
