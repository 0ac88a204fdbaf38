"""A comment suppresses the codes that it names, on its line or of its statement; one without effect is told."""

import pytest

from onto_compiler.check.run import check
from onto_compiler.check.settings import Settings

TEXT = """@prefix x: <https://example.org/x#> .
@prefix man: <https://w3id.org/onto-evwm/manipulation#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix skos: <http://www.w3.org/2004/02/skos/core#> .
@prefix dcterms: <http://purl.org/dc/terms/> .
<https://example.org/x> a owl:Ontology ; dcterms:title "x"@en ; dcterms:license <https://l.example/> ;
    owl:imports <https://w3id.org/onto-evwm/manipulation> ; owl:versionInfo "1" .
{above}
x:A a owl:Class ; rdfs:subClassOf man:Object ;
    rdfs:label "a"@en ;{inside}
    skos:definition "{text}"@en ;{beside}
    rdfs:isDefinedBy <https://example.org/x> .
x:B a owl:Class ; rdfs:subClassOf man:Object ; rdfs:label "b"@en ; skos:definition "{other}"@en ;
    rdfs:isDefinedBy <https://example.org/x> .
"""


def found(tmp_path, settings=Settings(), **parts):  # noqa: B008 - frozen
    path = tmp_path / "x.ttl"
    blank = {"above": "", "inside": "", "beside": "", "text": "no stop", "other": "A stop."}
    text = TEXT
    for name, part in {**blank, **parts}.items():
        text = text.replace(f"{{{name}}}", part)
    path.write_text(text)
    return sorted((problem.code, problem.line) for problem in check([path], settings=settings).problems)


def test_the_problem_is_there_without_a_comment(tmp_path):
    assert found(tmp_path) == [("DOC004", 12)]


@pytest.mark.parametrize("comment", ["# onto: ignore[DOC004]", "#onto:ignore[ doc004 ]", "# onto: ignore[DOC] why not"])
def test_a_comment_speaks_of_its_line_or_its_statement(comment, tmp_path):
    assert found(tmp_path, beside=f"  {comment}") == []
    assert found(tmp_path, inside=f"\n    {comment}") == []
    assert found(tmp_path, above=comment) == []


def test_another_line_and_another_statement_are_reported_still(tmp_path):
    comment = "  # onto: ignore[DOC004]"
    assert found(tmp_path, inside=comment) == [("CFG002", 11), ("DOC004", 12)]
    assert found(tmp_path, above=comment, other="no stop either") == [("DOC004", 14)]


@pytest.mark.parametrize(
    "comment", ["# onto: ignore", "# onto: ignore[]", "# onto: ignore[DOC0004]", "# onto: ignore[DOC003]"]
)
def test_a_comment_without_effect_is_told(comment, tmp_path):
    assert found(tmp_path, beside=f" {comment}") == [("CFG002", 12), ("DOC004", 12)]


def test_each_code_of_a_comment_must_have_an_effect(tmp_path):
    assert found(tmp_path, beside=" # onto: ignore[DOC004, DOC003]") == [("CFG002", 12)]
    assert found(tmp_path, Settings(ignore=("DOC003",)), beside=" # onto: ignore[DOC004, DOC003]") == []


def test_what_stands_in_a_string_suppresses_nothing(tmp_path):
    assert found(tmp_path, text="see # onto: ignore[DOC004]") == [("DOC004", 12)]
