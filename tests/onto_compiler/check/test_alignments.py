"""What other vocabularies say of their terms does not contradict what ours say of theirs."""

import owlready2
import pytest
from pyoxigraph import NamedNode, RdfFormat, Store

import ontology
from onto_compiler.rdf import BASE, OWL, RDF, RDFS, SKOS, prologue
from onto_compiler.sources import load_store
from tests.onto_compiler.check.test_owl import as_world

FILES = {path.stem: path for path in (ontology.ROOT / "alignments").glob("*.ttl")}
MAPPED = ("cora", "failrecont", "soma", "sosa")
MAPPINGS = (*(SKOS + name for name in ("closeMatch", "relatedMatch", "broadMatch")), RDFS + "subClassOf")

# Axioms of the vocabularies themselves, which the alignments do not repeat.
UPSTREAM = """
prov:Activity owl:disjointWith prov:Entity .
dul:Event owl:disjointWith dul:Object .
dul:SpaceRegion rdfs:subClassOf dul:Abstract .
dul:Abstract owl:disjointWith dul:Event , dul:Object .
fail:Failure owl:disjointWith fail:RecoveryStrategy .
sosa:Observation rdfs:subClassOf prov:Activity .
sosa:Actuation rdfs:subClassOf prov:Activity .
"""
# One thing that both sides cannot agree on, so that the reasoner is seen to look.
IMPOSSIBLE = {
    "cora": "core:Action owl:disjointWith corax:RobotMotion . [] a core:Action , corax:RobotMotion .",
    "failrecont": "[] a fail:AttemptAlternativeAction , fail:ConfigurationNotReached .",
    "soma": "[] a man:Object , core:Action .",
    "sosa": "[] a core:ObservedFact , sosa:Observation .",
}


def turtle(text):
    prefixes = prologue().replace("PREFIX", "@prefix").replace(">\n", "> .\n")
    return f"{prefixes}@prefix ex: <https://example.org/> .\n{text}".encode()


def alone(name):
    store = Store()
    store.load(path=FILES[name], format=RdfFormat.TURTLE, base_iri="https://example.org/")
    return store


def with_upstream(text=""):
    store = load_store()
    store.load(turtle(UPSTREAM + text), format=RdfFormat.TURTLE, base_iri="https://example.org/")
    return store


def test_every_vocabulary_of_the_issue_has_its_file():
    assert set(FILES) == {*MAPPED, "prov", "qudt"}


@pytest.mark.parametrize("name", MAPPED)
def test_a_mapping_leads_from_a_term_of_ours_to_one_that_the_file_declares_and_says_why(name):
    store, ours = alone(name), load_store()
    mappings = [q for p in MAPPINGS for q in store.quads_for_pattern(None, NamedNode(p), None)]
    mine = [q for q in mappings if q.subject.value.startswith(BASE)]
    assert len(mine) >= 4
    for quad in mine:
        assert any(ours.quads_for_pattern(quad.subject, NamedNode(RDFS + "isDefinedBy"), None, None))
        assert any(store.quads_for_pattern(quad.object, NamedNode(RDF + "type"), None))
        notes = list(store.quads_for_pattern(quad.subject, NamedNode(SKOS + "editorialNote"), None))
        assert len(notes) == 1
        assert notes[0].object.value.endswith(".")


@pytest.mark.parametrize("name", MAPPED)
def test_a_file_declares_no_term_that_it_does_not_use(name):
    store = alone(name)
    declared = {q.subject for q in store.quads_for_pattern(None, NamedNode(RDF + "type"), None)}
    used = {q.object for q in store}
    idle = {term.value for term in declared - used if not term.value.startswith(BASE)}
    assert idle == set()


@pytest.mark.usefixtures("java")
def test_our_classes_can_have_instances_beside_the_axioms_of_the_vocabularies(tmp_path):
    """All at once: what is consistent together is consistent for each vocabulary alone."""
    ours, classes = load_store(), set()
    for name in MAPPED:
        mapped = {q.subject for q in alone(name) if q.subject.value.startswith(BASE) and q.predicate.value in MAPPINGS}
        of_name = {
            term.value
            for term in mapped
            if any(ours.quads_for_pattern(term, NamedNode(RDF + "type"), NamedNode(OWL + "Class"), None))
        }
        assert of_name, name
        classes |= of_name
    instances = "".join(f"ex:one_{number} a <{cls}> .\n" for number, cls in enumerate(sorted(classes)))
    world, loaded = as_world(tmp_path, with_upstream(instances))
    with loaded:
        owlready2.sync_reasoner_hermit(world, debug=0)
    assert list(world.inconsistent_classes()) == []


@pytest.mark.usefixtures("java")
@pytest.mark.parametrize("name", MAPPED)
def test_what_both_sides_exclude_is_found(tmp_path, name):
    world, loaded = as_world(tmp_path, with_upstream(IMPOSSIBLE[name]))
    with loaded, pytest.raises(owlready2.OwlReadyInconsistentOntologyError):
        owlready2.sync_reasoner_hermit(world, debug=0)


@pytest.mark.usefixtures("java")
def test_an_observed_abox_is_close_to_an_observation_and_none(tmp_path):
    axiom = "trace:ObservedABox rdfs:subClassOf sosa:Observation . [] a trace:ObservedABox ."
    world, loaded = as_world(tmp_path, with_upstream(axiom))
    with loaded, pytest.raises(owlready2.OwlReadyInconsistentOntologyError):
        owlready2.sync_reasoner_hermit(world, debug=0)
