"""Imports come from files beside the given ones, by ontology or version IRI; nothing is fetched."""

import pytest

from onto_compiler.command import CLEAN, MISUSE
from onto_compiler.emit.imports import with_imports
from onto_compiler.emit.tbox import read_tbox
from runtime.cli import main

HEAD = """
@prefix core: <https://w3id.org/onto-evwm/core#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix ex: <https://example.org/> .
"""


def write(folder, name, *imports, version=""):
    lines = [f"ex:{name} a owl:Ontology .", f"ex:{name}_class a owl:Class ; rdfs:subClassOf core:Entity ."]
    lines += [f"ex:{name} owl:imports <https://example.org/{other}> ." for other in imports]
    lines += [f"ex:{name} owl:versionIRI <https://example.org/{version}> ."] if version else []
    (folder / f"{name}.ttl").write_text(HEAD + "\n".join(lines))
    return folder / f"{name}.ttl"


def names(paths):
    return [path.stem for path in paths]


@pytest.fixture
def folder(tmp_path):
    write(tmp_path, "middle", "base/2.0")
    write(tmp_path, "base", "top", version="base/2.0")
    write(tmp_path, "other")
    (tmp_path / "broken.ttl").write_text("ex:a a")
    return tmp_path


def test_a_chain_of_imports_is_followed_and_nothing_else_is_read(folder):
    top = write(folder, "top", "middle")  # top imports middle, which imports base, which imports top
    assert names(with_imports([top])) == ["top", "middle", "base"]
    classes = {iri for iri in read_tbox([top]).schema.classes if iri.startswith("https://example.org/")}
    assert {iri.rpartition("/")[2] for iri in classes} == {"top_class", "middle_class", "base_class"}


def test_a_given_file_goes_before_one_beside_it(folder, tmp_path_factory):
    elsewhere = write(tmp_path_factory.mktemp("elsewhere"), "middle")
    top = write(folder, "top", "middle")
    assert with_imports([top, elsewhere]) == (top, elsewhere)


def test_a_shipped_ontology_needs_no_file(folder):
    lone = folder / "lone.ttl"
    lone.write_text(HEAD + "ex:lone a owl:Ontology ; owl:imports <https://w3id.org/onto-evwm/manipulation> .")
    assert with_imports([lone]) == (lone,)
    assert read_tbox([lone]).schema.predicates


def test_an_import_without_a_file_is_a_problem(folder, capsys):
    top = write(folder, "top", "nowhere")
    assert main(["schema", "--emit", "mermaid", "--ontology", str(top)]) == MISUSE
    err = capsys.readouterr().err
    assert "error[OWL003]: the import `https://example.org/nowhere` is in none of the files" in err
    assert f"--> {top}" in err
    write(folder, "nowhere")
    assert main(["schema", "--emit", "mermaid", "--ontology", str(top)]) == CLEAN
    assert "nowhere_class" in capsys.readouterr().out
