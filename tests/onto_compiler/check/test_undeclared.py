"""An undeclared class or property is reported in a namespace of which the files declare terms, and in no other."""

import pytest

from onto_compiler.check.run import check
from onto_compiler.check.settings import Settings

PREFIXES = """@prefix ex: <https://example.org/x#> .
@prefix inst: <https://example.org/i#> .
@prefix foaf: <http://xmlns.com/foaf/0.1/> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
"""
DECLARED = "ex:Bottle a owl:Class . ex:Cup a owl:Class . ex:holds a owl:ObjectProperty .\n"


def found(tmp_path, text, name="x.ttl", settings=Settings()):  # noqa: B008 - frozen
    path = tmp_path / name
    path.write_text(PREFIXES + text)
    problems = check([path], settings=settings).problems
    return [(one.code, one.severity, one.hint) for one in problems if one.code.startswith("VOC00")]


def hint(meant):
    return f"did you mean `{meant}`? Otherwise: declare the term, or correct its name"


@pytest.mark.parametrize(
    ("use", "code", "meant"),
    [
        ("inst:x a ex:Botle .", "VOC001", "ex:Bottle"),
        ("ex:Mug rdfs:subClassOf ex:Botle .", "VOC001", "ex:Bottle"),
        ("ex:Mug rdfs:subClassOf [ owl:onProperty ex:holds ; owl:someValuesFrom ex:Botle ] .", "VOC001", "ex:Bottle"),
        ("ex:Mug rdfs:subClassOf [ owl:onProperty ex:hold ; owl:someValuesFrom ex:Cup ] .", "VOC001", "ex:holds"),
        ("ex:p a rdf:Property ; rdfs:domain ex:Cupp .", "VOC001", "ex:Cup"),
        ("ex:p a rdf:Property ; rdfs:range ex:Cupp .", "VOC001", "ex:Cup"),
        ("ex:p a rdf:Property ; rdfs:subPropertyOf ex:hold .", "VOC001", "ex:holds"),
        ("inst:x ex:hold inst:y .", "VOC002", "ex:holds"),
        ("ex:S a sh:NodeShape ; sh:targetClass ex:Cupp .", "VOC001", "ex:Cup"),
        ("[] sh:path ex:hold ; sh:minCount 1 .", "VOC001", "ex:holds"),
    ],
)
def test_a_misspelt_class_or_property_is_a_warning_with_what_was_meant(tmp_path, use, code, meant):
    assert found(tmp_path, DECLARED + use) == [(code, "warning", hint(meant))]


@pytest.mark.parametrize(
    "use",
    [
        "inst:x a ex:Cup ; ex:holds ex:anotherOne , ex:thing1 .",  # individuals share the namespace
        "inst:x a inst:Thing ; inst:p inst:y .",  # instances alone
        "inst:x a foaf:Persn ; foaf:nam 'x' . foaf:Person a owl:Class . foaf:name a owl:DatatypeProperty .",
        "inst:x a ex:Mug . ex:Mug rdfs:label 'mug' .",  # described, if not declared
        "inst:x a ex:A , ex:C , ex:D , ex:E .",  # more undeclared than declared: the ontology is elsewhere
        "inst:x rdfs:seeAlso ex:Botle .",  # no class or property there
        "<https://example.org/x> a owl:Ontology ; owl:imports <https://example.org/more> . inst:x a ex:Mug .",
        "<https://example.org/x> owl:imports <https://raw.githubusercontent.com/a/b/c.ttl> . inst:x a ex:Mug .",
        "<https://example.org/x> owl:imports <more.ttl> . inst:x a ex:Mug .",
    ],
)
def test_what_may_be_right_is_not_reported(tmp_path, use):
    assert found(tmp_path, DECLARED + use) == []


def test_a_known_vocabulary_that_is_not_here_excuses_nothing(tmp_path):
    header = "<https://example.org/x> a owl:Ontology ; owl:imports <http://www.w3.org/2004/02/skos/core> .\n"
    assert found(tmp_path, DECLARED + header + "inst:x a ex:Botle .") == [("VOC001", "warning", hint("ex:Bottle"))]


def test_the_path_of_a_shape_describes_a_property_where_none_is_declared(tmp_path):
    shape = "ex:Cup a owl:Class , sh:NodeShape ; sh:property [ sh:path ex:size ; sh:minCount 1 ] . ex:c ex:size 1"
    assert found(tmp_path, shape + " .") == []
    assert [one[0] for one in found(tmp_path, shape + " ; ex:sise 2 .")] == ["VOC002"]


@pytest.mark.parametrize("mapped", [True, False])
def test_the_terms_of_an_import_count(tmp_path, mapped):
    upper = tmp_path / "upper.ttl"
    upper.write_text(f"{PREFIXES}<https://example.org/x> a owl:Ontology .\n{DECLARED}")
    settings = Settings(imports=(("https://example.org/x", upper),) if mapped else ())
    data = (
        "<https://example.org/data> a owl:Ontology ; owl:imports <https://example.org/x> . inst:x a ex:Botle , ex:Cup ."
    )
    expected = [("VOC001", "warning", hint("ex:Bottle"))] if mapped else []
    assert found(tmp_path, data, "data.ttl", settings) == expected


def test_it_can_be_ignored_and_made_an_error(tmp_path):
    use = DECLARED + "inst:x a ex:Botle ."
    assert found(tmp_path, use, settings=Settings(ignore=("VOC001",))) == []
    severe = Settings(severity=(("VOC001", "error"),))
    assert [one[1] for one in found(tmp_path, use, settings=severe)] == ["error"]
