"""Records are held to the shapes by the engine that validates graphs, over the statements at hand."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import Literal, NamedNode, Quad

from onto_compiler.problems import OntoError
from onto_compiler.rdf import SH, node
from onto_compiler.shacl.compile import compile_graph
from onto_compiler.shacl.graph import Graph
from onto_compiler.shacl.validate import validate_graph
from onto_compiler.shapes import ShapeResult
from onto_compiler.sources import load_store
from onto_compiler.validator.implications import IMPLICATIONS, query_key
from onto_compiler.validator.records import compile_validator, problem_of, record_validator
from tests.shape_graphs import CLASSES, EX, NODES, STATEMENTS, VALUE_SHAPE, store_of

SHAPES = (
    VALUE_SHAPE
    + """
ex:Pairs a sh:NodeShape ; sh:targetClass ex:Thing ; sh:targetSubjectsOf ex:p ; sh:targetObjectsOf ex:q ;
    sh:property [ sh:path ex:q ; sh:equals ex:r ; sh:disjoint ex:p ] , [ sh:path ex:p ; sh:lessThan ex:r ] .
ex:Paths a sh:NodeShape ; sh:targetClass ex:Part ; sh:targetNode ex:a , ex:d ;
    sh:property [ sh:path ( ex:q ex:q ) ; sh:maxCount 1 ] ,
        [ sh:path [ sh:zeroOrMorePath [ sh:alternativePath ( ex:q ex:r ) ] ] ; sh:nodeKind sh:IRI ] ,
        [ sh:path [ sh:inversePath ex:q ] ; sh:maxCount 1 ; sh:class ex:Thing ] ,
        [ sh:path ( [ sh:inversePath ex:q ] ex:r ) ; sh:nodeKind sh:Literal ] .
ex:Logic a sh:NodeShape ; sh:targetClass ex:Thing ;
    sh:not [ sh:property [ sh:path ex:p ; sh:hasValue 5 ] ] ;
    sh:or ( [ sh:property [ sh:path ex:p ; sh:minCount 1 ] ] [ sh:property [ sh:path ex:r ; sh:minCount 1 ] ] ) ;
    sh:property [ sh:path ex:q ; sh:qualifiedValueShape [ sh:class ex:Part ] ; sh:qualifiedMinCount 1 ] .
ex:Chain a sh:NodeShape ; sh:targetClass ex:Thing ;
    sh:property [ sh:path ex:q ; sh:node ex:Chain ; sh:nodeKind sh:IRI ] .
ex:Tree a sh:NodeShape ; sh:targetSubjectsOf ex:q ; sh:property ex:Branch ; sh:not ex:Odd .
ex:Branch sh:path ex:q ; sh:property ex:Branch ; sh:maxCount 1 .
ex:Odd a sh:NodeShape ; sh:property [ sh:path ex:r ; sh:node ex:Tree ; sh:minCount 1 ] .
ex:Closed a sh:NodeShape ; sh:targetClass ex:Part ; sh:closed true ; sh:ignoredProperties ( ex:r ) ;
    sh:property [ sh:path ex:p ; sh:deactivated true ; sh:maxCount 0 ] .
ex:Asked a sh:NodeShape ; sh:targetClass ex:Part ; sh:sparql [ sh:message "points at itself" ;
    sh:select "SELECT $this ?value WHERE { $this <https://example.org/q> ?value FILTER (?value = $this) }" ] .
"""
)
VOCABULARY = """ex:Part rdfs:subClassOf ex:Thing . ex:a a ex:Part ; ex:r ex:b . ex:b ex:q ex:known .
    ex:known a ex:Thing ; ex:q ex:known , ex:a ; ex:r ex:a ."""
LINKED = st.tuples(st.sampled_from(NODES), st.just(node(EX + "q")), st.sampled_from([*NODES, node(EX + "known")]))
EXTENDED = st.just((node(EX + "Other"), node("http://www.w3.org/2000/01/rdf-schema#subClassOf"), CLASSES[1]))
RECORDS = st.lists(st.one_of(*STATEMENTS, LINKED, EXTENDED), min_size=1, max_size=14)


def found(shapes, statements="", vocabulary=""):
    """The components that ``statements`` violate, in the order of their names."""
    validator = compile_validator(store_of(vocabulary), store_of(shapes))
    return sorted(one.component.removesuffix("ConstraintComponent") for one in validator.validate(store_of(statements)))


@settings(max_examples=100, deadline=None)
@given(RECORDS)
def test_it_finds_of_records_what_the_engine_finds_in_the_whole_graph(statements):
    vocabulary, shapes = list(store_of(VOCABULARY)), list(store_of(SHAPES))
    quads = [Quad(*statement) for statement in statements]
    mine = set(compile_validator(vocabulary, shapes).validate(quads))
    whole = set(validate_graph(Graph([*vocabulary, *quads]), compile_graph(Graph(shapes))))
    described = {quad.subject for quad in quads}
    assert {one for one in mine if one.focus in described} == {one for one in whole if one.focus in described}
    assert mine <= whole, "values that a shape targets, where the vocabulary alone describes them"


def test_the_comparison_sees_every_shape_violated():
    statements = """ex:b a ex:Thing ; ex:p 5 , "x" ; ex:q ex:b , ex:c ; ex:r ex:c . ex:c a ex:Part ; ex:q ex:c , 1 ."""
    validator = compile_validator(store_of(VOCABULARY), store_of(SHAPES))
    results = validator.validate(store_of(statements))
    homes = {validator.home(one.shape) for one in results}
    assert homes == {shape.iri for shape in validator.shapes.roots}


@pytest.mark.parametrize(
    ("statements", "expected"),
    [
        ("ex:one a ex:Thing ; ex:p ex:two . ex:two ex:p ex:one .", []),
        ("ex:one a ex:Thing ; ex:p ex:one .", []),
        ("ex:one a ex:Thing ; ex:p ex:two . ex:two ex:p ex:one , 3 .", ["Node"]),
    ],
)
def test_a_shape_that_refers_to_itself_ends(statements, expected):
    shapes = (
        "ex:S a sh:NodeShape ; sh:targetClass ex:Thing ; sh:property [ sh:path ex:p ; sh:node ex:S , ex:Named ] . "
        "ex:Named a sh:NodeShape ; sh:nodeKind sh:IRI ."
    )
    assert found(shapes, statements) == expected


def test_a_chain_that_is_too_long_is_a_problem():
    shapes = "ex:S a sh:NodeShape ; sh:targetNode ex:n0 ; sh:property [ sh:path ex:p ; sh:node ex:S ] ."
    with pytest.raises(OntoError, match="too long"):
        found(shapes, " ".join(f"ex:n{n} ex:p ex:n{n + 1} ." for n in range(5000)))


def test_every_implication_is_that_of_one_shipped_query_and_of_no_other():
    store = load_store()
    keys = [query_key(quad.object.value) for quad in store.quads_for_pattern(None, node(SH + "select"), None, None)]
    assert len(keys) == len(set(keys)) == 6
    assert set(keys) == set(IMPLICATIONS)


def test_the_shipped_shapes_are_those_that_records_are_held_to():
    assert len(record_validator().shapes.roots) >= 20
    assert record_validator() is record_validator()


def test_a_new_property_shape_needs_no_python():
    shapes = "ex:New a sh:NodeShape ; sh:targetClass ex:Thing ; sh:property [ sh:path ex:p ; sh:minCount 1 ] ."
    assert found(shapes, "ex:one a ex:Thing .") == ["MinCount"]
    assert found(shapes, "ex:one a ex:Thing ; ex:p 1 .") == []


def test_a_class_that_is_a_shape_targets_its_instances():
    shapes = "ex:Thing a sh:NodeShape , rdfs:Class ; sh:property [ sh:path ex:p ; sh:minCount 1 ] ."
    assert found(shapes, "ex:one a ex:Thing .") == ["MinCount"]


def test_statements_may_extend_the_class_tree_and_leave_it_as_it_was_for_the_next():
    shapes = "ex:S a sh:NodeShape ; sh:targetClass ex:Thing ; sh:property [ sh:path ex:p ; sh:class ex:Thing ] ."
    validator = compile_validator(store_of("ex:Part rdfs:subClassOf ex:Thing ."), store_of(shapes))
    plainly = "ex:one a ex:Part ; ex:p ex:two . ex:two a ex:Screw ."
    extended = plainly + "ex:Screw rdfs:subClassOf ex:Part ."
    assert len(validator.validate(store_of(plainly))) == 1
    assert validator.validate(store_of(extended)) == ()
    assert len(validator.validate(store_of(plainly))) == 1


def test_what_the_vocabulary_states_of_a_node_counts():
    shapes = "ex:S a sh:NodeShape ; sh:targetClass ex:Thing ; sh:property [ sh:path ex:p ; sh:maxCount 1 ] ."
    vocabulary = "ex:known ex:p 1 . ex:silent a ex:Thing ; ex:p 1 , 2 ."
    assert found(shapes, "ex:known a ex:Thing ; ex:p 1 .", vocabulary) == []
    assert found(shapes, "ex:known a ex:Thing ; ex:p 2 .", vocabulary) == ["MaxCount"]
    assert found(shapes, "ex:other a ex:Thing ; ex:q ex:silent .", vocabulary) == []


def test_queries_and_functions_ask_records_and_vocabulary_together():
    shapes = """ex:double a sh:SPARQLFunction ; sh:parameter [ sh:path ex:of ] ;
            sh:select "SELECT (?n * 2 AS ?r) WHERE { $of <https://example.org/p> ?n }" .
        ex:S a sh:NodeShape ; sh:targetClass ex:Thing ; sh:property [ sh:path ex:p ; sh:maxCount 1 ] ;
            sh:sparql [ sh:select '''SELECT $this ?value WHERE { $this <https://example.org/q> ?value .
                ?value <https://example.org/p> 2 FILTER (<https://example.org/double>(?value) = 4) }''' ] .
        ex:T a sh:NodeShape ; sh:nodeKind sh:Literal ;
            sh:target [ a sh:SPARQLTarget ; sh:select "SELECT ?this WHERE { ?this <https://example.org/p> 2 }" ] ."""
    vocabulary = "ex:two ex:p 2 ."
    assert found(shapes, "ex:one a ex:Thing ; ex:q ex:two .", vocabulary) == ["SPARQL"]
    assert found(shapes, "ex:one a ex:Thing ; ex:q ex:two ; ex:p 2 .", vocabulary) == ["NodeKind", "SPARQL"]
    assert found(shapes, "ex:one a ex:Other ; ex:q ex:two .", vocabulary) == []


def test_a_changed_query_runs_as_it_is_written():
    shapes = """ex:S a sh:NodeShape ; sh:targetClass ex:Thing ;
        sh:sparql [ sh:select "SELECT $this WHERE { $this <https://example.org/p> 2 }" ] ."""
    assert found(shapes, "ex:one a ex:Thing ; ex:p 2 .") == ["SPARQL"]
    assert found(shapes, "ex:one a ex:Thing ; ex:p 1 .") == []


@pytest.mark.parametrize(
    "fault",
    [
        'sh:property [ sh:path "p" ]',
        "sh:property [ sh:path ex:p ; sh:minCount ex:many ]",
        'sh:property [ sh:path ex:p ; sh:pattern "(" ]',
        'sh:property [ sh:path ex:p ; sh:class "Thing" ]',
        "sh:property [ sh:path ex:p ; sh:nodeKind ex:Kind ]",
        "sh:property [ sh:path ex:p ; sh:hasValue [] ]",
        'sh:targetClass "Thing"',
    ],
)
def test_a_shape_that_cannot_run_is_a_problem_where_it_is_written(fault, tmp_path):
    path = tmp_path / "own.ttl"
    path.write_text(
        "@prefix ex: <https://example.org/> .\n@prefix sh: <http://www.w3.org/ns/shacl#> .\n"
        f"ex:S a sh:NodeShape ; sh:targetClass ex:Thing ;\n    {fault} .\n"
    )
    with pytest.raises(OntoError) as error:
        record_validator([path])
    (problem,) = error.value.problems
    assert (problem.code, problem.file, problem.line) == ("SHP002", str(path), 4)
    assert problem.hint


def test_a_list_that_does_not_end_is_a_problem():
    rdf = "http://www.w3.org/1999/02/22-rdf-syntax-ns#"
    shapes = f"""ex:S a sh:NodeShape ; sh:targetClass ex:Thing ; sh:property [ sh:path ex:p ; sh:in ex:list ] .
        ex:list <{rdf}first> 1 ; <{rdf}rest> ex:list ."""
    with pytest.raises(OntoError, match="does not end"):
        found(shapes, "ex:one a ex:Thing ; ex:p 1 .")


def test_a_result_without_a_message_says_what_its_constraint_asks_for():
    path, shape = NamedNode(EX + "p"), NamedNode(EX + "S")
    result = ShapeResult(NamedNode(EX + "one"), path, Literal(3), "DatatypeConstraintComponent", shape, expected="must")
    problem = problem_of(result, shape, lambda term: f"`{term.value}`")
    assert problem.message == f"`{EX}one` violates `{EX}p`: must, and has `3` ({EX}S)"
    assert problem.code == "SHP001"
