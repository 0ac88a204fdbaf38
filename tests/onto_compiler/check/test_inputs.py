"""What the command line may name: globs, folders without what is excluded, and standard input."""

import argparse
import io
import json
import sys

import pytest

from onto_compiler.check.command import CHECK
from onto_compiler.check.settings import Settings, anchored
from onto_compiler.command import CLEAN, FINDINGS, MISUSE
from onto_compiler.problems import OntoError

PREFIXES = """@prefix ex: <http://example.org/> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
"""
WRONG = PREFIXES + "ex:A a owl:Klass .\n"
SHAPE = "ex:{0} a sh:NodeShape ; sh:targetClass ex:T ; sh:property [ sh:path ex:{0} ; sh:minCount 1 ] .\n"


@pytest.fixture
def project(tmp_path, monkeypatch):
    for name in ("a.ttl", "a_old.ttl", "vendor/b.ttl", "lib/c.ttl", "lib/deep/d.ttl"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(WRONG)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*words):
    parser = argparse.ArgumentParser()
    CHECK.configure(parser)
    return CHECK.run(parser.parse_args([str(word) for word in words]))


def files(capsys, *words):
    capsys.readouterr()
    run(*words, "--json")
    problems = json.loads(capsys.readouterr().out)["problems"]
    return [problem["file"] for problem in problems if problem["severity"] == "error"]


ALL = ["a.ttl", "a_old.ttl", "lib/c.ttl", "lib/deep/d.ttl", "vendor/b.ttl"]


@pytest.mark.parametrize(
    ("patterns", "left"),
    [
        ([], ALL),
        (["vendor"], ALL[:4]),
        (["*_old.ttl", "vendor/"], ["a.ttl", "lib/c.ttl", "lib/deep/d.ttl"]),
        (["lib/*.ttl"], ["a.ttl", "a_old.ttl", "vendor/b.ttl"]),
        (["lib/**/*.ttl"], ["a.ttl", "a_old.ttl", "lib/c.ttl", "vendor/b.ttl"]),
        (["./lib/deep"], ["a.ttl", "a_old.ttl", "lib/c.ttl", "vendor/b.ttl"]),
        (["deep", "other"], ["a.ttl", "a_old.ttl", "lib/c.ttl", "vendor/b.ttl"]),
    ],
)
@pytest.mark.parametrize("place", ["settings", "options"])
def test_what_is_excluded_is_passed_over_in_folders(project, capsys, patterns, left, place):
    if place == "settings":
        (project / "onto.toml").write_text(f"[check]\nexclude = {json.dumps(patterns)}\n")
        assert files(capsys, ".") == left
    else:
        assert files(capsys, ".", *(word for one in patterns for word in ("--exclude", one))) == left


def test_a_file_that_is_named_itself_is_checked(project, capsys):
    assert files(capsys, "vendor/b.ttl", "lib", "--exclude", "vendor", "--exclude", "lib/deep") == [
        "lib/c.ttl",
        "vendor/b.ttl",
    ]


def test_a_folder_of_which_everything_is_excluded_is_told(project):
    with pytest.raises(OntoError, match="every file of `vendor` is excluded"):
        run("vendor", "--exclude", "*.ttl")


def test_options_take_the_place_of_the_settings_patterns(project, capsys):
    (project / "onto.toml").write_text('[check]\nexclude = ["lib"]\n')
    assert files(capsys, ".", "--exclude", "vendor") == ALL[:4]


def test_the_folder_of_the_settings_may_hold_what_globs_read_otherwise(tmp_path):
    folder = tmp_path / "a[1]"
    settings = Settings(exclude=anchored(["lib/*.ttl"], folder))
    assert settings.excludes(folder / "lib" / "x.ttl")
    assert not settings.excludes(tmp_path / "a1" / "lib" / "x.ttl")


def test_globs_are_expanded_in_paths_and_shapes(project, capsys):
    assert files(capsys, "a*.ttl") == ["a.ttl", "a_old.ttl"]
    assert files(capsys, "**/d.ttl") == ["lib/deep/d.ttl"]
    (project / "data.ttl").write_text(PREFIXES + "ex:a a ex:T .\n")
    for name in ("one", "two"):
        (project / f"{name}_shapes.ttl").write_text(PREFIXES + SHAPE.format(name))
    assert run("data.ttl", "--shapes", "*_shapes.ttl", "--json") == FINDINGS
    said = [problem["message"] for problem in json.loads(capsys.readouterr().out)["problems"]]
    assert ["`ex:one` must" in said[0], "`ex:two` must" in said[1], len(said)] == [True, True, 2]
    with pytest.raises(OntoError, match=r"`\*_shape.ttl` matches no file"):
        run("data.ttl", "--shapes", "*_shape.ttl")


def given(monkeypatch, text):
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text if isinstance(text, bytes) else text.encode())))


def test_standard_input_is_checked_as_a_file_of_this_folder(project, capsys, monkeypatch):
    given(monkeypatch, WRONG)
    assert run("-") == FINDINGS
    out = capsys.readouterr().out
    assert "--> <stdin>:4:8\n   | ex:A a owl:Klass .\n" in out
    given(monkeypatch, WRONG)
    assert files(capsys, "-", "lib/c.ttl", "--stdin-filename", "lib/other.ttl") == ["lib/c.ttl", "lib/other.ttl"]


def test_standard_input_takes_the_place_of_the_file_that_it_is_named_after(project, capsys, monkeypatch):
    given(monkeypatch, PREFIXES + "ex:A a owl:Class .\n")
    assert run("-", "--stdin-filename", "a.ttl", "--ignore", "TTL007") == CLEAN
    (project / "onto.toml").write_text('[check]\nper-file-ignores = { "lib/*.ttl" = ["VOC"] }\n')
    given(monkeypatch, WRONG)
    assert files(capsys, "-", "--stdin-filename", "lib/new.ttl") == []


def test_standard_input_may_be_data_or_shapes(project, capsys, monkeypatch):
    data, shapes = PREFIXES + "ex:a a ex:T .\n", PREFIXES + SHAPE.format("one")
    (project / "data.ttl").write_text(data)
    (project / "shapes.ttl").write_text(shapes)
    given(monkeypatch, data)
    assert files(capsys, "-", "--shapes", "shapes.ttl") == ["<stdin>"]
    given(monkeypatch, shapes)
    assert files(capsys, "data.ttl", "--shapes", "-") == ["data.ttl"]
    given(monkeypatch, '{"@id": "http://example.org/a", "@type": "http://example.org/T"}')
    assert files(capsys, "-", "--stdin-filename", "x.jsonld", "--shapes", "shapes.ttl") == ["x.jsonld"]


def test_a_task_may_be_standard_input(project, capsys, monkeypatch):
    given(monkeypatch, "(define (problem x)")
    assert set(files(capsys, "-", "--stdin-filename", "task.bddl")) == {"task.bddl"}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["-", "--fix"], "standard input is not repaired"),
        (["-", "--watch"], "standard input is not repaired, watched"),
        (["-", "--reasoner", "hermit"], "standard input is not repaired, watched or given to HermiT"),
        (["-", "--shapes", "-"], "`-` is given twice"),
        (["a.ttl", "--stdin-filename", "b.ttl"], "--stdin-filename is given without `-`"),
        (["a.ttl", "--jobs", "0"], "--jobs 0 is no number of processes"),
    ],
)
def test_what_does_not_go_together_is_told(project, words, said):
    with pytest.raises(OntoError, match=said):
        run(*words)


def test_standard_input_that_is_no_text_is_told(project, monkeypatch):
    given(monkeypatch, b"\xff")
    with pytest.raises(OntoError, match="standard input is not UTF-8: byte 0xFF at 0"):
        run("-")


@pytest.mark.parametrize("mode", [[], ["--shapes", "shapes.ttl"]])
def test_a_file_that_is_too_large_is_told_and_not_read(project, capsys, mode):
    (project / "shapes.ttl").write_text(PREFIXES + SHAPE.format("one"))
    with (project / "large.ttl").open("wb") as large:
        large.truncate(200_000_000)
    assert run("large.ttl", *mode, "--json") == FINDINGS
    (problem,) = json.loads(capsys.readouterr().out)["problems"]
    assert problem["code"] == "TTL009"
    assert problem["message"] == "`large.ttl` has 200 MB, and a file of at most 100 MB is checked"


def test_data_that_cannot_be_read_hide_no_result_of_other_data(project, capsys):
    (project / "shapes.ttl").write_text(
        PREFIXES + SHAPE.format("one") + "ex:C a sh:NodeShape ; sh:targetClass ex:T ; "
        "sh:property [ sh:path ex:knows ; sh:class ex:U ] .\n"
    )
    (project / "data.ttl").write_text(PREFIXES + "ex:a a ex:T ; ex:knows ex:b .\n")
    assert files(capsys, "data.ttl", "--shapes", "shapes.ttl") == ["data.ttl", "data.ttl"]
    (project / "more.ttl").write_text(PREFIXES + "ex:b a ex:U\n")  # which may say what `ex:b` is
    assert run("data.ttl", "more.ttl", "--shapes", "shapes.ttl", "--json") == FINDINGS
    found = json.loads(capsys.readouterr().out)["problems"]
    assert [(one["file"], one["code"]) for one in found] == [("data.ttl", "SHP001"), ("more.ttl", "TTL005")]
    assert "`ex:one` must have at least 1 value" in found[0]["message"]


def test_a_missing_file_hides_no_result_of_other_data(project, capsys):
    (project / "shapes.ttl").write_text(PREFIXES + SHAPE.format("one"))
    (project / "data.ttl").write_text(PREFIXES + "ex:a a ex:T .\n")
    assert run("data.ttl", "none.ttl", "--shapes", "shapes.ttl", "--json") == MISUSE
    found = json.loads(capsys.readouterr().out)["problems"]
    assert [(one["file"], one["code"]) for one in found] == [("data.ttl", "SHP001"), ("none.ttl", "TTL002")]
