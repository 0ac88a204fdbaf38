"""Circles and impossible classes are found without looking at every pair of classes."""

from onto_compiler.check.hierarchy import check_hierarchy
from onto_compiler.check.model import load_model
from onto_compiler.compile_schema import compile_schema
from onto_compiler.hierarchy import Hierarchy

HEAD = """@prefix : <https://e.org/> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix man: <https://w3id.org/onto-evwm/manipulation#> .
"""


def found(tmp_path, text):
    path = tmp_path / "x.ttl"
    path.write_text(HEAD + text)
    return {
        (one.code, one.subject.value.rpartition("/")[2], one.object.value.rpartition("/")[2])
        for one in check_hierarchy(load_model([path]))
    }


def test_each_edge_of_a_circle_is_told_and_no_other(tmp_path):
    circle = ":A rdfs:subClassOf :B . :B rdfs:subClassOf :C . :C rdfs:subClassOf :A , :D . :E rdfs:subClassOf :A ."
    assert found(tmp_path, circle) == {("OWL004", "A", "B"), ("OWL004", "B", "C"), ("OWL004", "C", "A")}
    assert found(tmp_path, ":A rdfs:subClassOf :A .") == {("OWL004", "A", "A")}


def test_a_class_under_two_members_of_a_list_is_told_and_so_are_its_subclasses(tmp_path):
    text = (
        "[] a owl:AllDisjointClasses ; owl:members ( :A :B :C ) . :D rdfs:subClassOf :A , :E . :E rdfs:subClassOf :C ."
    )
    assert found(tmp_path, text + ":F rdfs:subClassOf :D .") == {("OWL006", "D", "E"), ("OWL006", "F", "D")}


def test_a_class_that_is_disjoint_with_its_superclass_is_told_whichever_comes_first(tmp_path):
    assert found(tmp_path, ":A owl:disjointWith :B ; rdfs:subClassOf :B .") == {("OWL006", "A", "B")}
    assert found(tmp_path, ":B owl:disjointWith :A ; rdfs:subClassOf :A .") == {("OWL006", "B", "A")}


def test_a_deep_chain_is_walked_once_for_each_class_that_is_asked_for(tmp_path):
    path = tmp_path / "chain.ttl"
    chain = "".join(f":C{number} a owl:Class ; rdfs:subClassOf :C{number - 1} .\n" for number in range(1, 1000))
    path.write_text(HEAD + ":C0 a owl:Class ; rdfs:subClassOf man:Object .\n" + chain)
    classes = compile_schema(load_model([path]).store).classes
    assert isinstance(classes, Hierarchy)
    assert classes._known == {}
    assert len(classes["https://e.org/C999"]) > 1000


def test_a_hierarchy_passes_through_what_has_no_name():
    classes = Hierarchy(["a", "c"], {"a": ["_:b"], "_:b": ["c"], "c": ["a"]})
    assert dict(classes) == {"a": {"a", "c"}, "c": {"a", "c"}}
    assert "b" not in classes
    assert len(classes) == 2
