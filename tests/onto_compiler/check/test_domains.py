"""A value outside a domain or range is found by whichever axiom tells that it is outside, and only then."""

import pytest

from onto_compiler.check.run import check
from onto_compiler.check.settings import Settings

ASKED = Settings(select=("VOC004", "VOC005"))  # of other people's terms, that is house style
HEADER = """@prefix x: <https://example.org/x#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
<https://example.org/x> a owl:Ontology .
x:Cup a owl:Class . x:Bowl a owl:Class . x:Mug a owl:Class ; rdfs:subClassOf x:Cup . x:Arm a owl:Class .
x:p a owl:ObjectProperty . x:mug a x:Mug ; x:p x:mug . x:arm a x:Arm ; x:p x:arm .
"""


def codes(tmp_path, text):
    path = tmp_path / "x.ttl"
    path.write_text(HEADER + text)
    return [
        (one.code, one.message) for one in check([path], settings=ASKED).problems if one.code in {"VOC004", "VOC005"}
    ]


@pytest.mark.parametrize(
    ("declared", "outside"),
    [
        ("x:p rdfs:domain x:Cup .", ["x:arm"]),
        ("x:p rdfs:domain x:Bowl .", ["x:arm", "x:mug"]),
        ("x:p rdfs:domain [ a owl:Class ; owl:unionOf ( x:Cup x:Bowl ) ] .", ["x:arm"]),
        ("x:p rdfs:domain [ a owl:Class ; owl:unionOf ( x:Cup x:Arm ) ] .", []),
        ("x:p rdfs:domain [ owl:unionOf ( x:Bowl [ owl:unionOf ( x:Cup x:Arm ) ] ) ] .", []),
        ("x:p rdfs:domain [ owl:unionOf ( x:Bowl [ owl:complementOf x:Bowl ] ) ] .", []),
        ("x:p rdfs:domain [ owl:intersectionOf ( x:Cup [ owl:complementOf x:Bowl ] ) ] .", ["x:arm"]),
        ("x:p rdfs:domain [ a owl:Restriction ; owl:onProperty x:p ; owl:someValuesFrom x:Cup ] .", []),
        ("x:p rdfs:domain [ owl:oneOf ( x:mug ) ] .", []),
        ("x:p rdfs:domain owl:Thing .", []),
        ("x:p rdfs:domain x:Any . x:Any a owl:Class ; owl:equivalentClass [ owl:unionOf ( x:Cup x:Arm ) ] .", []),
        ("x:p rdfs:domain x:Any . x:Any a owl:Class ; owl:disjointUnionOf ( x:Cup x:Arm ) .", []),
        ("x:p rdfs:domain x:Tool . x:Tool a owl:Class ; owl:equivalentClass x:Arm .", ["x:mug"]),
        ("x:p rdfs:domain x:Cup . x:Arm owl:equivalentClass [ owl:intersectionOf ( x:Cup x:Bowl ) ] .", []),
        ("x:p rdfs:domain x:Cup . x:Arm rdfs:subClassOf <https://elsewhere.org/Thing> .", []),
    ],
)
def test_a_subject_is_in_the_domain_by_any_axiom(declared, outside, tmp_path):
    found = codes(tmp_path, declared)
    assert sorted(message.split("`")[1] for _, message in found) == outside
    assert {code for code, _ in found} <= {"VOC005"}
    ranged = codes(tmp_path, declared.replace("rdfs:domain", "rdfs:range"))
    assert sorted(message.split("`")[1] for _, message in ranged) == outside
    assert {code for code, _ in ranged} <= {"VOC004"}


@pytest.mark.parametrize("kind", ["owl:DatatypeProperty", "owl:ObjectProperty", "owl:FunctionalProperty"])
def test_a_property_of_properties_describes_every_kind_of_property(kind, tmp_path):
    text = "x:note a owl:AnnotationProperty ; rdfs:domain rdf:Property . x:q a {} ; x:note 1 . x:Cup x:note 1 ."
    assert [message.split("`")[1] for _, message in codes(tmp_path, text.format(kind))] == ["x:Cup"]


def test_a_property_of_a_union_of_kinds_of_property(tmp_path):
    domain = "[ a owl:Class ; owl:unionOf ( owl:DatatypeProperty owl:ObjectProperty ) ]"
    text = f"x:note a owl:AnnotationProperty ; rdfs:domain {domain} . x:q a owl:DatatypeProperty ; x:note 1 ."
    assert codes(tmp_path, text) == []
