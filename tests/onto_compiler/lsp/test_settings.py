"""The editor reports what ``onto check`` does on the command line: settings, suppressions and severities included."""

import argparse
import json
import shutil
import time
from pathlib import Path

import pytest

from onto_compiler.check.command import CHECK
from onto_compiler.lsp.client import Client

pytest.importorskip("pygls")
ROOT = Path(__file__).resolve().parents[3]
SEVERITIES = {1: "error", 2: "warning", 3: "info"}
PREFIXES = """\
@prefix dcterms: <http://purl.org/dc/terms/> .
@prefix ex: <https://example.org/kitchen#> .
@prefix man: <https://w3id.org/onto-evwm/manipulation#> .
@prefix nix: <https://example.org/none#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix skos: <http://www.w3.org/2004/02/skos/core#> .
"""
HEADER = """
<https://example.org/{name}> a owl:Ontology ; dcterms:title "{name}"@en ;
    owl:imports <{imports}> , <https://example.org/far> ; owl:versionInfo "0.1.0" .
"""
KITCHEN = (
    PREFIXES
    + HEADER.format(name="kitchen", imports="https://w3id.org/onto-evwm/manipulation")
    + """
ex:Spoon a owl:Class ; rdfs:label "spoon"@en ; rdfs:subClassOf ex:Ladle ; skos:definition "A spoon"@en ;
    rdfs:isDefinedBy <https://example.org/kitchen> .

# onto: ignore[DOC004]
ex:Fork a owl:Class ; rdfs:label "fork"@en ; rdfs:subClassOf man:Objekt ;
    skos:definition "A fork"@en ; rdfs:isDefinedBy <https://example.org/kitchen> .

ex:Ladle a owl:Class ; owl:deprecated true ; dcterms:isReplacedBy man:Object ; rdfs:label "ladle"@en ;
    skos:definition "A ladle."@en ; rdfs:isDefinedBy <https://example.org/kitchen> . # onto: ignore[VOC006]
"""
)
CUPS = (
    PREFIXES
    + HEADER.format(name="cups", imports="https://example.org/kitchen")
    + """
ex:Cup a owl:Class ; rdfs:label "cup"@en ; rdfs:subClassOf ex:Ladle , ex:Vessel ; skos:definition "A cup"@en .
"""
)
SETTINGS = {
    "none": "",
    "select": 'select = ["DOC", "TTL007"]',
    "ignore": 'ignore = ["DOC00", "BDDL"]',
    "severity": 'severity = { VOC006 = "error", DOC = "info", BDDL = "warning" }',
    "of files": '[tool.onto.check.per-file-ignores]\n"parts/*.ttl" = ["VOC"]\n"*.bddl" = ["BDDL003"]',
    "excluded": 'exclude = ["parts", "wrong.bddl"]',
    "imports": '[tool.onto.check.imports]\n"https://example.org/far" = "far.nt"',
    "all of it": 'select = ["ALL"]\nignore = ["DOC005", "OWL"]\nseverity = { TTL007 = "error" }',
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("kitchen")
    (place / "kitchen.ttl").write_text(KITCHEN)
    (place / "far.nt").write_text('<https://example.org/far> <http://www.w3.org/2002/07/owl#versionInfo> "1" .\n')
    (place / "parts").mkdir()
    (place / "parts" / "cups.ttl").write_text(CUPS)
    (place / "tasks").mkdir()
    shutil.copy(ROOT / "docs/examples/served.ttl", place)
    text = (ROOT / "docs/examples/serve_the_cheese.bddl").read_text()
    (place / "tasks" / "serve.bddl").write_text(text)
    (place / "tasks" / "wrong.bddl").write_text(text.replace("(Served cream", "(Srved cream"))
    return place


@pytest.fixture(scope="module")
def client(folder):
    with Client(folder=folder) as running:
        for path in sorted(folder.rglob("*.*")):
            if path.suffix in {".ttl", ".bddl"}:
                running.open(path, path.read_text(), "bddl" if path.suffix == ".bddl" else "turtle")
        yield running


def on_the_command_line(folder, capsys):
    parser = argparse.ArgumentParser()
    CHECK.configure(parser)
    CHECK.run(parser.parse_args([str(folder), "--format", "json", "--no-cache"]))
    printed = json.loads(capsys.readouterr().out)
    return {
        (Path(p["file"]).resolve(), p["code"], p["severity"], p["line"], p["column"], p["message"])
        for p in printed["problems"]
    }


def in_the_editor(client, folder, expected):
    """The problems that are shown of all files, once they are the expected ones or a while has passed."""
    client.notify("workspace/didChangeWatchedFiles", {"changes": []})
    shown = None
    for _ in range(100):
        client.request("workspace/symbol", {"query": "nothing is called so"})  # what was published comes before it
        published = [m["params"] for m in client.log if m.get("method") == "textDocument/publishDiagnostics"]
        shown = {
            (
                Path(uri.removeprefix("file://")),
                one["code"],
                SEVERITIES[one["severity"]],
                one["range"]["start"]["line"] + 1,
                one["range"]["start"]["character"] + 1,
                one["message"].partition("\n")[0],
            )
            for uri, diagnostics in {one["uri"]: one["diagnostics"] for one in published}.items()
            for one in diagnostics
        }
        if shown == expected:
            break
        time.sleep(0.1)
    return shown


@pytest.mark.parametrize("name", SETTINGS)
def test_a_folder_has_the_same_problems_in_both(client, folder, name, capsys):
    (folder / "pyproject.toml").write_text(f"[tool.onto.check]\n{SETTINGS[name]}\n")
    expected = on_the_command_line(folder, capsys)
    assert in_the_editor(client, folder, expected) == expected
    assert len({code for _, code, *_ in expected}) >= (1 if name == "select" else 3)


def test_a_keystroke_heeds_the_settings_too(folder):
    (folder / "pyproject.toml").write_text(
        '[tool.onto.check]\nignore = ["VOC", "TTL007"]\nseverity = { DOC004 = "error" }\n'
    )
    path = folder / "kitchen.ttl"
    with Client(folder=folder) as client:
        at_once = client.open(path, KITCHEN, "turtle")
        assert not [one for one in at_once if one["code"].startswith(("VOC", "TTL007"))]
        whole = client.diagnostics(path.as_uri())
        assert {one["severity"] for one in whole if one["code"] == "DOC004"} == {1}
        typed = client.type(path, 0, 0, "# a line more\n")
        assert not [one for one in typed if one["code"].startswith(("VOC", "TTL007"))]


def test_settings_that_cannot_be_read_are_shown_where_they_are_until_they_can(folder):
    settings, path = folder / "pyproject.toml", folder / "kitchen.ttl"
    settings.write_text('[tool.onto.check]\nselekt = ["DOC"]\n')
    with Client(folder=folder) as client:
        client.open(path, KITCHEN, "turtle")
        client.diagnostics(path.as_uri())
        shown = [m["params"]["diagnostics"] for m in client.log if m["params"].get("uri") == settings.as_uri()]
        assert [one["code"] for one in shown[-1]] == ["CFG001"]
        assert "did you mean `select`" in shown[-1][0]["message"]
        settings.write_text("[tool.onto.check]\n")
        client.type(path, 0, 0, "#\n")
        client.diagnostics(path.as_uri())
        shown = [m["params"]["diagnostics"] for m in client.log if m["params"].get("uri") == settings.as_uri()]
        assert shown[-1] == []
