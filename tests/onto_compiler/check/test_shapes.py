"""Compiled shapes give the results that pySHACL gives: focus node, path, value and component of each."""

from pathlib import Path

import pytest
import rdflib
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import Literal, NamedNode, Quad, RdfFormat, parse

from onto_compiler.check.model import load_model
from onto_compiler.check.run import check
from onto_compiler.problems import OntoError
from onto_compiler.shapes import compile_shapes, validate
from tests.shape_graphs import PREFIXES, assert_same, by_pyshacl, rows, store_of

pytestmark = pytest.mark.usefixtures("queries_parsed_once")

HERE = Path(__file__).parent
FILES = sorted([*(HERE / "broken").glob("*.ttl"), *(HERE / "good").glob("*.ttl")])
UNREADABLE = "ttl"
CANNOT_RUN = ("shp002", "qry")
EXAMPLES = [path for path in FILES if not path.stem.startswith((UNREADABLE, *CANNOT_RUN))]
GROUPS = 8


def ours(store):
    return rows(validate(store, compile_shapes(store)))


def assert_equal(store):
    found = ours(store)
    assert_same(found, by_pyshacl(store, store))
    return found


def test_the_shipped_ontology_conforms_on_both_engines():
    assert assert_equal(load_model().store) == set()


@pytest.mark.parametrize("first", range(GROUPS))
def test_both_engines_agree_on_every_example(first):
    """Several files at a time: to load the ontology for pySHACL is most of the work."""
    assert assert_equal(load_model(EXAMPLES[first::GROUPS]).store)


def test_enough_examples_are_compared():
    assert len(FILES) > 120
    assert len(FILES) - len(EXAMPLES) == 17


def _taken_for_unbound(term):
    """Whether Python calls ``term`` false, which rdflib takes for an unbound variable where a path has a ``?``."""
    return isinstance(term, Literal) and not rdflib.Literal(term.value, datatype=term.datatype.value)


@settings(max_examples=12, deadline=None)
@given(
    st.lists(
        st.tuples(st.integers(0, 200), st.sampled_from(("drop", "swap", "number", "copy")), st.integers(0, 200)),
        min_size=1,
        max_size=4,
    )
)
def test_both_engines_agree_on_damaged_episodes(damages):
    path = HERE / "good" / "episode.ttl"
    triples = list(parse(path=path, format=RdfFormat.TURTLE))
    store = load_model([path]).store
    for at, kind, other in damages:
        triple, donor = triples[at % len(triples)], triples[other % len(triples)]
        value = Literal(other) if kind == "number" else donor.object
        if _taken_for_unbound(value):
            continue
        quads = list(store.quads_for_pattern(triple.subject, triple.predicate, triple.object, None))
        graph = NamedNode(path.as_uri())
        if kind != "copy":
            for quad in quads:
                store.remove(quad)
        if kind != "drop":
            store.add(Quad(triple.subject, triple.predicate, value, graph))
    assert_equal(store)


def test_damage_to_an_episode_is_seen():
    path = HERE / "good" / "episode.ttl"
    store = load_model([path]).store
    assert ours(store) == set()
    polarity = NamedNode("https://w3id.org/onto-evwm/core#polarity")
    for quad in list(store.quads_for_pattern(None, polarity, None, NamedNode(path.as_uri()))):
        store.remove(quad)
    assert len(ours(store)) == 2


def test_a_boolean_does_not_compare_with_a_number():
    """SHACL, section 4.3: a value that cannot be compared violates the constraint."""
    text = (
        "ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:property [ sh:path ex:p ; sh:maxInclusive 2 ] . ex:a ex:p true ."
    )
    (result,) = validate(store := store_of(text), compile_shapes(store))
    assert result.component == "MaxInclusiveConstraintComponent"


@pytest.mark.parametrize(("value", "problems"), [('"05"^^xsd:byte', 0), ('"500"^^xsd:byte', 1), ("5", 1)])
def test_a_datatype_is_judged_as_the_file_writes_it(value, problems, tmp_path):
    path = tmp_path / "bytes.ttl"
    shape = "ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:property [ sh:path ex:p ; sh:datatype xsd:byte ] ."
    path.write_text(f"{PREFIXES}{shape} ex:a ex:p {value} .")
    found = [p.message for p in check([path]).problems if p.code == "SHP001"]
    assert (
        found
        == ["`ex:a` violates the property shape of `ex:p`: must be a literal of the datatype `xsd:byte`"] * problems
    )


def test_a_deactivated_shape_is_not_run():
    text = "ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:nodeKind sh:Literal ; sh:deactivated true ."
    assert assert_equal(store_of(text)) == set()


def test_severity_message_and_placeholders_come_from_the_shape():
    text = """
ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:severity sh:Warning ;
    sh:sparql [ sh:message "{$this} has {?value}" ; sh:select "SELECT $this (3 AS ?value) WHERE { }" ] ."""
    (result,) = validate(store := store_of(text), compile_shapes(store))
    assert (result.severity, result.message) == ("Warning", "https://example.org/a has 3")


@pytest.mark.parametrize(
    ("shape", "said"),
    [
        ('sh:property [ sh:path ex:p ; sh:minCount "two" ]', "whole number"),
        ('sh:pattern "("', "regular expression"),
        ("sh:nodeKind ex:Thing", "node kind"),
        ('sh:sparql [ sh:select "SELECT nothing" ]', "cannot run"),
        ('sh:sparql [ sh:message "no query" ]', "no sh:select"),
        ("sh:in [ ]", "does not end"),
        ("sh:in ( [ ] )", "blank node"),
        ("sh:class [ ]", "no IRI"),
        ("sh:hasValue [ ]", "blank node"),
        ("sh:targetClass 3", "no IRI"),
        ("sh:property [ sh:path 3 ]", "no property path"),
        ("sh:property [ sh:path [ ex:odd 3 ] ]", "no property path"),
        ("sh:property [ sh:path _:p ] . _:p sh:inversePath _:p", "no property path"),
    ],
)
def test_a_shape_that_cannot_run_is_a_problem_and_not_a_traceback(shape, said):
    store = store_of(f"ex:S a sh:NodeShape ; sh:targetNode ex:a ; {shape} .")
    with pytest.raises(OntoError, match=said) as raised:
        validate(store, compile_shapes(store))
    assert [problem.code for problem in raised.value.problems] == ["SHP002"]
