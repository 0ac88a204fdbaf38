"""Shapes in plain Python find what pySHACL finds, and are read from Turtle alone."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import Literal, NamedNode, Quad, Store

from onto_compiler.problems import OntoError
from onto_compiler.rdf import SH, node
from onto_compiler.sources import load_store
from onto_compiler.validator.compile import compile_validator
from onto_compiler.validator.components import COMPONENTS
from onto_compiler.validator.implications import IMPLICATIONS, query_key
from tests.shape_graphs import CLASSES, NODES, STATEMENTS, TYPE, VALUE_SHAPE, assert_same, by_pyshacl, rows, store_of

SHAPES = (
    VALUE_SHAPE
    + """
ex:Pairs a sh:NodeShape ; sh:targetClass ex:Thing ; sh:targetSubjectsOf ex:p ; sh:targetObjectsOf ex:q ;
    sh:property [ sh:path ex:q ; sh:equals ex:r ; sh:disjoint ex:p ] ,
        [ sh:path ex:m ; sh:lessThan ex:n ; sh:lessThanOrEquals ex:n ] .
ex:Paths a sh:NodeShape ; sh:targetClass ex:Part ;
    sh:property [ sh:path ( ex:q ex:q ) ; sh:maxCount 1 ] ,
        [ sh:path [ sh:alternativePath ( ex:p ex:r ) ] ; sh:minCount 1 ] ,
        [ sh:path [ sh:zeroOrMorePath ex:q ] ; sh:nodeKind sh:IRI ] ,
        [ sh:path [ sh:oneOrMorePath ex:q ] ; sh:nodeKind sh:Literal ] ,
        [ sh:path [ sh:zeroOrOnePath ex:q ] ; sh:maxCount 1 ] ,
        [ sh:path [ sh:inversePath [ sh:zeroOrMorePath ex:q ] ] ; sh:maxCount 1 ] ,
        [ sh:path ( [ sh:inversePath ex:q ] ex:r ) ; sh:nodeKind sh:Literal ] .
ex:Logic a sh:NodeShape ; sh:targetClass ex:Thing ;
    sh:not [ sh:property [ sh:path ex:p ; sh:hasValue 5 ] ] ;
    sh:and ( [ sh:nodeKind sh:IRI ] [ sh:property [ sh:path ex:p ; sh:maxCount 1 ] ] ) ;
    sh:or ( [ sh:property [ sh:path ex:p ; sh:minCount 1 ] ] [ sh:property [ sh:path ex:r ; sh:minCount 1 ] ] ) ;
    sh:xone ( [ sh:property [ sh:path ex:q ; sh:minCount 1 ] ] [ sh:property [ sh:path ex:r ; sh:minCount 1 ] ] ) ;
    sh:property [ sh:path ex:q ; sh:node [ sh:property [ sh:path ex:p ; sh:minCount 1 ] ] ;
        sh:property [ sh:path ex:r ; sh:maxCount 1 ] ] ,
        [ sh:path ex:q ; sh:qualifiedValueShape [ sh:class ex:Part ] ; sh:qualifiedMinCount 1 ;
          sh:qualifiedMaxCount 1 ; sh:qualifiedValueShapesDisjoint true ] ,
        [ sh:path ex:q ; sh:qualifiedValueShape [ sh:nodeKind sh:IRI ] ; sh:qualifiedMaxCount 1 ;
          sh:qualifiedValueShapesDisjoint true ] .
ex:Closed a sh:NodeShape ; sh:targetClass ex:Part ; sh:closed true ;
    sh:ignoredProperties ( <http://www.w3.org/1999/02/22-rdf-syntax-ns#type> ) ;
    sh:property [ sh:path ex:p ; sh:deactivated true ; sh:maxCount 0 ] , [ sh:path ex:q ; sh:maxCount 9 ] .
"""
)
VOCABULARY = "ex:Part rdfs:subClassOf ex:Thing . ex:a a ex:Part . ex:a ex:r ex:b ."
ORDERED = [NamedNode("https://example.org/m"), NamedNode("https://example.org/n")]
# Numbers alone: pySHACL orders IRIs too, for which SPARQL's `<` and hence SHACL have no order.
NUMBERS = [Literal(n) for n in (1, 2, 5)] + [Literal(1.5)]


def components(shapes, statements="", vocabulary=""):
    """The components that ``statements`` violate, in the order of their names."""
    validator = compile_validator(store_of(vocabulary), store_of(shapes))
    return sorted(
        result.component.removesuffix("ConstraintComponent") for result in validator.validate(store_of(statements))
    )


def test_every_shipped_shape_has_a_python_form():
    validator = compile_validator(load_store())
    assert len(validator.shapes) >= 20
    assert validator.foreign == ()


def test_every_implication_is_that_of_one_shipped_query_and_of_no_other():
    store = load_store()
    keys = [query_key(quad.object.value) for quad in store.quads_for_pattern(None, node(SH + "select"), None, None)]
    assert len(keys) == len(set(keys)) == 6
    assert set(keys) == set(IMPLICATIONS)


def test_the_shapes_of_the_comparison_use_every_component():
    used = {quad.predicate.value.removeprefix(SH) for quad in store_of(SHAPES)}
    assert set(COMPONENTS) - used == set()


@settings(max_examples=150, deadline=None)
@given(
    st.lists(
        st.one_of(
            *STATEMENTS,
            st.tuples(st.sampled_from(NODES), st.sampled_from(ORDERED), st.sampled_from(NUMBERS)),
        ),
        min_size=1,
        max_size=14,
    )
)
def test_it_finds_what_pyshacl_finds(statements):
    vocabulary, shapes = store_of(VOCABULARY), store_of(SHAPES)
    quads = [Quad(*statement) for statement in statements]
    # A node that the vocabulary alone describes is no focus node of ours.
    quads += [Quad(NODES[0], TYPE, CLASSES[1]), Quad(NODES[1], TYPE, CLASSES[0])]
    mine = compile_validator(vocabulary, shapes).validate(quads)
    both = Store()
    both.extend([*vocabulary, *quads])
    assert_same(rows(mine), by_pyshacl(both, shapes))


def test_a_new_property_shape_needs_no_python():
    shapes = "ex:New a sh:NodeShape ; sh:targetClass ex:Thing ; sh:property [ sh:path ex:p ; sh:minCount 1 ] ."
    assert components(shapes, "ex:one a ex:Thing .") == ["MinCount"]
    assert components(shapes, "ex:one a ex:Thing ; ex:p 1 .") == []


def test_the_way_back_along_a_sequence_starts_at_its_end():
    # pySHACL walks it from its beginning.
    shapes = """ex:Back a sh:NodeShape ; sh:targetNode ex:end ;
        sh:property [ sh:path [ sh:inversePath ( ex:p ex:q ) ] ; sh:minCount 1 ] ."""
    assert components(shapes, "ex:start ex:p ex:middle . ex:middle ex:q ex:end . ex:end ex:r 1 .") == []
    assert components(shapes, "ex:start ex:q ex:middle . ex:middle ex:p ex:end . ex:end ex:r 1 .") == ["MinCount"]


@pytest.mark.parametrize(
    ("pattern", "flags", "value", "fits"),
    [("^a$", "", "a", True), ("^a$", "", "a\\n", False), ("^A", "i", "a", True), ("^\\\\p{Lu}$", "", "Ä", True)],
)
def test_a_pattern_means_what_xpath_says(pattern, flags, value, fits):
    shapes = f"""ex:S a sh:NodeShape ; sh:targetClass ex:Thing ;
        sh:property [ sh:path ex:p ; sh:pattern "{pattern}" ; sh:flags "{flags}" ] ."""
    assert components(shapes, f'ex:one a ex:Thing ; ex:p "{value}" .') == ([] if fits else ["Pattern"])


def test_a_class_that_is_a_shape_targets_its_instances():
    shapes = "ex:Thing a sh:NodeShape , rdfs:Class ; sh:property [ sh:path ex:p ; sh:minCount 1 ] ."
    assert components(shapes, "ex:one a ex:Thing .") == ["MinCount"]


def test_statements_may_extend_the_class_tree_and_leave_it_as_it_was_for_the_next():
    shapes = "ex:S a sh:NodeShape ; sh:targetClass ex:Thing ; sh:property [ sh:path ex:p ; sh:class ex:Thing ] ."
    validator = compile_validator(store_of("ex:Part rdfs:subClassOf ex:Thing ."), store_of(shapes))
    plainly = "ex:one a ex:Part ; ex:p ex:two . ex:two a ex:Screw ."
    extended = plainly + "ex:Screw rdfs:subClassOf ex:Part ."
    assert len(validator.validate(store_of(plainly))) == 1
    assert validator.validate(store_of(extended)) == ()
    assert len(validator.validate(store_of(plainly))) == 1


def test_what_the_vocabulary_says_of_a_node_counts():
    shapes = "ex:S a sh:NodeShape ; sh:targetClass ex:Thing ; sh:property [ sh:path ex:p ; sh:maxCount 1 ] ."
    vocabulary = "ex:known ex:p 1 ."
    assert components(shapes, "ex:known a ex:Thing ; ex:p 1 .", vocabulary) == []
    assert components(shapes, "ex:known a ex:Thing ; ex:p 2 .", vocabulary) == ["MaxCount"]
    assert components(shapes, "ex:other a ex:Thing .", vocabulary) == []


def test_a_query_without_a_python_form_runs_as_sparql():
    shapes = """ex:S a sh:NodeShape ; sh:targetClass ex:Thing ; sh:property [ sh:path ex:p ; sh:minCount 1 ] ;
        sh:sparql [ sh:select "SELECT $this WHERE { $this <https://example.org/p> 2 }" ] ."""
    validator = compile_validator(store_of(""), store_of(shapes))
    assert len(validator.foreign) == 1
    found = [validator.validate(store_of(text)) for text in ("ex:one a ex:Thing ; ex:p 2 .", "ex:one a ex:Thing .")]
    assert [[result.component for result in each] for each in found] == [
        ["SPARQLConstraintComponent"],
        ["MinCountConstraintComponent"],
    ]
    assert validator.validate(store_of("ex:one a ex:Other ; ex:p 2 .")) == ()


def test_a_shipped_query_that_somebody_changes_runs_as_sparql():
    store = load_store()
    (quad,) = [
        quad
        for quad in store.quads_for_pattern(None, node(SH + "select"), None, None)
        if "core:arity" in quad.object.value
    ]
    store.remove(quad)
    changed = Literal(quad.object.value.replace("?arity = 2", "?arity = 3"))
    store.add(Quad(quad.subject, quad.predicate, changed, quad.graph_name))
    assert [root.value.rpartition("#")[2] for _, root in compile_validator(store).foreign] == ["RequiredFact"]


@pytest.mark.parametrize(
    "fault",
    [
        'sh:property [ sh:path "p" ]',
        "sh:property [ sh:path ex:p ; sh:minCount ex:many ]",
        'sh:property [ sh:path ex:p ; sh:pattern "(" ]',
        'sh:property [ sh:path ex:p ; sh:class "Thing" ]',
        "sh:property [ sh:path ex:p ; sh:nodeKind ex:Kind ]",
        "sh:node ex:S",
        'sh:targetClass "Thing"',
    ],
)
def test_a_shape_that_cannot_run_is_a_problem(fault):
    with pytest.raises(OntoError) as error:
        components(f"ex:S a sh:NodeShape ; sh:targetClass ex:Thing ; {fault} .")
    (problem,) = error.value.problems
    assert problem.code == "SHP002"
    assert problem.hint
