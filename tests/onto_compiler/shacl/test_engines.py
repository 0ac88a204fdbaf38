"""What shapes mean that refer to shapes, call functions or have targets of their own, and what cannot run.

That generated shapes give what pySHACL gives is in ``tests/benchmarks/test_wild.py``.
"""

import random

import pytest
from pyoxigraph import RdfFormat, Triple, parse

from benchmarks.shacl_cases import corpus
from onto_compiler.problems import OntoError
from onto_compiler.shacl.compile import compile_graph
from onto_compiler.shacl.graph import Graph
from onto_compiler.shacl.validate import validate_graph

EX = "https://example.org/"
PREFIXES = """
@prefix ex: <https://example.org/> .
@prefix rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
"""


def graph_of(text):
    return Graph(parse(text.encode(), format=RdfFormat.TURTLE, base_iri=EX))


def results(data, shapes):
    return validate_graph(graph_of(PREFIXES + data), compile_graph(graph_of(PREFIXES + shapes)))


def test_a_shape_that_refers_to_itself_ends():
    shapes = (
        "ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:property [ sh:path ex:p ; sh:node ex:S ; sh:nodeKind sh:IRI ] ."
    )
    assert results("ex:a ex:p ex:b . ex:b ex:p ex:a .", shapes) == ()
    found = results("ex:a ex:p ex:b . ex:b ex:p ex:a , 3 .", shapes)
    assert [(str(r.value), r.component) for r in found] == [(f"<{EX}b>", "NodeConstraintComponent")]


def test_a_deactivated_shape_accepts_everything():
    shapes = """ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:node ex:T ; sh:property ex:P .
    ex:T a sh:NodeShape ; sh:nodeKind sh:Literal ; sh:deactivated true .
    ex:P sh:path ex:p ; sh:minCount 1 ; sh:deactivated true ."""
    assert results("", shapes) == ()


def test_severity_and_messages_come_from_the_shape():
    shapes = """ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:severity ex:Bad ;
        sh:message "Non"@fr , "no {$value}"@en ; sh:nodeKind sh:Literal ."""
    (found,) = results("", shapes)
    assert (found.severity, found.message) == (EX + "Bad", "no https://example.org/a")
    assert found.expected == "must be of the node kind `sh:Literal`"


@pytest.mark.parametrize(
    ("pattern", "flags", "value", "fits"),
    [
        ("^a$", "", "a", True),
        ("^a$", "", "a\\n", False),
        ("^a$", "m", "b\\na", True),
        ("A.B", "i", "a\\nb", False),
        ("A.B", "is", "a\\nb", True),
        ("a.b", "q", "axb", False),
        ("a b", "x", "ab", True),
        ("^\\\\p{Lu}+$", "", "ÄÖ", True),
        ("^\\\\p{Lu}+$", "", "äö", False),
        ("[$]$", "", "1$", True),
    ],
)
def test_patterns_are_those_of_xpath(pattern, flags, value, fits):
    shapes = f'ex:S a sh:NodeShape ; sh:targetNode "{value}" ; sh:pattern "{pattern}" ; sh:flags "{flags}" .'
    assert (results("", shapes) == ()) == fits


@pytest.mark.parametrize(
    ("shape", "said"),
    [
        ("sh:or ex:a", "does not end"),
        ('sh:node "x"', "no shape"),
        ("sh:property [ sh:minCount 1 ]", "no sh:path"),
        ("sh:qualifiedValueShape [] ; sh:qualifiedMinCount true", "whole number"),
        ('sh:sparql [ sh:select "SELECT $this WHERE { $this ?p ?o MINUS { $this ?p 1 } }" ]', "MINUS"),
        ('sh:sparql [ sh:select "SELECT $this WHERE { BIND (1 AS $this) }" ]', "cannot be assigned"),
        ('sh:sparql [ sh:select "SELECT $this WHERE { $this $PATH 1 }" ]', "without a path"),
        ('sh:target [ a sh:SPARQLTarget ; sh:select "SELECT" ]', "target cannot run"),
        ("sh:target [ a sh:SPARQLTarget ]", "no sh:select"),
        ("sh:expression [ ex:f ( sh:this ) ]", "not declared"),
        ("sh:expression [ ]", "none that is known"),
        ('sh:pattern "a" ; sh:flags "z"', "no flags"),
    ],
)
def test_a_shape_that_cannot_run_is_a_problem(shape, said):
    with pytest.raises(OntoError, match=said) as raised:
        results("ex:a ex:p 1 .", f"ex:S a sh:NodeShape ; sh:targetNode ex:a ; {shape} .")
    assert [problem.code for problem in raised.value.problems] == ["SHP002"]


def test_faults_are_collected_and_the_rest_is_validated():
    shapes = """ex:A a sh:NodeShape ; sh:targetNode ex:a ; sh:node ex:Broken .
    ex:Broken a sh:NodeShape ; sh:minLength "long" .
    ex:B a sh:NodeShape ; sh:targetNode ex:a ; sh:nodeKind sh:Literal ."""
    faults = []
    compiled = compile_graph(graph_of(PREFIXES + shapes), faults)
    assert [fault.shape.value for fault in faults] == [EX + "Broken"]
    assert [r.shape.value for r in validate_graph(graph_of(""), compiled, faults)] == [EX + "B"]


def test_a_class_that_is_a_shape_targets_its_instances():
    shapes = "ex:C a sh:NodeShape , <http://www.w3.org/2002/07/owl#Class> ; sh:nodeKind sh:Literal ."
    assert [r.focus.value for r in results("ex:a a ex:D . ex:D rdfs:subClassOf ex:C .", shapes)] == [EX + "a"]


def test_expressions_filter_and_call_functions():
    shapes = """ex:twice a sh:SPARQLFunction ; sh:parameter [ sh:path ex:op ] ;
        sh:select "SELECT ($op * 2 AS ?r) WHERE {}" .
    ex:same a sh:SPARQLFunction ; sh:parameter [ sh:path ex:x ; sh:order 2 ] , [ sh:path ex:y ; sh:order 1 ] ;
        sh:ask "ASK { FILTER (?x = ?y + 1) }" .
    ex:S a sh:NodeShape ; sh:targetSubjectsOf ex:p ;
        sh:expression [ ex:same ( [ ex:twice ( [ sh:path ex:p ] ) ] [ sh:path ex:q ] ) ] ."""
    # Of several calls with one answer the expression stands for the answer, once.
    found = results("ex:a ex:p 2 ; ex:q 5 . ex:b ex:p 2 ; ex:q 4 . ex:c ex:p 2 , 2.0 ; ex:q 5 .", shapes)
    assert [(r.focus.value, r.component) for r in found] == [(EX + "b", "ExpressionConstraintComponent")]


def test_a_query_target_selects_the_nodes():
    shapes = """ex:S a sh:NodeShape ; sh:nodeKind sh:Literal ;
        sh:target [ a sh:SPARQLTarget ; sh:select "SELECT ?this WHERE { ?this <https://example.org/p> 1 }" ] ."""
    assert [r.focus.value for r in results("ex:a ex:p 1 . ex:b ex:p 2 .", shapes)] == [EX + "a"]


@pytest.mark.parametrize(
    "shapes",
    [
        "sh:expression _:e . _:e sh:union ( _:e )",
        "sh:path _:e . _:e sh:inversePath _:e",
        "sh:in _:l . _:l rdf:first 1 ; rdf:rest _:l",
        'sh:expression [ ex:f ( sh:this ) ] . ex:f a sh:SPARQLFunction ; sh:select "SELECT"',
        'sh:expression [ ex:f ( sh:this ) ] . ex:f a sh:SPARQLFunction ; sh:select "CONSTRUCT { } WHERE { }"',
    ],
)
def test_what_has_no_end_or_no_sense_is_a_problem(shapes):
    with pytest.raises(OntoError, match="SHP002"):
        results("", f"ex:S a sh:NodeShape ; sh:targetNode ex:a ; {shapes} .")


def test_a_chain_that_is_too_long_is_a_problem():
    chain = " ".join(f"ex:n{n} ex:p ex:n{n + 1} ." for n in range(5000))
    with pytest.raises(OntoError, match="too long"):
        results(chain, "ex:S a sh:NodeShape ; sh:targetNode ex:n0 ; sh:property [ sh:path ex:p ; sh:node ex:S ] .")


def test_damaged_shapes_are_refused_or_run():
    """No mutation of the W3C's shapes ends in anything but results or problems."""
    rng = random.Random(7)  # noqa: S311 - damage, not cryptography
    paths = sorted(corpus().rglob("*.ttl"))
    assert len(paths) == 272
    files = [list(Graph(parse(path=path, format=RdfFormat.TURTLE, base_iri=EX))) for path in paths]
    predicates = sorted({triple.predicate for file in files for triple in file}, key=str)
    refused = 0
    for _ in range(1500):
        triples = list(rng.choice(files))
        for _ in range(rng.randint(1, 4)):
            one, other = rng.choice(triples), rng.choice(triples)
            triples.append(Triple(one.subject, rng.choice([one.predicate, *predicates]), other.object))
            triples.remove(one)
        damaged = Graph(triples)
        try:
            validate_graph(damaged, compile_graph(damaged))
        except OntoError as error:
            codes = {problem.code for problem in error.problems}
            assert codes <= {"SHP002", "QRY001", "QRY002", "QRY003"}
            refused += 1
    assert 20 < refused < 1480
