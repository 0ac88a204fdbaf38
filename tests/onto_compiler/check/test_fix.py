"""``onto check --fix`` repairs what is mechanical, at the place of the problem, and touches nothing else."""

import argparse
import difflib
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from onto_compiler.check.command import CHECK
from onto_compiler.check.edits import FIXABLE
from onto_compiler.check.fix import fix
from onto_compiler.check.run import check
from onto_compiler.command import CLEAN, FINDINGS
from onto_compiler.problems import OntoError

BROKEN = Path(__file__).parent / "broken"
CASES = sorted(path for path in BROKEN.glob("*.ttl") if path.stem[:6].upper() in FIXABLE)
HEADER = """\
@prefix dcterms: <http://purl.org/dc/terms/> .
@prefix ex: <https://example.org/kitchen#> .
@prefix man: <https://w3id.org/onto-evwm/manipulation#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix skos: <http://www.w3.org/2004/02/skos/core#> .

<https://example.org/kitchen> a owl:Ontology ; dcterms:title "Kitchen"@en ;
    dcterms:license <https://spdx.org/licenses/MIT> ;
    owl:imports <https://w3id.org/onto-evwm/manipulation> ; owl:versionInfo "0.1.0" .
"""


def run(*words):
    parser = argparse.ArgumentParser()
    CHECK.configure(parser)
    return CHECK.run(parser.parse_args([str(word) for word in words]))


def spoon(definition="A spoon.", origin=" ; rdfs:isDefinedBy <https://example.org/kitchen>", above="man:Object"):
    return (
        f'{HEADER}\nex:Spoon a owl:Class ; rdfs:label "spoon"@en ; rdfs:subClassOf {above} ;  # of steel\n'
        f'    skos:definition "{definition}"@en{origin} .\n'
    )


def repaired(tmp_path, text):
    path = tmp_path / "x.ttl"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    fixed = fix([path])
    return fixed.after.get(path.resolve(), path.read_bytes().decode("utf-8-sig")), fixed


def test_the_corpus_is_complete():
    assert len(CASES) == 5
    assert {path.stem[:6].upper() for path in CASES} == set(FIXABLE)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_a_repaired_file_has_lost_the_problem_and_gained_none(path, tmp_path):
    copy = shutil.copy(path, tmp_path / path.name)
    before = check([copy]).problems
    run(copy, "--fix")
    after = check([copy]).problems
    assert {problem.code for problem in after} < {problem.code for problem in before} or not after
    assert not any(problem.code in FIXABLE for problem in after)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_no_line_but_those_with_a_problem_changes(path):
    fixed = fix([path])
    (old,), (new,) = fixed.before.values(), fixed.after.values()
    changes = [line for line in difflib.ndiff(old.splitlines(), new.splitlines()) if line[0] in "+-"]
    assert len(changes) <= 3 * len(fixed.edits)
    assert path.read_text(encoding="utf-8") == old, "fix() itself writes nothing"


def test_repairing_twice_is_repairing_once(tmp_path):
    for path in CASES:
        shutil.copy(path, tmp_path)
    run(tmp_path, "--fix")
    once = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    run(tmp_path, "--fix")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == once


def test_everything_at_once(tmp_path):
    ladle = 'ex:Ladle a owl:Class ; owl:deprecated true ; dcterms:isReplacedBy man:Object ; rdfs:label "ladle"@en ;\n'
    ladle += '    skos:definition "A ladle" .\n'
    text, fixed = repaired(
        tmp_path, spoon("A spoon", "", above="ex:Ladle") + ladle + "@prefix nix: <https://example.org/none#> .\n"
    )
    expected = spoon("A spoon.", " ;\n    rdfs:isDefinedBy <https://example.org/kitchen>", above="man:Object")
    ladle = ladle.replace('"A ladle" .', '"A ladle." ;\n    rdfs:isDefinedBy <https://example.org/kitchen> .')
    assert text == expected + ladle
    assert sorted(edit.problem.code for edit in fixed.edits) == sorted(["DOC004", "DOC005"] * 2 + ["VOC006", "TTL007"])


def test_a_problem_that_only_a_repair_brings_about_is_repaired_too(tmp_path):
    text = spoon(above="old:Thing").replace("@prefix ex:", "@prefix old: <https://example.org/old#> .\n@prefix ex:")
    (tmp_path / "old.ttl").write_text(
        HEADER.replace("kitchen", "old").replace(
            "@prefix dcterms:", "@prefix old: <https://example.org/old#> .\n@prefix dcterms:"
        )
        + 'old:Thing a owl:Class ; owl:deprecated true ; dcterms:isReplacedBy man:Object ; rdfs:label "thing"@en ;\n'
        '    skos:definition "A thing." ; rdfs:isDefinedBy <https://example.org/old> .\n'
    )
    path = tmp_path / "x.ttl"
    path.write_text(text.replace("<https://w3id.org/onto-evwm/manipulation>", "<https://example.org/old>"))
    after = fix([path, tmp_path / "old.ttl"]).after[path.resolve()]
    assert "old:" not in after
    assert "@prefix man:" in after, "unused at first, and needed by the repair"


@pytest.mark.parametrize(
    ("raw", "expected"),
    [
        ("A spoon  ", "A spoon."),
        ("A spoon (of steel)", "A spoon (of steel)."),
        ("Weiß man\\u0021", None),
        ("What is a spoon?", None),
        ("A spoon,", None),
        ('A \\"spoon\\"', None),
        ("Ein Löffel ist groß", "Ein Löffel ist groß."),
    ],
)
def test_a_full_stop_ends_only_what_is_surely_a_sentence(raw, expected, tmp_path):
    text, _ = repaired(tmp_path, spoon(raw))
    assert text == spoon(expected or raw)


def test_a_long_string_gets_its_full_stop_inside(tmp_path):
    text, _ = repaired(tmp_path, spoon().replace('"A spoon."', '"""A spoon\nof steel"""'))
    assert '"""A spoon\nof steel."""@en' in text


def test_a_file_without_one_header_gets_no_origin(tmp_path):
    two = spoon(origin="") + '<https://example.org/kitchen2> a owl:Ontology ; dcterms:title "K"@en .\n'
    text, fixed = repaired(tmp_path, two)
    assert text == two
    assert fixed.edits == ()


def test_line_ends_and_byte_order_mark_stay(tmp_path):
    path = tmp_path / "x.ttl"
    path.write_bytes(b"\xef\xbb\xbf" + spoon("A spoon", "").replace("\n", "\r\n").encode())
    run(path, "--fix")
    data = path.read_bytes()
    assert data.startswith(b"\xef\xbb\xbf@prefix")
    assert b"A spoon." in data
    assert b"isDefinedBy" in data
    assert not re.search(rb"(?<!\r)\n", data)


def test_a_comment_behind_an_unused_prefix_stays(tmp_path):
    text, _ = repaired(tmp_path, "@prefix nix: <https://example.org/none#> . # of no use\n" + spoon())
    assert text == " # of no use\n" + spoon()


def test_fix_says_what_it_did_and_exits_by_what_is_left(tmp_path, capsys):
    path = tmp_path / "x.ttl"
    path.write_text(spoon("A spoon", above="man:Objekt"))
    assert run(path, "--fix") == FINDINGS
    out, err = capsys.readouterr()
    assert "man:Objekt" in out
    assert "DOC004" not in out
    assert re.search(r"x\.ttl:13:\d+: ended the definition with a full stop \[DOC004\]", err)
    path.write_text(spoon("A spoon"))
    assert run(path, "--fix") == CLEAN


def test_diff_shows_the_repair_and_writes_nothing(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "x.ttl"
    path.write_text(spoon("A spoon").rstrip("\n"))
    assert run(path, "--diff") == FINDINGS
    patch = capsys.readouterr().out
    assert path.read_text() == spoon("A spoon").rstrip("\n")
    assert patch.startswith("--- x.ttl\n+++ x.ttl\n@@ ")
    assert patch.count("\\ No newline at end of file") == 2
    if program := shutil.which("patch"):
        subprocess.run([program, "-p0"], input=patch, text=True, check=True)
        assert path.read_text() == spoon().rstrip("\n")
        assert run(path, "--diff") == CLEAN


def test_files_that_are_not_turtle_stay_as_they_are(tmp_path):
    path = tmp_path / "x.ttl"
    path.write_text("not Turtle")
    assert run(path, "--fix") == FINDINGS
    assert path.read_text() == "not Turtle"


def test_the_shipped_ontology_is_not_repaired_in_place():
    with pytest.raises(OntoError, match="CLI002"):
        run("--fix")


def test_a_file_that_cannot_be_written_is_a_problem(tmp_path, monkeypatch):
    path = tmp_path / "x.ttl"
    path.write_text(spoon("A spoon"))

    def refuse(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "write_bytes", refuse)
    with pytest.raises(OntoError) as caught:
        run(path, "--fix")
    assert [problem.code for problem in caught.value.problems] == ["FIX001"]
