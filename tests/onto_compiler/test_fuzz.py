"""Damaged files give problems with a place, never a traceback; what no person writes is refused."""

import random

import pytest

from benchmarks.fuzz import HANG_S, Outcome, metrics, put_through, run
from benchmarks.fuzz_inputs import ENCODINGS, MUTATIONS, FuzzInput, fuzz_input, past_the_lexer
from benchmarks.fuzz_seeds import BDDL, SUITES, TURTLE, parts, seeds, split
from onto_compiler.bddl import parse
from onto_compiler.problems import OntoError
from onto_compiler.sources import LARGE, MANY
from onto_compiler.turtle.limits import MAX_DEPTH, MAX_LITERAL
from onto_compiler.turtle.source_map import map_text
from onto_compiler.turtle.tokens import tokens

pytestmark = pytest.mark.sim  # LIBERO's task files are seeds

INPUTS = 600
LONG = 20_000
TASK = "(define (problem p) (:domain robosuite) (:language x) {} (:init) (:goal (On a b)))"


def outcome_of(text, language, tmp_path) -> Outcome:
    data = text.encode("utf-8", errors="surrogatepass")
    return put_through(FuzzInput(0, language, "", (), data), tmp_path, whole=language == TURTLE)


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fuzz")
    inputs = [fuzz_input(number) for number in range(INPUTS)]
    return [(one, put_through(one, folder, whole=one.number % 40 == 1)) for one in inputs]


def test_seeds_are_liberos_tasks_and_every_example_of_ours():
    assert len(seeds(BDDL)) >= sum(SUITES.values()) + 2 + 79
    assert len(seeds(TURTLE)) >= 118
    assert {seed.language for seed in seeds(BDDL)} == {BDDL}


@pytest.mark.parametrize("language", [BDDL, TURTLE])
def test_pieces_join_to_the_seed_and_parts_lie_within(language):
    for seed in seeds(language):
        text = "".join(seed.pieces)
        assert split(text, language) == seed.pieces
        found = parts(list(seed.pieces), language)
        assert all(0 <= begin < end <= len(seed.pieces) for begin, end in found)


def test_damaged_files_give_problems_and_never_a_traceback(outcomes):
    assert len(outcomes) == INPUTS
    assert [(one.number, each.fault, each.detail) for one, each in outcomes if each.fault] == []
    assert all(problem.line >= 1 for _, each in outcomes for problem in each.problems)
    assert sum(len(each.problems) for _, each in outcomes) > INPUTS


def test_at_least_three_in_ten_get_past_the_lexer(outcomes):
    for language in (BDDL, TURTLE):
        passed = [each.past_lexer for one, each in outcomes if one.language == language]
        assert len(passed) == INPUTS // 2
        assert 0.3 < sum(passed) / len(passed) < 1


def test_every_mutation_is_drawn_and_most_inputs_differ_from_their_seed(outcomes):
    drawn = {name for one, _ in outcomes for name in one.how}
    assert drawn == set(MUTATIONS) | set(ENCODINGS)
    assert len({one.data for one, _ in outcomes}) > 0.95 * INPUTS


def test_a_number_always_gives_the_same_bytes():
    random.seed(1)
    first = [fuzz_input(number).data for number in range(40)]
    random.seed(2)
    assert [fuzz_input(number).data for number in range(40)] == first


@pytest.mark.parametrize(
    ("data", "language", "passes"),
    [
        (b"(define)", BDDL, True),
        (b"(define ; )\n)", BDDL, True),
        (b"(define", BDDL, False),
        (b")(", BDDL, False),
        (b"(\xff)", BDDL, False),
        (b"\xef\xbb\xbf()", BDDL, False),
        (b"<a> a <b>, 'c'@en .", TURTLE, True),
        (b"\xef\xbb\xbf<a> a <b> .", TURTLE, True),
        (b"<a> a 'b .", TURTLE, False),
        (b"<a> is <b> .", TURTLE, False),
        (b"<a> a ?b .", TURTLE, False),
        (b"{}", TURTLE, False),
    ],
)
def test_what_gets_past_the_lexer(data, language, passes):
    assert past_the_lexer(data, language) is passes


def test_a_fault_of_ours_is_counted_and_shown(monkeypatch, tmp_path):
    def broken(path):
        raise ZeroDivisionError(path.name)

    monkeypatch.setattr("benchmarks.fuzz.parse_file", broken)
    outcome = outcome_of("(define)", BDDL, tmp_path)
    assert (outcome.fault, outcome.problems) == ("traceback", ())
    assert outcome.detail.startswith("ZeroDivisionError: input.bddl")
    (row,) = run({"key": "0", "first": 0, "last": 3})
    assert (row["traceback"], row["offender"]["number"], row["inputs"]) == (2, 0, 4)
    assert metrics([{**row, "seconds": 1.0}])["tracebacks"] == 2


def test_an_input_that_takes_too_long_is_a_hang(monkeypatch, tmp_path):
    def endless(_path):
        while True:
            pass

    monkeypatch.setattr("benchmarks.fuzz.parse_file", endless)
    monkeypatch.setattr("benchmarks.fuzz.HANG_S", 0.05)
    outcome = outcome_of("(define)", BDDL, tmp_path)
    assert outcome.fault == "hang"
    assert outcome.seconds < HANG_S


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (TASK.format("(:objects a" + " b" * 40_000 + " - c)"), "at most 65,536 are read"),
        (TASK.format("(:objects " + "a" * 1025 + " - c)"), "a word of 1,025 characters"),
        (TASK.format("(" * LONG + ")" * LONG), "nested more than 64 deep"),
        (TASK.format("(:regions (r (:target t) (:ranges ((0 0 1 1e999)))))"), "`1e999` is not a number"),
    ],
)
def test_bddl_that_no_person_writes_is_refused(text, says):
    with pytest.raises(OntoError) as caught:
        parse(text)
    assert says in caught.value.problems[0].message
    assert caught.value.problems[0].line == 1


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("<a:a> <a:b> " + "[ <a:b> " * LONG + "1" + "]" * LONG + " .", "nested more than 100 deep"),
        ("<a:a> <a:b> " + "(" * LONG + ")" * LONG + " .", "nested more than 100 deep"),
        ("\n<a:a> <a:b> '" + "x" * MAX_LITERAL + "x' .", "a literal of 1,048,577 characters"),
    ],
)
def test_turtle_that_no_person_writes_is_refused(text, says, tmp_path):
    outcome = outcome_of(text, TURTLE, tmp_path)
    assert outcome.fault == ""
    assert {problem.code for problem in outcome.problems} == {"TTL009"}
    assert says in outcome.problems[0].message


def test_the_limits_of_turtle_are_not_met_below_them(tmp_path):
    assert (MANY, LARGE) == (MAX_DEPTH, MAX_LITERAL)
    text = (
        "<a:a> <a:b> "
        + "( " * (MAX_DEPTH - 1)
        + "'((((' # ((((\n"
        + ")" * (MAX_DEPTH - 1)
        + ", "
        + "[]," * 200
        + " 1 ."
    )
    assert "TTL009" not in {problem.code for problem in outcome_of(text, TURTLE, tmp_path).problems}
    assert len(map_text(text, "file", "a:a").triples) == 2 * (MAX_DEPTH - 1) + 202
    long = "<a:a> <a:b> '" + "x" * MAX_LITERAL + "' ."
    assert "TTL009" not in {problem.code for problem in outcome_of(long, TURTLE, tmp_path).problems}


@pytest.mark.parametrize(
    "text", ["é", "a.", "a-", "é.", "a:", "a:.", '\\"', "'", '"', "<", "_:a.", "@a-", "1.", "ex:a.", '"""', "\\'''"]
)
def test_the_scanner_reads_a_long_run_in_linear_time(text):
    """Twenty thousand pieces would take minutes if each were read from every other."""
    outcome = list(tokens(text * LONG))
    assert outcome
    assert len(outcome) <= 2 * LONG


def test_many_syntax_errors_are_told_until_enough_was_read_again():
    with pytest.raises(OntoError) as caught:
        parse(TASK.format("(:bad) " * 2_000))
    assert 10 < len(caught.value.problems) < 2_000
    assert {problem.code for problem in caught.value.problems} == {"BDDL001"}


def test_a_long_chain_of_classes_is_checked_before_the_alarm(tmp_path):
    """A query that joins every class with every class above it takes five seconds for these."""
    prefixes = (
        "@prefix owl: <http://www.w3.org/2002/07/owl#> .\n@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .\n"
    )
    chain = "".join(f"<a:c{n}> a owl:Class ; rdfs:subClassOf <a:c{n + 1}> .\n" for n in range(150))
    contradiction = "<a:d> a owl:Class ; owl:disjointWith <a:c150> .\n<a:i> a <a:c0> , <a:d> .\n"
    outcome = outcome_of(prefixes + chain + contradiction, TURTLE, tmp_path)
    assert (outcome.fault, outcome.checked) == ("", True)
    assert {problem.code for problem in outcome.problems if problem.severity == "error"} == {"OWL005"}
