"""Rules (`sh:rule`) of shapes run before their constraints, as pySHACL's advanced features have it."""

from __future__ import annotations

import pyshacl
import pytest

from onto_compiler.check.data import check_data

PREFIXES = (
    "@prefix sh: <http://www.w3.org/ns/shacl#> . @prefix ex: <http://example.org/> .\n"
    "@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .\n"
)
DATA = f"{PREFIXES}ex:a a ex:T ; ex:p 1 . ex:b a ex:T ."
MADE = "a sh:TripleRule ; sh:subject sh:this ; sh:predicate ex:q ; sh:object 1"
RULES = {
    "triple": f"sh:rule [ {MADE} ]",
    "sparql": 'sh:rule [ a sh:SPARQLRule ; sh:construct "CONSTRUCT { $this <http://example.org/q> 1 } WHERE {}" ]',
    "condition": f"sh:rule [ {MADE} ; sh:condition [ a sh:PropertyShape ; sh:path ex:p ; sh:minCount 1 ] ]",
    "condition of a node": f"sh:rule [ {MADE} ; sh:condition ex:HasP ]",
    "deactivated": f"sh:rule [ {MADE} ; sh:deactivated true ]",
    "order": f"""sh:rule [ {MADE} ; sh:order 2 ; sh:condition [ a sh:PropertyShape ; sh:path ex:r ; sh:minCount 1 ] ] ;
    sh:rule [ a sh:TripleRule ; sh:subject sh:this ; sh:predicate ex:r ; sh:object 1 ; sh:order 1 ]""",
    "order the other way": f"""sh:rule [ {MADE} ; sh:order 1 ;
        sh:condition [ a sh:PropertyShape ; sh:path ex:r ; sh:minCount 1 ] ] ;
    sh:rule [ a sh:TripleRule ; sh:subject sh:this ; sh:predicate ex:r ; sh:object 1 ; sh:order 2 ]""",
    "none": "sh:nodeKind sh:IRI",
}


def problems(tmp_path, shapes):
    (tmp_path / "data.ttl").write_text(DATA)
    (tmp_path / "shapes.ttl").write_text(PREFIXES + shapes)
    return check_data([tmp_path / "data.ttl"], [tmp_path / "shapes.ttl"])


@pytest.mark.parametrize("count", ["sh:minCount 1", "sh:maxCount 0"])
@pytest.mark.parametrize("rule", RULES)
def test_constraints_see_what_rules_conclude(tmp_path, rule, count):
    shapes = f"""ex:S a sh:NodeShape ; sh:targetClass ex:T ; {RULES[rule]} ; sh:property [ sh:path ex:q ; {count} ] .
ex:HasP a sh:NodeShape ; sh:property [ sh:path ex:p ; sh:minCount 1 ] ."""
    report = problems(tmp_path, shapes)
    conforms, graph, _ = pyshacl.validate(
        DATA, shacl_graph=PREFIXES + shapes, data_graph_format="turtle", shacl_graph_format="turtle", advanced=True
    )
    found = sorted(str(focus) for focus in graph.objects(None, pyshacl.consts.SH_focusNode))
    focus = [problem.result["focusNode"]["value"] for problem in report.problems]
    assert (not report.problems, sorted(focus)) == (conforms, found)
    assert report.triples == 3


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        ("[ a sh:TripleRule ; sh:subject sh:this ; sh:predicate ex:q ]", "a sh:TripleRule has no sh:object"),
        ('[ a sh:SPARQLRule ; sh:construct "SELECT * {}" ]', "of the form SELECT, not CONSTRUCT"),
        ("[ sh:order 1 ]", "neither a sh:TripleRule nor a sh:SPARQLRule"),
    ],
)
def test_a_rule_that_cannot_run_is_a_problem_and_the_constraints_still_run(tmp_path, rule, message):
    shapes = (
        f"ex:S a sh:NodeShape ; sh:targetNode ex:b ; sh:rule {rule} ; sh:property [ sh:path ex:p ; sh:minCount 1 ] ."
    )
    report = problems(tmp_path, shapes)
    assert {problem.code for problem in report.problems} == {"SHP001", "SHP002"}
    (fault,) = [problem for problem in report.problems if problem.code == "SHP002"]
    assert message in fault.message
    assert (fault.file, fault.line) == (str(tmp_path / "shapes.ttl"), 3)


def test_every_rule_that_cannot_run_is_told_and_the_others_run(tmp_path):
    shapes = f"""ex:S a sh:NodeShape ; sh:targetNode ex:b ; sh:property [ sh:path ex:q ; sh:minCount 1 ] ;
    sh:rule [ a sh:TripleRule ; sh:subject sh:this ; sh:predicate ex:q ] ,
        [ sh:order 1 ] ,
        [ {MADE} ] ,
        [ {MADE} ; sh:condition ex:Nothing ] ,
        [ {MADE} ; sh:deactivated "true" ] ."""
    found = [(problem.code, problem.line) for problem in problems(tmp_path, shapes).problems]
    assert found == [("SHP002", line) for line in (4, 5, 7, 8)]


def test_a_rule_rests_on_no_condition_that_is_ill_formed(tmp_path):
    shapes = f"""ex:S a sh:NodeShape ; sh:targetNode ex:b ; sh:property [ sh:path ex:q ; sh:maxCount 0 ] ;
    sh:rule [ {MADE} ; sh:condition ex:C ] . ex:C a sh:NodeShape ; sh:class "ex:T" ."""
    assert [(problem.code, problem.line) for problem in problems(tmp_path, shapes).problems] == [("SHP002", 4)]
