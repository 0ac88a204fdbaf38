"""Ill-formed shapes pass in no silence: each fault stands at its place, and the well-formed constraints run."""

from pathlib import Path

import pytest

from onto_compiler.check.data import check_data
from onto_compiler.command import FINDINGS
from tests.onto_compiler.check.test_data import run

CASES = Path(__file__).parent / "cases"
ONE_FAULT = {
    "s1": ("VOC011", 71, "did you mean `sh:minCount`?"),
    "s2": ("SHP002", 83, "sh:minCount must be a whole number"),
    "s3": ("SHP002", 83, "sh:datatype must be an IRI"),
    "s8": ("SHP002", 71, "sh:path has 2 values"),
    "s10": ("VOC011", 43, "did you mean `sh:property`?"),
    "s11": ("SHP002", 55, "sh:minCount stands in a node shape"),
    "s12": ("SHP002", 65, "sh:path must be a property path"),
    "s15": ("SHP002", 79, "sh:node must be a shape that the shapes graph describes"),
    "s16": ("SHP002", 83, "sh:severity must be an IRI"),
    "s20": ("SHP002", 65, "the query does not select $this"),
    "s24": ("SHP002", 83, "sh:maxCount must be a whole number"),
    "s25": ("SHP002", 85, "sh:uniqueLang must be true or false"),
    "s28": ("SHP002", 92, "sh:qualifiedMinCount stands without sh:qualifiedValueShape"),
}


def test_every_case_has_its_value():
    assert {path.stem for path in (CASES / "ill_formed").glob("s[0-9]*.ttl")} == ONE_FAULT.keys()


@pytest.mark.parametrize("name", ONE_FAULT)
def test_an_ill_formed_shape_is_a_problem_at_its_place(name):
    shapes, data = CASES / f"ill_formed/{name}.ttl", CASES / "ill_formed/data.ttl"
    problems = check_data([data], [shapes]).problems
    (fault,) = [problem for problem in problems if problem.code != "SHP001"]
    code, column, said = ONE_FAULT[name]
    assert (fault.code, fault.severity, fault.file, fault.line, fault.column) == (code, "error", str(shapes), 4, column)
    assert said in f"{fault.message} {fault.hint}"
    assert [problem.code for problem in problems if problem != fault] == ["SHP001"] * (name == "s16")
    assert run(data, "--shapes", shapes) == FINDINGS


def test_all_faults_of_all_shapes_are_told_at_once():
    problems = check_data([CASES / "ill_formed/several_data.ttl"], [CASES / "ill_formed/several_shapes.ttl"]).problems
    assert [(p.line, p.column, p.code) for p in problems] == [
        (5, 33, "VOC011"),
        (6, 45, "SHP002"),
        (7, 45, "SHP002"),
        (8, 17, "SHP002"),
        (9, 39, "SHP002"),
        (10, 44, "SHP002"),
        (11, 45, "VOC011"),
        (12, 42, "SHP002"),
        (13, 33, "SHP002"),
        (14, 33, "VOC011"),
        (14, 65, "SHP002"),
        (15, 5, "VOC011"),
        (16, 48, "SHP002"),
        (17, 55, "SHP002"),
    ]


def test_booleans_have_one_reading_and_a_string_is_none():
    problems = check_data([CASES / "booleans/data.ttl"], [CASES / "booleans/bool.ttl"]).problems
    assert [(p.code, Path(p.file).name, p.line, p.column) for p in problems] == [
        ("SHP002", "bool.ttl", 4, 75),
        ("SHP002", "bool.ttl", 6, 54),
        ("SHP002", "bool.ttl", 7, 89),
        ("SHP001", "data.ttl", 2, 1),
    ]
    assert "`v:U1`" in problems[-1].message  # S1 is not deactivated; S2 is


def test_constraints_see_what_the_rules_of_their_shapes_infer():
    assert check_data([CASES / "rules/data.ttl"], [CASES / "rules/shapes.ttl"]).problems == ()


@pytest.mark.parametrize(
    ("expression", "code", "said"),
    [
        (
            "[ sh:exists ex:age ; ] , [ ex:f ( sh:this ) ]",
            "SHP002",
            "the function <http://example.org/f> is not declared",
        ),
        ("[ ]", "SHP002", "a node expression is none that is known"),
        ("[ sh:exsts [ sh:path ex:age ] ]", "VOC011", "`sh:exsts` is no term"),
        ("[ sh:exists [ sh:path 3 ] ]", "SHP002", "the sh:path of a node expression is no property path"),
        ("[ sh:exists [ sh:filterShape ex:None ] ]", "SHP002", "sh:filterShape must be a shape"),
        ("[ sh:exists [ sh:filterShape [ sh:minLength -1 ] ] ]", "SHP002", "sh:minLength must be a whole number"),
        ("[ sh:union ( ex:a ) ; sh:union ( ex:b ) ] , [ sh:count [ ] ]", "SHP002", "a node expression is none"),
    ],
)
def test_an_ill_formed_expression_is_left_out_and_no_other_constraint(tmp_path, expression, code, said):
    prefixes = "@prefix ex: <http://example.org/> .\n@prefix sh: <http://www.w3.org/ns/shacl#> .\n"
    shapes, data = tmp_path / "shapes.ttl", tmp_path / "data.ttl"
    data.write_text(prefixes + "ex:a a ex:T .\n")
    sound = "sh:property [ sh:path ex:name ; sh:minCount 1 ] ; sh:expression [ sh:exists [ sh:path ex:name ] ]"
    shapes.write_text(
        f"{prefixes}ex:S a sh:NodeShape ; sh:targetClass ex:T ; {sound} ;\nsh:expression {expression} .\n"
    )
    problems = check_data([data], [shapes]).problems
    (fault,) = [problem for problem in problems if problem.code != "SHP001"]
    assert (fault.code, fault.line) == (code, 4)
    assert said in fault.message
    said_of_data = [problem.message.partition(": ")[2] for problem in problems if problem != fault]
    assert {"`ex:name` must have at least 1 value", "must make an expression true"} <= set(said_of_data)
