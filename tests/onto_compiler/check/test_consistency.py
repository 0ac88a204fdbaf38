"""Classes that are held apart from themselves or from everything, which no pair of classes shows."""

import pytest

from onto_compiler.check.run import check

HEAD = """@prefix dcterms: <http://purl.org/dc/terms/> .
@prefix ex: <https://example.org/kitchen#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix skos: <http://www.w3.org/2004/02/skos/core#> .
<https://example.org/kitchen> a owl:Ontology ;
    dcterms:title "Kitchen"@en ;
    dcterms:license <https://spdx.org/licenses/MIT> ;
    owl:versionInfo "0.1.0" .
ex:Fork a owl:Class ; rdfs:label "fork"@en ; skos:definition "A fork."@en ;
    rdfs:isDefinedBy <https://example.org/kitchen> .
ex:fork a owl:NamedIndividual , ex:Fork ; rdfs:label "one fork"@en ; skos:definition "One fork."@en ;
    rdfs:isDefinedBy <https://example.org/kitchen> .
ex:Spoon a owl:Class ; rdfs:label "spoon"@en ; skos:definition "A spoon."@en ;
    rdfs:isDefinedBy <https://example.org/kitchen> .
ex:beside a owl:ObjectProperty ; rdfs:label "beside"@en ; skos:definition "Lies beside."@en ;
    rdfs:isDefinedBy <https://example.org/kitchen> .
"""


def found(tmp_path, axiom):
    file = tmp_path / "kitchen.ttl"
    file.write_text(HEAD + axiom + "\n")
    return [(problem.code, problem.message.partition("` ")[0].removeprefix("`")) for problem in check([file]).problems]


@pytest.mark.parametrize(
    "axiom",
    [
        "ex:Spoon owl:disjointWith ex:Spoon .",
        "ex:Spoon owl:disjointWith owl:Thing .",
        "ex:Spoon owl:complementOf ex:Spoon .",
        "ex:Spoon rdfs:subClassOf [ a owl:Class ; owl:complementOf owl:Thing ] .",
        "[] a owl:AllDisjointClasses ; owl:members ( ex:Spoon ex:Fork ex:Spoon ) .",
    ],
)
def test_a_class_apart_from_itself_or_from_everything_can_have_no_instance(tmp_path, axiom):
    assert found(tmp_path, axiom) == [("OWL010", "ex:Spoon")]


@pytest.mark.parametrize("axiom", ["owl:Thing rdfs:subClassOf owl:Nothing .", "owl:Thing owl:disjointWith owl:Thing ."])
def test_where_nothing_can_exist_it_is_said_once(tmp_path, axiom):
    assert found(tmp_path, axiom) == [("OWL010", "owl:Thing")]


@pytest.mark.parametrize(
    "axiom",
    [
        "ex:Spoon owl:disjointWith ex:Fork .",
        "[] a owl:AllDisjointClasses ; owl:members ( ex:Spoon ex:Fork ) .",
        "ex:Spoon rdfs:subClassOf owl:Thing .",
        "ex:Spoon owl:disjointUnionOf ( ex:Fork ) .",
    ],
)
def test_a_class_apart_from_another_is_not_taken_for_empty(tmp_path, axiom):
    assert "OWL010" not in {code for code, _ in found(tmp_path, axiom)}


def test_instances_and_statements_that_an_axiom_excludes_are_contradictions(tmp_path):
    beside = "ex:fork ex:beside ex:fork . ex:beside owl:propertyDisjointWith ex:beside ."
    for axiom in ("ex:fork owl:differentFrom ex:fork .", "ex:Fork owl:disjointWith owl:Thing .", beside):
        assert "OWL009" in {code for code, _ in found(tmp_path, axiom)}, axiom
