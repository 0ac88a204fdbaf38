"""Each kind of contradiction of OWL 2 RL is found and named by its axioms; what holds is derived and nothing else."""

import pytest
from pyoxigraph import NamedNode, RdfFormat, Store

from onto_compiler.reasoning.axioms import TYPE, read_axioms
from onto_compiler.reasoning.closure import close

HEAD = """
@prefix : <https://e.org/> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .
:A a owl:Class . :B a owl:Class . :C a owl:Class . :p a owl:ObjectProperty . :q a owl:ObjectProperty .
"""
APART = ":A owl:disjointWith :B . "
CLASHES = {
    "nothing": ":x a :A . :A rdfs:subClassOf owl:Nothing .",
    "disjoint": APART + ":x a :A , :B .",
    "all disjoint": "[] a owl:AllDisjointClasses ; owl:members ( :A :C :B ) . :x a :A , :B .",
    "disjoint union": ":C owl:disjointUnionOf ( :A :B ) . :x a :A , :B .",
    "complement": ":A owl:complementOf :B . :x a :A , :B .",
    "subclass": APART + ":C rdfs:subClassOf :B . :x a :A , :C .",
    "equivalent": APART + ":B owl:equivalentClass :C . :x a :A , :C .",
    "intersection": APART + ":C owl:intersectionOf ( :A :B ) . :x a :C .",
    "into an intersection": ":C owl:intersectionOf ( :A :B ) ; owl:disjointWith :D . :x a :A , :B , :D .",
    "union": "[] owl:unionOf ( :A :B ) ; rdfs:subClassOf :C . :C owl:disjointWith :A . :x a :A .",
    "one of": APART + ":A owl:oneOf ( :x :y ) . :x a :B .",
    "domain": APART + ":p rdfs:domain :A . :x :p :y ; a :B .",
    "range": APART + ":p rdfs:range :A . :x :p :y . :y a :B .",
    "subproperty": APART + ":q rdfs:subPropertyOf :p . :p rdfs:domain :A . :x :q :y ; a :B .",
    "inverse": APART + ":q owl:inverseOf :p . :p rdfs:domain :A . :y :q :x . :x a :B .",
    "symmetric": APART + ":p a owl:SymmetricProperty ; rdfs:domain :A . :y :p :x . :x a :B .",
    "only": APART + ":C rdfs:subClassOf [ owl:onProperty :p ; owl:allValuesFrom :A ] . :x a :C ; :p :y . :y a :B .",
    "some": "[ owl:onProperty :p ; owl:someValuesFrom :A ] rdfs:subClassOf owl:Nothing . :x :p :y . :y a :A .",
    "some thing": "[ owl:onProperty :p ; owl:someValuesFrom owl:Thing ] rdfs:subClassOf owl:Nothing . :x :p :y .",
    "has value": APART
    + ":C rdfs:subClassOf [ owl:onProperty :p ; owl:hasValue :v ] . :p rdfs:domain :A . :x a :C , :B .",
    "of a value": "[ owl:onProperty :p ; owl:hasValue :v ] rdfs:subClassOf owl:Nothing . :x :p :v .",
    "at most none": ":C rdfs:subClassOf [ owl:onProperty :p ; owl:maxCardinality 0 ] . :x a :C ; :p :y .",
    "at most one": ":C rdfs:subClassOf [ owl:onProperty :p ; owl:maxCardinality 1 ] . :y owl:differentFrom :z . "
    ":x a :C ; :p :y , :z .",
    "at most one of": ":C rdfs:subClassOf [ owl:onProperty :p ; owl:maxQualifiedCardinality 1 ; owl:onClass :A ] . "
    ":y owl:differentFrom :z ; a :A . :z a :A . :x a :C ; :p :y , :z .",
    "functional": ":p a owl:FunctionalProperty . :x :p :y , :z . "
    " [] a owl:AllDifferent ; owl:distinctMembers ( :y :z ) .",
    "two literals": ":p a owl:FunctionalProperty . :x :p 1 , 2 .",
    "inverse functional": ":p a owl:InverseFunctionalProperty . :y owl:differentFrom :z . :y :p :x . :z :p :x .",
    "same": APART + ":x a :A . :y a :B . :x owl:sameAs :y .",
    "transitive": ":p a owl:TransitiveProperty , owl:IrreflexiveProperty . :x :p :y . :y :p :x .",
    "asymmetric": ":p a owl:AsymmetricProperty . :x :p :y . :y :p :x .",
    "disjoint properties": ":p owl:propertyDisjointWith :q . :x :p :y ; :q :y .",
    "negative": "[] owl:sourceIndividual :x ; owl:assertionProperty :p ; owl:targetIndividual :y . :x :p :y .",
}
HOLD = {
    "another class": APART + ":x a :A . :y a :B .",
    "half an intersection": ":C owl:intersectionOf ( :A :B ) ; owl:disjointWith :A . :x a :A .",
    "an open world": ":C rdfs:subClassOf [ owl:onProperty :p ; owl:someValuesFrom :A ] . :x a :C .",
    "two names for one": ":C rdfs:subClassOf [ owl:onProperty :p ; owl:maxCardinality 1 ] . :x a :C ; :p :y , :z .",
    "at most one of another class": ":C rdfs:subClassOf [ owl:onProperty :p ; owl:maxQualifiedCardinality 1 ; "
    "owl:onClass :A ] . :y owl:differentFrom :z ; a :A . :x a :C ; :p :y , :z .",
    "one way": ":p a owl:AsymmetricProperty . :x :p :y . :y :p :z .",
    "equal twice": ":x owl:sameAs :y . :y owl:sameAs :z . :z a :A .",
}


def closed(text):
    store = Store()
    store.load((HEAD + text).encode(), format=RdfFormat.TURTLE)
    closure = close(read_axioms(store), [(quad.subject, quad.predicate, quad.object) for quad in store])
    return store, closure


@pytest.mark.parametrize("text", CLASHES.values(), ids=CLASHES.keys())
def test_a_contradiction_is_found_and_traced_to_what_is_written(text):
    store, closure = closed(text)
    assert closure.clashes
    written = {(quad.subject, quad.predicate, quad.object) for quad in store}
    for clash in closure.clashes:
        given = closure.given(clash.premises)
        assert given
        assert set(given) <= written, "an explanation names what a person wrote, and nothing derived"


@pytest.mark.parametrize("text", CLASHES.values(), ids=CLASHES.keys())
def test_without_any_one_of_the_named_triples_the_contradiction_is_gone(text):
    """The explanation is minimal where it is the only one."""
    store, closure = closed(text)
    explanations = {frozenset(closure.given(clash.premises)) for clash in closure.clashes}
    if len(explanations) > 1:
        assert len(explanations) <= 4
        return
    (explanation,) = explanations
    kept = [(quad.subject, quad.predicate, quad.object) for quad in store]
    for removed in explanation:
        smaller = Store()
        for quad in store:
            if (quad.subject, quad.predicate, quad.object) != removed:
                smaller.add(quad)
        facts = [fact for fact in kept if fact != removed]
        assert close(read_axioms(smaller), facts).clashes == []


@pytest.mark.parametrize("text", HOLD.values(), ids=HOLD.keys())
def test_what_can_hold_is_no_contradiction(text):
    assert closed(text)[1].clashes == []


def test_what_is_same_shares_its_types():
    _, closure = closed(HOLD["equal twice"])
    for name in "xyz":
        assert NamedNode("https://e.org/A") in closure.types[NamedNode(f"https://e.org/{name}")]
    assert (NamedNode("https://e.org/x"), TYPE, NamedNode("https://e.org/B")) not in closure.premises


def test_the_corpora_are_complete():
    assert len(CLASHES) == 32
    assert len(HOLD) == 7
