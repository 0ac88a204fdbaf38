"""The program around the commands: exit codes, messages and help, with commands registered for the test alone."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.metadata import EntryPoint

import pytest

from onto_compiler.command import Command, add_format
from onto_compiler.problems import OntoError, Problem
from runtime.cli import main, program
from runtime.cli.discovery import GROUP, installed
from runtime.cli.parser import parser_of


def _configure(parser):
    add_format(parser)
    parser.add_argument("what", choices=("clean", "findings", "misuse", "interrupt", "pipe", "crash", "extra"))
    parser.add_argument("--file", default="")


def _run(options):
    match options.what:
        case "findings":
            return 1
        case "misuse":
            problems = (Problem(options.file, 2, 3, "TST001", "error", "`b` is wrong", "write `c`"),)
            raise OntoError(*problems)
        case "interrupt":
            raise KeyboardInterrupt
        case "pipe":
            raise BrokenPipeError
        case "crash":
            raise ZeroDivisionError("one\ntwo")
        case "extra":
            raise ModuleNotFoundError("No module named 'mujoco'", name="mujoco")
    sys.stdout.write("data\n")
    return 0


PROBE = Command("probe", "Does what a test asks.", "onto probe clean", _configure, _run)


@pytest.fixture(autouse=True)
def registered(monkeypatch):
    here = EntryPoint("probe", f"{__name__}:PROBE", GROUP)
    lost = EntryPoint("lost", "no_such_package_at_all:LOST", GROUP)
    monkeypatch.setattr(program, "installed", lambda: {"lost": lost, "probe": here})


def test_the_exit_code_is_the_commands_own(capsys):
    assert main(["probe", "clean"]) == 0
    assert capsys.readouterr().out == "data\n"
    assert main(["probe", "findings"]) == 1


def test_a_problem_is_printed_with_its_line_and_a_caret(capsys, tmp_path):
    source = tmp_path / "a.ttl"
    source.write_text("first\na b .\n")
    assert main(["probe", "misuse", "--file", str(source)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert f"error[TST001]: `b` is wrong\n  --> {source}:2:3\n   | a b .\n   |   ^\n   = help: write `c`" in err


def test_problems_are_json_on_standard_output_when_json_was_asked_for(capsys):
    for words in (["--json"], ["--format", "json"], ["--format=json"]):
        assert main(["probe", "misuse", "--file", "gone.ttl", *words]) == 2
        out, err = capsys.readouterr()
        (problem,) = json.loads(out)["problems"]
        assert (problem["code"], problem["line"], problem["file"]) == ("TST001", 2, "gone.ttl")
        assert err == ""


def test_an_interruption_is_one_line_and_exit_130(capsys):
    assert main(["probe", "interrupt"]) == 130
    assert capsys.readouterr().err.count("\n") == 1


def test_a_crash_is_named_without_a_traceback_unless_debugging(capsys, monkeypatch):
    monkeypatch.delenv("ONTO_DEBUG", raising=False)
    assert main(["probe", "crash"]) == 70
    err = capsys.readouterr().err
    assert "internal error: ZeroDivisionError: one two" in err
    assert "Traceback" not in err
    monkeypatch.setenv("ONTO_DEBUG", "1")
    assert main(["probe", "crash"]) == 70
    assert "Traceback" in capsys.readouterr().err


def test_a_missing_extra_says_what_to_install(capsys):
    assert main(["probe", "extra"]) == 2
    err = capsys.readouterr().err
    assert "CLI003" in err
    assert "pip install 'onto-evwm[sim]'" in err


@pytest.mark.parametrize(
    ("words", "code", "hint"),
    [
        (["prob"], "CLI001", "did you mean `probe`?"),
        (["zzzz"], "CLI001", "`onto --help` lists the commands"),
        (["probe", "cleen"], "CLI002", "did you mean `clean`?"),
        (["probe"], "CLI002", "see `onto probe --help`"),
        (["--json", "probe"], "CLI002", "onto COMMAND"),
        (["probe", "clean", "--fil", "x"], "CLI002", "see `onto probe --help`"),
    ],
)
def test_a_misuse_has_a_code_and_a_remedy(capsys, words, code, hint):
    assert main(words) == 2
    out, err = capsys.readouterr()
    text = out + err
    assert code in text
    assert hint in text


def test_the_overview_lists_every_command_even_one_that_cannot_be_imported(capsys):
    assert main(["--help"]) == 0
    out = capsys.readouterr().out
    assert "Does what a test asks." in out
    assert "$ onto probe clean" in out
    assert "Not available: No module named 'no_such_package_at_all'." in out
    assert max(map(len, out.splitlines())) <= 110


def test_no_command_at_all_is_a_misuse_that_teaches(capsys):
    assert main([]) == 2
    assert "Does what a test asks." in capsys.readouterr().err


def test_help_of_a_command_shows_its_example(capsys):
    assert main(["probe", "--help"]) == 0
    assert main(["help", "probe"]) == 0
    assert capsys.readouterr().out.count("example:\n  onto probe clean") == 2


def test_the_version_is_one_line(capsys):
    assert main(["--version"]) == 0
    name, number = capsys.readouterr().out.split()
    assert name == "onto"
    assert number[0].isdigit()


def test_every_installed_command_has_a_sentence_and_an_example_that_starts_with_its_name():
    points = installed()
    found = []
    for name, point in points.items():
        command = point.load()
        found.append(name)
        assert command.name == name
        assert command.help.endswith(".")
        assert command.example.startswith(f"onto {name}")
        assert command.example.splitlines()[0] in parser_of(command).format_help()
    assert "trace" in found


def test_a_closed_pipe_is_quiet():
    script = "from runtime.cli import main; import sys; sys.exit(main(['--help']))"
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run([sys.executable, "-c", script], stdout=write, stderr=subprocess.PIPE, check=False)
    os.close(write)
    assert done.returncode == 141
    assert done.stderr == b""


def test_the_overview_imports_nothing_heavy():
    script = (
        "import sys; from runtime.cli import main; main(['--help']);"
        "print([m for m in ('numpy', 'mujoco', 'torch', 'rdflib', 'pyshacl', 'pyoxigraph', 'rich', 'lark', 'owlready2')"
        " if m in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"


FOREIGN = """
def ground(scene, fact, schema):
    return helper(fact)


def helper(fact):
    return {}["cloth_1"]
"""


def test_an_exception_of_registered_code_is_told_at_its_own_line(tmp_path, monkeypatch, capsys):
    """The file and line are the person's, and the entry point and the package are named."""
    from onto_compiler import registered

    (tmp_path / "my_grounding.py").write_text(FOREIGN)
    monkeypatch.syspath_prepend(tmp_path)
    point = EntryPoint("wiped", "my_grounding:ground", registered.GROUNDINGS)
    vars(point).update(dist=type("Distribution", (), {"name": "my-grounding"}))
    monkeypatch.setattr(registered, "entry_points", lambda group: [point] if group == registered.GROUNDINGS else [])
    command = Command(
        "probe", "Asks.", "onto probe", lambda parser: None, lambda options: point.load()(None, None, None)
    )
    monkeypatch.setattr(program, "load", lambda name, points: command)
    assert main(["probe"]) == 2
    text = capsys.readouterr().err
    assert "error[RUN007]: the grounding function `wiped` (`my_grounding:ground`, package `my-grounding`)" in text
    assert "raised KeyError: 'cloth_1'" in text
    assert f"{tmp_path / 'my_grounding.py'}:7:1" in text
    assert "fault of `onto`" not in text


def test_our_own_exception_stays_ours_whatever_is_registered(monkeypatch, capsys):
    from onto_compiler import registered

    point = EntryPoint("wiped", "my_grounding:ground", registered.GROUNDINGS)
    monkeypatch.setattr(registered, "entry_points", lambda group: [point] if group == registered.GROUNDINGS else [])
    assert main(["probe", "crash"]) == 70
    assert "fault of `onto`" in capsys.readouterr().err
