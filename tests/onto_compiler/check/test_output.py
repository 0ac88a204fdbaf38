"""Where the result of ``onto check`` goes, in colours or plain, with a summary or without."""

import argparse
import json
import re
import sys

import pytest

from onto_compiler.check.command import CHECK, EXPLAIN
from onto_compiler.check.pages import codes
from onto_compiler.command import CLEAN, FINDINGS
from onto_compiler.problems import OntoError

TEXT = "@prefix ex: <http://example.org/> .\n@prefix owl: <http://www.w3.org/2002/07/owl#> .\nex:A a owl:Klass .\n"
ESCAPE = re.compile(r"\x1b\[[0-9;]*m")


@pytest.fixture
def path(tmp_path, monkeypatch):
    (tmp_path / "x.ttl").write_text(TEXT)
    monkeypatch.chdir(tmp_path)
    for name in ("NO_COLOR", "TERM"):
        monkeypatch.delenv(name, raising=False)
    return tmp_path / "x.ttl"


def run(*words, command=CHECK):
    parser = argparse.ArgumentParser()
    command.configure(parser)
    return command.run(parser.parse_args([str(word) for word in words]))


def test_quiet_prints_problems_and_nothing_else(path, capsys):
    assert run(path, "--quiet") == FINDINGS
    out, err = capsys.readouterr()
    assert out.startswith("error[VOC011]")
    assert err == ""
    path.write_text(TEXT.replace("Klass", "Class"))
    assert run(path, "--quiet") == CLEAN
    assert run(path, "--quiet", "--write-baseline", "baseline.json") == CLEAN
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("form", ["text", "json", "sarif", "junit", "github"])
def test_a_file_gets_what_standard_output_would(path, capsys, form):
    assert run(path, "--format", form) == FINDINGS
    printed = capsys.readouterr().out
    assert run(path, "--format", form, "--output-file", "made/report") == FINDINGS
    out, err = capsys.readouterr()
    assert out == ""
    assert err == "1 problem (1 error) in 1 file\n"
    assert (path.parent / "made" / "report").read_text() == printed


def test_a_file_gets_what_keeps_a_check_from_running(path):
    run("none.ttl", "--json", "--output-file", "report.json")
    (problem,) = json.loads((path.parent / "report.json").read_text())["problems"]
    assert problem["code"] == "TTL002"


def test_a_file_that_cannot_be_written_is_told_and_stays_as_it_was(path):
    (path.parent / "folder").mkdir()
    with pytest.raises(OntoError, match="CLI009: cannot write `folder`"):
        run(path, "--output-file", "folder")
    assert list((path.parent / "folder").iterdir()) == []


def coloured(capsys, *words):
    capsys.readouterr()
    run("x.ttl", *words)
    return "\x1b[" in capsys.readouterr().out


@pytest.mark.parametrize("terminal", [True, False])
def test_colours_follow_the_terminal_the_environment_and_the_option(path, capsys, monkeypatch, terminal):
    monkeypatch.setattr(sys.stdout, "isatty", lambda: terminal, raising=False)
    assert coloured(capsys) == terminal
    assert coloured(capsys, "--color", "always")
    assert not coloured(capsys, "--color", "never")
    assert not coloured(capsys, "--json", "--color", "always")
    monkeypatch.setenv("NO_COLOR", "1")
    assert not coloured(capsys)
    assert coloured(capsys, "--color", "always")
    monkeypatch.delenv("NO_COLOR")
    monkeypatch.setenv("TERM", "dumb")
    assert not coloured(capsys)


def test_colours_change_no_character(path, capsys):
    path.write_text(TEXT + "ex:B a owl:Klass ; ex:p '''" + "[red] :smile: " * 20 + "''' .\n")
    run(path)
    plain = capsys.readouterr().out
    run(path, "--color", "always")
    assert ESCAPE.sub("", capsys.readouterr().out) == plain


def test_explain_without_a_code_lists_all(capsys):
    assert run(command=EXPLAIN) == CLEAN
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(codes())
    assert all(len(line.split()) > 1 for line in lines)
