"""What docs/worlds.md shows is what the robosuite world is."""

import os
import re
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from onto_compiler.command import CLEAN, FINDINGS
from runtime.cli import main
from runtime.worlds.robosuite.world import SUITE, WORLD
from runtime.worlds.world import GROUP, World

pytestmark = pytest.mark.sim
ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/worlds.md").read_text()


def test_the_protocol_has_the_members_that_the_page_lists():
    (rows,) = re.findall(r"(?s)\| a world says \|.*?\n\n", PAGE)
    named = set(re.findall(r"`(\w+)", rows.split("|---|---|\n")[1]))
    members = {name for name in (*World.__annotations__, *vars(World)) if not name.startswith("_")}
    assert members <= named
    for entry in entry_points(group=GROUP):
        world = entry.load()
        assert {name for name in members if not hasattr(world, name)} == set()


def test_the_goal_is_that_of_the_task_file():
    (goal,) = re.findall(r"(?s)```lisp\n(.*?)```", PAGE)
    (text,) = (ref.bddl.read_text() for ref in WORLD.tasks(SUITE) if ref.name == "Stack")
    assert "".join(goal.split()) in "".join(text.split())


def test_the_commands_run(capsys):
    (block,) = re.findall(r"(?s)```bash\n(.*?)```", PAGE)
    codes = [main(line.split()[1:]) for line in block.splitlines()]
    assert codes == [CLEAN, FINDINGS, CLEAN]
    assert "accepted" in capsys.readouterr().out


def test_the_program_prints_what_the_page_shows(tmp_path):
    ((program, printed),) = re.findall(r"(?s)```python\n(.*?)```\n\n```text\n(.*?)```", PAGE)
    path = tmp_path / "example.py"
    path.write_text(program)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, path], capture_output=True, text=True, check=False, cwd=tmp_path, env=environment
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout == printed


def test_its_own_code_is_small():
    lines = sum(len(path.read_text().splitlines()) for path in (ROOT / "runtime/worlds/robosuite").rglob("*.py"))
    assert lines < 700
