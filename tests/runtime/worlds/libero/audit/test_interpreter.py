"""Another environment is asked what it has before anything is run in it."""

from __future__ import annotations

import stat
import sys

import pytest

from onto_compiler.problems import OntoError
from runtime.cli import main
from runtime.worlds.libero.audit.interpreter import run_elsewhere


def script(tmp_path, body):
    path = tmp_path / "python"
    path.write_text(f"#!/bin/sh\n{body}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def refused(python):
    with pytest.raises(OntoError) as caught:
        run_elsewhere(python, ["--version"])
    (problem,) = caught.value.problems
    assert problem.code == "RUN021"
    return problem


def test_what_is_no_python_is_refused(tmp_path):
    assert "cannot be run" in refused(str(tmp_path / "missing")).message
    assert "does not answer" in refused(script(tmp_path, "echo hello")).message


@pytest.mark.parametrize(
    ("answer", "lacks"),
    [('[null, "3.4.0"]', "lacks onto-evwm"), ('["0.0.1", "3.4.0"]', "it has 0.0.1")],
)
def test_an_environment_without_this_onto_evwm_is_refused(tmp_path, answer, lacks):
    problem = refused(script(tmp_path, f"echo '{answer}'"))
    assert lacks in problem.message
    assert "mujoco, robosuite, numba" in problem.hint


@pytest.mark.sim
def test_our_own_environment_runs_the_command(capfd):
    assert run_elsewhere(sys.executable, ["--version"]) == 0
    assert capfd.readouterr().out.startswith("onto ")


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["--states", "0"], "CLI002"),
        (["--jobs", "-1"], "CLI002"),
        (["no_such_suite"], "SIM011"),
        (["libero_goal/99"], "SIM012"),
        (["--diff", "missing.json", "missing.json"], "RUN022"),
        (["--python", "/no/such/python"], "RUN021"),
    ],
)
@pytest.mark.sim
def test_wrong_use_is_said_and_not_audited(arguments, code, capsys):
    assert main(["audit", *arguments]) == 2
    assert code in capsys.readouterr().err
