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
        "  breaking: removed class https://example.org/e#A\n"
        "  breaking: changed unit of predicate man:near: core:marginUnit unit:M -> unit:N\n"
        "  added class https://example.org/e#B\n"
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
    assert lines.index("- removed class `https://example.org/e#A`") < lines.index("### Other")
    assert lines[-1] == "**The version must be raised from 1.0.0.**"
