"""An ontology of several files in an editor: each is checked with those that belong to it."""

import shutil
from pathlib import Path

import pytest

import ontology
from onto_compiler.lsp.client import Client
from onto_compiler.lsp.siblings import header, ontologies_above, siblings, turtle_below

pytest.importorskip("pygls")
ROOT = Path(__file__).resolve().parents[3]
PREFIXES = """\
@prefix core: <https://w3id.org/onto-evwm/core#> .
@prefix dcterms: <http://purl.org/dc/terms/> .
@prefix kitchen: <https://example.org/kitchen#> .
@prefix man: <https://w3id.org/onto-evwm/manipulation#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix skos: <http://www.w3.org/2004/02/skos/core#> .
"""


def written(name, imports, terms=""):
    used = "\n".join(line for line in PREFIXES.splitlines() if f"{line.split()[1]}" in HEAD + terms)
    body = HEAD.format(name=name, imports=imports) + terms.format(name=name)
    return f"{used}\n\n{body}"


HEAD = """\
<https://example.org/{name}> a owl:Ontology ;
    dcterms:title "{name}"@en ;
    dcterms:description "What is in {name}."@en ;
    dcterms:creator "Somebody" ;
    dcterms:license <https://spdx.org/licenses/MIT> ;
    owl:imports <{imports}> ;
    owl:versionIRI <https://example.org/{name}/1.0.0> ;
    owl:versionInfo "1.0.0" .
"""
CLASS = """
kitchen:{local} a owl:Class ;
    rdfs:label "{label}"@en ;
    skos:definition "What {label} is."@en ;
    rdfs:subClassOf {above} ;
    rdfs:isDefinedBy <https://example.org/{{name}}> .
"""
MANIPULATION = "https://w3id.org/onto-evwm/manipulation"
VESSELS = written("kitchen", MANIPULATION, CLASS.format(local="Vessel", label="vessel", above="man:Object"))
CUPS = written("cups", "https://example.org/kitchen", CLASS.format(local="Cup", label="cup", above="kitchen:Vessel"))


@pytest.fixture
def kitchen(tmp_path):
    folder = tmp_path / "kitchen"
    (folder / "parts").mkdir(parents=True)
    (folder / "vessels.ttl").write_text(VESSELS)
    (folder / "parts" / "cups.ttl").write_text(CUPS)
    return folder


def codes(diagnostics):
    return sorted(d["code"] for d in diagnostics)


def found_for(path, folder):
    return siblings(path, header(path.read_text(), path), turtle_below([folder]))


def test_an_imported_file_of_the_workspace_is_resolved(kitchen):
    cups = kitchen / "parts" / "cups.ttl"
    with Client(folder=kitchen) as client:
        assert codes(client.open(cups, CUPS, "turtle")) == []
        assert codes(client.diagnostics(cups.as_uri())) == [], "nor does the whole check find anything"
        line = CUPS.splitlines().index("kitchen:Cup a owl:Class ;")
        labels = [
            item["label"]
            for item in client.at("completion", cups, line + 3, len("    rdfs:subClassOf kitchen:Ve"))["items"]
        ]
        assert labels == ["kitchen:Vessel"]
        told = client.at("definition", cups, line + 3, len("    rdfs:subClassOf kitchen:V"))
        assert told["uri"] == (kitchen / "vessels.ttl").as_uri()


def test_without_the_file_or_the_workspace_the_import_is_still_a_problem(kitchen):
    cups = kitchen / "parts" / "cups.ttl"
    with Client() as client:
        assert "OWL003" in codes(client.open(cups, CUPS, "turtle"))
    (kitchen / "vessels.ttl").unlink()
    with Client(folder=kitchen) as client:
        assert "OWL003" in codes(client.open(cups, CUPS, "turtle"))


def test_without_a_workspace_the_files_of_the_same_folder_count(kitchen):
    beside = Path(shutil.copy(kitchen / "parts" / "cups.ttl", kitchen))
    with Client() as client:
        assert codes(client.open(beside, CUPS, "turtle")) == []


def test_what_is_typed_in_one_file_counts_in_the_other_before_it_is_saved(kitchen):
    vessels, cups = kitchen / "vessels.ttl", kitchen / "parts" / "cups.ttl"
    with Client(folder=kitchen) as client:
        client.open(cups, CUPS, "turtle")
        assert client.diagnostics(cups.as_uri()) == []
        client.open(vessels, VESSELS, "turtle")
        row = VESSELS.splitlines().index("kitchen:Vessel a owl:Class ;")
        client.type(vessels, row, len("kitchen:Vessel"), "s")
        found = next(d for _ in range(4) if (d := client.diagnostics(cups.as_uri())))
        assert any("kitchen:Vessel" in one["message"] for one in found)
        client.type(vessels, row, len("kitchen:Vessel"), "", erase=1)
        assert next(True for _ in range(4) if not client.diagnostics(cups.as_uri()))


def test_a_broken_sibling_is_not_this_files_problem(kitchen):
    vessels, cups = kitchen / "vessels.ttl", kitchen / "parts" / "cups.ttl"
    with Client(folder=kitchen) as client:
        client.open(vessels, VESSELS + "}", "turtle")
        assert codes(client.open(cups, CUPS, "turtle")) == [], "what is on disk still counts"


def test_imports_are_followed_in_both_directions_and_prefixes_too(kitchen):
    vessels, cups = kitchen / "vessels.ttl", kitchen / "parts" / "cups.ttl"
    assert found_for(cups, kitchen) == (vessels,)
    assert found_for(vessels, kitchen) == (cups,)
    loose = kitchen / "loose.ttl"
    loose.write_text("@prefix kitchen: <https://example.org/kitchen#> .\nkitchen:x a kitchen:Vessel .\n")
    assert found_for(loose, kitchen) == (vessels,)
    assert found_for(vessels, kitchen) == (cups,), "a file without a header belongs to nobody"


def test_of_two_files_of_the_same_name_the_nearer_counts(kitchen):
    cups = kitchen / "parts" / "cups.ttl"
    draft = kitchen / "parts" / "draft.ttl"
    draft.write_text(VESSELS)
    assert found_for(cups, kitchen) == (draft,)
    copy = kitchen / "cups_of_old.ttl"
    copy.write_text(CUPS)
    assert found_for(cups, kitchen) == (draft,), "nor does another draft of this file count"


def test_hidden_folders_and_shipped_names_are_left_out(kitchen):
    cups = kitchen / "parts" / "cups.ttl"
    (kitchen / ".venv").mkdir()
    shutil.move(kitchen / "vessels.ttl", kitchen / ".venv")
    shutil.copy(ontology.ROOT / "manipulation.ttl", kitchen)
    assert found_for(cups, kitchen) == ()
    mine = kitchen / "mine.ttl"
    mine.write_text(VESSELS)
    assert found_for(mine, kitchen) == (cups,)


def test_a_shipped_file_takes_nobody_with_it():
    path = ontology.ROOT / "manipulation.ttl"
    importers = [file for file in turtle_below([ROOT / "tests"]) if "man:" in file.read_text("utf-8", errors="replace")]
    assert len(importers) > 20
    assert found_for(path, ROOT) == ()


def test_a_task_is_lifted_by_the_ontology_beside_it_or_near_an_ancestor(tmp_path):
    (tmp_path / "ontology").mkdir()
    (tmp_path / "tasks" / "easy").mkdir(parents=True)
    task = tmp_path / "tasks" / "easy" / "serve.bddl"
    task.write_text((ROOT / "docs/examples/serve_the_cheese.bddl").read_text())
    served = Path(shutil.copy(ROOT / "docs/examples/served.ttl", tmp_path / "ontology"))
    (tmp_path / "notes.ttl").write_text("@prefix ex: <http://e/> .\nex:a ex:b ex:c .\n")
    assert ontologies_above(task, tmp_path) == (served,)
    assert ontologies_above(task, task.parent) == (), "what lies outside of the workspace does not count"
    nearer = Path(shutil.copy(served, task.parent))
    assert ontologies_above(task, tmp_path) == (nearer,)
    with Client(folder=tmp_path) as client:
        found = client.open(task, task.read_text(), "bddl")
        assert [one for one in found if one["severity"] == 1] == []


def test_what_is_typed_in_the_ontology_counts_in_the_task(tmp_path):
    served = Path(shutil.copy(ROOT / "docs/examples/served.ttl", tmp_path))
    task = Path(shutil.copy(ROOT / "docs/examples/serve_the_cheese.bddl", tmp_path))
    text = served.read_text()
    with Client(folder=tmp_path) as client:
        client.open(task, task.read_text(), "bddl")
        client.open(served, text, "turtle")
        line = next(i for i, row in enumerate(text.splitlines()) if "skos:notation" in row)
        client.type(served, line, text.splitlines()[line].index('"') + 1, "Un")
        found = next(d for _ in range(4) if (d := client.diagnostics(task.as_uri())))
        assert [one["code"] for one in found if one["severity"] == 1] == ["BDDL003"]
