"""A literal is outside a range only where its datatype is told, and is not derived from the one that is asked for."""

import pytest

from onto_compiler.check.run import check

HEADER = """@prefix x: <https://example.org/x#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
<https://example.org/x> a owl:Ontology .
x:Code a rdfs:Datatype ; rdfs:subClassOf xsd:string . x:Short a rdfs:Datatype ; rdfs:subClassOf x:Code .
x:Percent a rdfs:Datatype ; owl:equivalentClass [
    a rdfs:Datatype ; owl:onDatatype xsd:integer ; owl:withRestrictions ( [ xsd:maxInclusive 100 ] ) ] .
x:Either a rdfs:Datatype ; owl:equivalentClass [ a rdfs:Datatype ; owl:unionOf ( xsd:string xsd:integer ) ] .
x:p a owl:DatatypeProperty .
"""


def found(tmp_path, text):
    path = tmp_path / "x.ttl"
    path.write_text(HEADER + text)
    return [one.message for one in check([path]).problems if one.code == "VOC007"]


@pytest.mark.parametrize(
    ("wanted", "value"),
    [
        ("xsd:string", '"a"^^x:Code'),
        ("xsd:string", '"a"^^x:Short'),
        ("xsd:string", '"a"^^xsd:token'),
        ("xsd:string", '"a"^^x:Unknown'),
        ("xsd:string", '"a"^^x:Either'),
        ("xsd:decimal", '"5"^^xsd:byte'),
        ("xsd:nonNegativeInteger", '"5"^^xsd:positiveInteger'),
        ("xsd:integer", '"5"^^x:Percent'),
        ("xsd:dateTime", '"2026-01-01T00:00:00Z"^^xsd:dateTimeStamp'),
        ("rdfs:Literal", "5"),
        ("rdf:PlainLiteral", '"a"@en'),
        ("x:Percent", "5"),
        ("x:Either", "5"),
        ("x:Elsewhere", "5"),
        ("[ a rdfs:Datatype ; owl:oneOf ( 1 2 ) ]", "3"),
    ],
)
def test_a_derived_datatype_and_one_that_nobody_tells_of_are_no_problem(tmp_path, wanted, value):
    assert found(tmp_path, f"x:p rdfs:range {wanted} . x:a x:p {value} .") == []


@pytest.mark.parametrize(
    ("wanted", "value", "said"),
    [
        ("xsd:string", "5", "`5` is not of the datatype `xsd:string`, which `x:p` asks for"),
        ("xsd:string", '"a"@en', "`a` is not of the datatype `xsd:string`, which `x:p` asks for"),
        ("xsd:integer", "5.0", "`5.0` is not of the datatype `xsd:integer`, which `x:p` asks for"),
        ("xsd:positiveInteger", "5", "`5` is not of the datatype `xsd:positiveInteger`, which `x:p` asks for"),
        ("xsd:integer", '"a"^^x:Short', "`a` is not of the datatype `xsd:integer`, which `x:p` asks for"),
        ("xsd:string", '"5"^^x:Percent', "`5` is not of the datatype `xsd:string`, which `x:p` asks for"),
        ("x:Short", '"a"^^x:Code', "`a` is not of the datatype `x:Short`, which `x:p` asks for"),
        ("rdfs:Literal", "x:b", "`x:b` is not a literal, which `x:p` asks for"),
    ],
)
def test_another_datatype_is_a_problem(tmp_path, wanted, value, said):
    assert found(tmp_path, f"x:p rdfs:range {wanted} . x:a x:p {value} . x:b x:p 1 .")[:1] == [said]
