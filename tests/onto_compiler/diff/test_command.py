"""What ``onto diff`` prints: sentences, JSON, and Markdown for a changelog."""

import json

import pytest

from onto_compiler.command import CLEAN, FINDINGS
from runtime.cli import main

HEAD = """
@prefix core: <https://w3id.org/onto-evwm/core#> . @prefix man: <https://w3id.org/onto-evwm/manipulation#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> . @prefix unit: <http://qudt.org/vocab/unit/> .
@prefix ex: <https://example.org/e#> . <https://example.org/e> a owl:Ontology ; owl:versionInfo "1.0.0" .
"""
OLD = HEAD + "ex:A a owl:Class . man:near a man:ObjectRelation ; core:marginUnit unit:M ; core:priority 1 ."
NEW = HEAD + "ex:B a owl:Class . man:near a man:ObjectRelation ; core:marginUnit unit:N ; core:priority 2 ."


@pytest.fixture
def pair(tmp_path):
    (tmp_path / "old.ttl").write_text(OLD)
    (tmp_path / "new.ttl").write_text(NEW)
    return [str(tmp_path / "old.ttl"), str(tmp_path / "new.ttl")]


def test_text_is_one_sentence_a_change_and_what_breaks_comes_first(pair, capsys):
    assert main(["diff", *pair]) == FINDINGS
    assert capsys.readouterr().out == (
        "https://example.org/e, version 1.0.0\n"
        "  breaking: removed class ex:A\n"
        "  breaking: changed unit of predicate man:near: core:marginUnit unit:M -> unit:N\n"
        "  added class ex:B\n"
        "  changed priority of predicate man:near: core:priority 1 -> 2\n"
        "  the version must be raised: 2 breaking changes\n"
    )


def test_no_change_is_said(pair, capsys):
    assert main(["diff", pair[0], pair[0]]) == CLEAN
    assert capsys.readouterr().out == "no term changed\n"


def test_json_holds_every_change(pair, capsys):
    assert main(["diff", *pair, "--json"]) == FINDINGS
    record = json.loads(capsys.readouterr().out)
    assert record["ok"] is False
    assert record["prefixes"]["ex"] == "https://example.org/e#"
    assert [(one["change"], one["facet"], one["breaking"]) for one in record["changes"]] == [
        ("removed", "", True),
        ("added", "", False),
        ("changed", "priority", False),
        ("changed", "unit", True),
    ]
    assert record["releases"] == [
        {"ontology": "https://example.org/e", "old": "1.0.0", "new": "1.0.0", "breaking": 2, "enough": False}
    ]


def test_markdown_puts_what_breaks_first(pair, capsys):
    assert main(["diff", *pair, "--format", "markdown"]) == FINDINGS
    lines = capsys.readouterr().out.splitlines()
    headings = [line for line in lines if line.startswith("#")]
    assert headings == ["## https://example.org/e, version 1.0.0", "### Breaking", "### Other"]
    assert lines.index("- removed class `ex:A`") < lines.index("### Other")
    assert lines[-1] == "**The version must be raised from 1.0.0.**"


EXPRESSIONS = {
    "[ a owl:Restriction ; owl:onProperty ex:p ; owl:someValuesFrom ex:B ]": "ex:p some ex:B",
    "[ owl:onProperty ex:p ; owl:allValuesFrom [ owl:unionOf ( ex:B ex:A ) ] ]": "ex:p only (ex:B or ex:A)",
    "[ a owl:Restriction ; owl:onProperty ex:p ; owl:hasValue 1.50 ]": "ex:p value 1.50",
    "[ a owl:Restriction ; owl:onProperty [ owl:inverseOf ex:p ] ; owl:hasSelf true ]": "inverse ex:p Self",
    "[ owl:onProperty ex:p ; owl:minQualifiedCardinality 2 ; owl:onClass ex:B ]": "ex:p min 2 ex:B",
    "[ owl:onProperty ex:p ; owl:cardinality 1 ]": "ex:p exactly 1",
    "[ owl:intersectionOf ( ex:A [ owl:complementOf [ owl:oneOf ( ex:i ex:j ) ] ] ) ]": "ex:A and (not {ex:i, ex:j})",
    "[ owl:onDatatype xsd:integer ; owl:withRestrictions ( [ xsd:minInclusive 1 ] ) ]": "xsd:integer[>= 1]",
    "[ owl:onProperty ex:p ; ex:odd ex:B ]": "[ owl:onProperty ex:p ; ex:odd ex:B ]",
    "[ owl:unionOf ( ex:A ex:B ) ; ex:note 1 ]": "[ owl:unionOf ( ex:A ex:B ) ; ex:note 1 ]",
}


@pytest.mark.parametrize(("written", "shown"), EXPRESSIONS.items())
def test_class_expressions_are_shown_in_manchester_syntax(written, shown, tmp_path, capsys):
    head = HEAD + "@prefix xsd: <http://www.w3.org/2001/XMLSchema#> . ex:C a owl:Class"
    (tmp_path / "old.ttl").write_text(f"{head} .")
    (tmp_path / "new.ttl").write_text(f"{head} ; owl:equivalentClass {written} .")
    assert main(["diff", str(tmp_path / "old.ttl"), str(tmp_path / "new.ttl"), "--json"]) == FINDINGS
    (change,) = json.loads(capsys.readouterr().out)["changes"]
    assert (change["was"], change["now"]) == ([], [shown])
    (tmp_path / "back.ttl").write_text(f"{head} ; owl:equivalentClass {change['new'][0]} .")
    assert main(["diff", str(tmp_path / "new.ttl"), str(tmp_path / "back.ttl")]) == CLEAN, "JSON holds Turtle"


LONG = "A vessel that one drinks from, with a handle, and that stands upright on a saucer most of the time"
QUERY = "CONSTRUCT { $this a ex:A }\nWHERE {\n  $this ex:p ?x .\n  FILTER (?x > 1)\n}\n"


def test_both_sides_are_legible_at_eighty_columns(tmp_path, capsys):
    head = HEAD.replace(". @prefix unit", ". @prefix skos: <http://www.w3.org/2004/02/skos/core#> . @prefix unit")
    head += "@prefix sh: <http://www.w3.org/ns/shacl#> ."
    body = f"""ex:C a owl:Class ; skos:definition "{LONG} here."@en .
ex:S a sh:NodeShape ; sh:property [ sh:path ex:p ; sh:maxCount 1 ; sh:in ( ex:a ex:b ex:c ex:d ex:e ) ; sh:node ex:S ] .
ex:r sh:construct \"\"\"{QUERY}\"\"\" ."""
    (tmp_path / "old.ttl").write_text(head + body)
    (tmp_path / "new.ttl").write_text(
        head + body.replace("here", "there").replace("maxCount 1", "maxCount 2").replace("> 1", "> 2")
    )
    assert main(["diff", str(tmp_path / "old.ttl"), str(tmp_path / "new.ttl")]) == FINDINGS
    assert (
        capsys.readouterr().out
        == """\
https://example.org/e, version 1.0.0
  breaking: changed shape of shape ex:S: sh:property
    - [ sh:path ex:p ; sh:in ( ex:a ex:b ex:c ex:d ex:e ) ; sh:maxCount 1 ;
      sh:node ex:S ]
    + [ sh:path ex:p ; sh:in ( ex:a ex:b ex:c ex:d ex:e ) ; sh:maxCount 2 ;
      sh:node ex:S ]
  changed documentation of class ex:C: skos:definition
    - "A vessel that one drinks from, with a handle, and that stands upright on
      a saucer most of the time here."@en
    + "A vessel that one drinks from, with a handle, and that stands upright on
      a saucer most of the time there."@en
  changed rule of individual ex:r: sh:construct
    ...
       $this ex:p ?x .
    -  FILTER (?x > 1)
    +  FILTER (?x > 2)
     }
  the version must be raised: 1 breaking change
"""
    )
    assert main(["diff", str(tmp_path / "old.ttl"), str(tmp_path / "new.ttl"), "--format", "markdown"]) == FINDINGS
    out = capsys.readouterr().out
    assert "  ```diff\n  ...\n     $this ex:p ?x .\n  -  FILTER (?x > 1)\n  +  FILTER (?x > 2)\n   }\n  ```\n" in out
    assert f'  + "{LONG} there."@en\n' in out


def test_a_prefix_with_two_meanings_is_not_used(tmp_path, capsys):
    moved = HEAD.replace("@prefix ex: <https://example.org/e#>", "@prefix ex: <https://example.org/f#>")
    (tmp_path / "old.ttl").write_text(HEAD + "ex:A a owl:Class .")
    (tmp_path / "new.ttl").write_text(moved + "ex:A a owl:Class .")
    main(["diff", str(tmp_path / "old.ttl"), str(tmp_path / "new.ttl")])
    out = capsys.readouterr().out
    assert "removed class https://example.org/e#A" in out
    assert "added class https://example.org/f#A" in out
