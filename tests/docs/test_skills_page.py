"""The program of docs/skills.md prints what the page shows, and what the page quotes is shipped."""

import argparse
import inspect
import os
import re
import shlex
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest

pytestmark = pytest.mark.sim
ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/skills.md").read_text()


def blocks(language):
    return re.findall(rf"(?s)```{language}\n(.*?)```", PAGE)


def test_the_program_prints_what_the_page_shows():
    (program,), (printed,) = blocks("python"), blocks("text")
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=ROOT, env=environment
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout == printed


def test_the_route_is_declared_and_its_skill_registered_as_the_page_says():
    (route,), (registration,) = blocks("turtle"), blocks("toml")
    assert route in (ROOT / "ontology/manipulation.ttl").read_text()
    group, name, value = re.search(r'"(.+)"\]\n(\w+) = "(.+)"', registration).groups()
    assert {entry.value for entry in entry_points(group=group, name=name)} == {value}


def test_every_command_of_the_page_is_understood():
    from benchmarks.command import BENCH
    from runtime.worlds.libero.commands.play import PLAY

    known = {command.name: argparse.ArgumentParser() for command in (PLAY, BENCH)}
    for command in (PLAY, BENCH):
        command.configure(known[command.name])
    lines = [shlex.split(line, comments=True) for block in blocks("bash") for line in block.splitlines()]
    assert len(lines) == 5
    for onto, name, *options in lines:
        assert onto == "onto"
        known[name].parse_args(options)


def test_the_ends_that_the_page_names_are_those_that_skills_give():
    from runtime.worlds.libero.skills import play

    raised = {
        kind
        for path in sorted((ROOT / "runtime/worlds/libero/skills").glob("*.py"))
        for kind in re.findall(r'SkillFault\(\s*"(\w+)"', path.read_text())
    }
    (sentence,) = re.findall(r"(?s)and its outcome: (.*?)\n\n", PAGE)
    assert set(re.findall(r"`(\w+)`", sentence)) == raised | {"held", "unmet", play._OVER}


def test_look_ahead_tries_as_many_candidates_as_the_page_says():
    from runtime.worlds.libero.skills.play import Player

    assert inspect.signature(Player.lookahead).parameters["candidates"].default == 6
    assert "(by default six)" in PAGE.replace("\n", " ")
