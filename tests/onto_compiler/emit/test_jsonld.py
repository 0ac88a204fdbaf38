"""Under the generated context a JSON record reads as statements in our vocabulary."""

import json

import pytest
from pyoxigraph import RdfFormat, parse, serialize
from rdflib import RDF, RDFS, Graph, Literal, Namespace, URIRef
from rdflib.collection import Collection
from rdflib.compare import isomorphic

from onto_compiler.compiled_rows import REQUIRED_ABOX_ROW
from onto_compiler.emit.jsonld import emit
from onto_compiler.emit.tbox import read_tbox
from onto_compiler.rdf import BASE, CORE, MAN, TRACE
from onto_compiler.record.described import described
from onto_compiler.record.rows import TYPE
from runtime.trace.summary import episode_summary
from tests.runtime.trace.samples import accepted, all_samples, unresolved
from tests.strategies import SCHEMA

C, M, T = Namespace(CORE), Namespace(MAN), Namespace(TRACE)
PROV = Namespace("http://www.w3.org/ns/prov#")
THIS = URIRef("https://example.org/episode")


@pytest.fixture(scope="module")
def context():
    return json.loads(emit(read_tbox()))


def read(context, record, **more):
    return Graph().parse(data=json.dumps({**context, **more, **record}), format="json-ld")


def episode(context, sample):
    return read(context, episode_summary(sample, SCHEMA), **{"@id": str(THIS)})


def test_every_property_is_declared_by_the_ontology(context):
    tbox = read_tbox()
    declared = {*tbox.declared("ObjectProperty", "DatatypeProperty", "AnnotationProperty")}
    declared |= {str(RDF.type), str(RDF.first), str(RDF.rest), str(RDFS.label)}
    for sample in all_samples():
        graph = episode(context, sample)
        assert len(graph) > 8
        assert {str(predicate) for predicate in graph.predicates()} <= declared


@pytest.mark.parametrize("sample", all_samples(), ids=lambda sample: sample.outcome)
def test_two_readers_of_json_ld_find_the_same_statements(sample, context):
    compiled = {"tasks": [REQUIRED_ABOX_ROW.of(sample.required)], "problems": []}
    for record in ({"@id": str(THIS), **episode_summary(sample, SCHEMA)}, compiled):
        text = json.dumps({**context, **record})
        triples = [quad.triple for quad in parse(text.encode(), format=RdfFormat.JSON_LD)]
        assert len(triples) > 8
        other = Graph().parse(data=serialize(triples, format=RdfFormat.N_TRIPLES), format="nt")
        assert isomorphic(other, Graph().parse(data=text, format="json-ld"))


def test_an_episode_reads_as_what_it_says(context):
    graph = episode(context, accepted())
    assert graph.value(THIS, T.outcome) == T.Accepted
    assert graph.value(THIS, T.task) == Literal("put_the_bowl_on_the_plate")
    assert graph.value(THIS, T.stateIndex).toPython() == 0
    assert graph.value(THIS, T.premiseHolds).toPython() is True
    attempts = list(graph.subjects(T.inEpisode, THIS))
    assert {graph.value(one, C.route) for one in attempts} == {M.object_relation_predicate, M.source_joint_residual}
    assert {graph.value(one, C.decision) for one in attempts} == {C.Dispatch, C.Reroute}
    assert {graph.value(one, T.mode) for one in attempts} == {T.StateMutation}
    verified = [graph.value(one, T.verification) for one in attempts]
    assert {graph.value(one, T.outcomeTruth).toPython() for one in verified} == {True, False}


def test_a_diagnosis_reads_as_what_it_says(context):
    graph = episode(context, accepted())
    (diagnosis,) = graph.subjects(PROV.wasGeneratedBy, THIS)
    assert graph.value(diagnosis, C.predicate) == M.on
    assert graph.value(diagnosis, C.failureClass) == M.RelationMissing
    assert graph.value(diagnosis, C.source) == C.Simulator
    assert graph.value(diagnosis, C.unit) == URIRef("http://qudt.org/vocab/unit/M")
    margin = graph.value(diagnosis, C.margin)
    assert (margin.toPython(), str(margin.datatype).rpartition("#")[2]) == (-0.142, "double")
    names = Collection(graph, graph.value(diagnosis, C.arguments))
    assert [str(name) for name in names] == ["akita_black_bowl_1", "plate_1"]


@pytest.mark.parametrize("sample", all_samples(), ids=lambda sample: sample.outcome)
def test_the_words_of_an_episode_are_read_whole(sample, context):
    """What SPARQL finds in the RDF reading is what the JSON record says."""
    record = episode_summary(sample, SCHEMA)
    graph = episode(context, sample)
    found = graph.query(
        "SELECT ?failure ?route WHERE { ?a trace:inEpisode ?this ; core:failureClass ?failure ; core:route ?route }",
        initNs={"trace": T, "core": C},
        initBindings={"this": THIS},
    )
    words = SCHEMA.notations
    read_back = sorted((words[str(row.failure)], words[str(row.route)]) for row in found)
    assert read_back == sorted((one["failure"], one["route"]) for one in record["history"])


def test_a_required_abox_reads_with_typed_arguments(context):
    record = {"tasks": [REQUIRED_ABOX_ROW.of(unresolved().required)], "problems": []}
    graph = read(context, record)
    (abox,) = graph.subjects(T.task)
    (fact,) = graph.objects(abox, T.memberFact)
    assert graph.value(fact, C.predicate) == M.joint_state
    joint, threshold = Collection(graph, graph.value(fact, C.arguments))
    assert (graph.value(joint, RDF.type), str(graph.value(joint, RDFS.label))) == (M.ArticulatedFixture, "flat_stove_1")
    assert graph.value(threshold, RDF.type) == URIRef(BASE + "libero#flat_stove_on")
    assert len(list(graph.objects(abox, T.declares))) == 1


def test_a_grounding_reads_with_its_status(context):
    fact = {
        "fact": "on(a, b)",
        "predicate": "on",
        "arguments": ["a", "b"],
        "polarity": True,
        "truth": False,
        "satisfied": False,
        "status": "explicitly false",
        "margin": None,
        "unit": "m",
        "limit": "x",
        "native": "On(a, b)",
    }
    record = {
        "world": "w",
        "suite": "s",
        "task": "t",
        "state": 1,
        "facts": [fact],
        "premise": [],
        "native_success": False,
        "settle_steps": 0,
        "fixtures": None,
        "uncertain": [],
    }
    assert set(record) == set(described().rows["Grounding"].columns)
    assert set(fact) == set(described().rows["ObservedFact"].columns)
    graph = read(context, record)
    (seen,) = graph.objects(None, T.memberFact)
    assert graph.value(seen, C.status) == C.ExplicitlyFalse
    assert graph.value(seen, C.margin) is None
    assert graph.value(seen, C.limit) == Literal("x")


def test_terms_of_the_table_are_declared():
    tbox = read_tbox()
    declared = {*tbox.declared("ObjectProperty", "DatatypeProperty", "AnnotationProperty"), str(RDFS.label)}
    rows = described().rows
    terms = {column.term for row in rows.values() for column in row.columns.values()} - {"", TYPE, "@graph"}
    assert len(terms) > 25
    assert terms <= declared
    assert set(described().documents) <= set(rows)
