"""Which axioms lie in OWL 2 DL and in OWL 2 RL, one construct at a time."""

import pytest

from onto_compiler.check.model import load_model
from onto_compiler.check.profile_dl import check_dl
from onto_compiler.check.profile_rl import check_rl

HEAD = """@prefix : <https://e.org/> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
"""
IN_DL = {
    "a class that is an individual": ":A a owl:Class , :B . :B a owl:Class .",
    "a simple functional property": ":p a owl:ObjectProperty , owl:FunctionalProperty ; rdfs:subPropertyOf :q . "
    ":q a owl:TransitiveProperty .",
    "a chain that ends in its outcome": ":p owl:propertyChainAxiom ( :q :p ) .",
    "a chain that is transitivity": ":p owl:propertyChainAxiom ( :p :p ) .",
    "a chain of narrower properties": ":p owl:propertyChainAxiom ( :q :q ) . :q rdfs:subPropertyOf :p .",
    "a datatype and a thing": ":p rdfs:domain owl:Thing ; rdfs:range rdfs:Literal .",
    "the domain of an annotation": ":p a owl:AnnotationProperty ; rdfs:domain owl:Ontology .",
    "a whole restriction": ":A rdfs:subClassOf [ a owl:Restriction ; owl:onProperty :p ; owl:minCardinality 2 ] .",
    "an empty list": ":A owl:oneOf () .",
}
OUTSIDE_DL = {
    "no property": (":A rdfs:subClassOf [ a owl:Restriction ; owl:minCardinality 2 ] .", "OWL011"),
    "no filler": (":A rdfs:subClassOf [ a owl:Restriction ; owl:onProperty :p ] .", "OWL011"),
    "no list": (":A owl:unionOf :B .", "OWL011"),
    "a list cut off": (":A owl:unionOf [ rdf:first :B ] .", "OWL011"),
    "a circular list": (":A owl:unionOf _:l . _:l rdf:first :B ; rdf:rest _:l .", "OWL011"),
    "a list with two heads": (":A owl:unionOf [ rdf:first :B , :C ; rdf:rest () ] .", "OWL011"),
    "two sorts of property": (":p a owl:ObjectProperty , owl:DatatypeProperty .", "OWL012"),
    "a class and a datatype": (":A a owl:Class , rdfs:Datatype .", "OWL012"),
    "a reserved superclass": (":A rdfs:subClassOf rdfs:Resource .", "OWL013"),
    "a reserved subclass": ("owl:Class rdfs:subClassOf :A .", "OWL013"),
    "functional and transitive": (":p a owl:FunctionalProperty , owl:TransitiveProperty .", "OWL014"),
    "above a transitive one": (
        ":q a owl:TransitiveProperty ; rdfs:subPropertyOf :p . :p a owl:AsymmetricProperty .",
        "OWL014",
    ),
    "inverse of a transitive one": (
        ":q a owl:TransitiveProperty ; owl:inverseOf :p . :p a owl:FunctionalProperty .",
        "OWL014",
    ),
    "counted and chained": (
        ":p owl:propertyChainAxiom ( :q :r ) . :A rdfs:subClassOf [ owl:onProperty :p ; owl:maxCardinality 1 ] .",
        "OWL014",
    ),
    "disjoint and transitive": (":p a owl:TransitiveProperty ; owl:propertyDisjointWith :q .", "OWL014"),
    "in the middle of its chain": (":p owl:propertyChainAxiom ( :q :p :r ) .", "OWL015"),
    "at both ends of its chain": (":p owl:propertyChainAxiom ( :p :q :p ) .", "OWL015"),
    "two chains in a circle": (":p owl:propertyChainAxiom ( :q :r ) . :q owl:propertyChainAxiom ( :p :r ) .", "OWL015"),
    "a chain of wider properties": (":p owl:propertyChainAxiom ( :q :r ) ; rdfs:subPropertyOf :q .", "OWL015"),
}
ON = "[ a owl:Restriction ; owl:onProperty :p ; "
IN_RL = {
    "some below": ON + "owl:someValuesFrom :A ] rdfs:subClassOf :B .",
    "some of a union below": ON + "owl:someValuesFrom [ owl:unionOf ( :A :C ) ] ] rdfs:subClassOf :B .",
    "union below": "[ owl:unionOf ( :A :B ) ] rdfs:subClassOf :C .",
    "only above": f":A rdfs:subClassOf {ON} owl:allValuesFrom :B ] .",
    "at most one above": f":A rdfs:subClassOf {ON} owl:maxCardinality 1 ] .",
    "not above": ":A rdfs:subClassOf [ owl:complementOf :B ] .",
    "an intersection": f":A owl:equivalentClass [ owl:intersectionOf ( :B {ON} owl:hasValue :x ] ) ] .",
}
OUTSIDE_RL = {
    "some above": f":A rdfs:subClassOf {ON} owl:someValuesFrom :B ] .",
    "some in an intersection above": f":A rdfs:subClassOf [ owl:intersectionOf ( :B {ON} owl:someValuesFrom :B ] ) ] .",
    "union above": ":A rdfs:subClassOf [ owl:unionOf ( :B :C ) ] .",
    "one of above": ":A rdfs:subClassOf [ owl:oneOf ( :x ) ] .",
    "only below": ON + "owl:allValuesFrom :A ] rdfs:subClassOf :B .",
    "not below": "[ owl:complementOf :A ] rdfs:subClassOf :B .",
    "not within not": ":A rdfs:subClassOf [ owl:complementOf [ owl:complementOf :B ] ] .",
    "at most two": f":A rdfs:subClassOf {ON} owl:maxCardinality 2 ] .",
    "at least one": f":A rdfs:subClassOf {ON} owl:minCardinality 1 ] .",
    "exactly one": f":A rdfs:subClassOf {ON} owl:cardinality 1 ] .",
    "at most one below": ON + "owl:maxCardinality 1 ] rdfs:subClassOf :A .",
    "itself": f":A rdfs:subClassOf {ON} owl:hasSelf true ] .",
    "a union as a range": ":p rdfs:range [ owl:unionOf ( :A :B ) ] .",
    "a disjoint union": ":A owl:disjointUnionOf ( :B :C ) .",
    "reflexive": ":p a owl:ReflexiveProperty .",
}


def codes(tmp_path, check, text):
    path = tmp_path / "x.ttl"
    path.write_text(HEAD + text)
    return [finding.code for finding in check(load_model([path]))]


@pytest.mark.parametrize("text", IN_DL.values(), ids=IN_DL)
def test_what_owl_2_dl_has_is_not_told(tmp_path, text):
    assert codes(tmp_path, check_dl, text) == []


@pytest.mark.parametrize(("text", "code"), OUTSIDE_DL.values(), ids=OUTSIDE_DL)
def test_what_owl_2_dl_leaves_out_is_told(tmp_path, text, code):
    assert set(codes(tmp_path, check_dl, text)) == {code}


@pytest.mark.parametrize("text", IN_RL.values(), ids=IN_RL)
def test_what_owl_2_rl_has_is_not_told(tmp_path, text):
    assert codes(tmp_path, check_rl, text) == []


@pytest.mark.parametrize("text", OUTSIDE_RL.values(), ids=OUTSIDE_RL)
def test_what_owl_2_rl_leaves_out_is_told_once(tmp_path, text):
    assert codes(tmp_path, check_rl, text) == ["OWL016"]


def test_the_shipped_ontology_lies_in_both():
    model = load_model()
    assert [*check_dl(model), *check_rl(model)] == []
