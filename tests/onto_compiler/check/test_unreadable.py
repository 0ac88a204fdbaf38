"""A file that cannot be read hides nothing of the others that it could not have declared."""

import pytest

from onto_compiler.check.run import check

GOOD = """@prefix x: <https://example.org/x#> .
@prefix man: <https://w3id.org/onto-evwm/manipulation#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
<https://example.org/x> a owl:Ontology ;
    owl:imports <https://w3id.org/onto-evwm/manipulation> , <https://example.org/y> .
x:A a owl:Klass ; rdfs:subClassOf x:Elsewhere ; rdfs:isDefinedBy <https://example.org/x> .
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "good.ttl").write_text(GOOD)
    return tmp_path


def codes(folder):
    return {(problem.file.rpartition("/")[2], problem.code) for problem in check([folder]).problems}


def test_a_broken_file_hides_no_problem_of_another(folder):
    (folder / "broken.ttl").write_text("@prefix x: <#> .\nx:a x:b\n")
    found = codes(folder)
    assert {name for name, _ in found} == {"broken.ttl", "good.ttl"}
    assert {("good.ttl", "VOC011"), ("good.ttl", "DOC001"), ("good.ttl", "OWL002")} <= found
    assert not {code for _, code in found} & {"VOC001", "OWL003"}, "the broken file may declare them"


def test_a_dangling_link_hides_no_problem_of_another(folder):
    (folder / "link.ttl").symlink_to(folder / "gone.ttl")
    assert ("good.ttl", "VOC011") in codes(folder)
    assert any(code == "TTL002" for _, code in codes(folder))


def test_without_a_broken_file_everything_is_told(folder):
    assert {("good.ttl", "VOC001"), ("good.ttl", "OWL003")} <= codes(folder)
