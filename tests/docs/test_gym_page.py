"""The programs of docs/gym.md print what the page shows."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.sim
ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/gym.md").read_text()
EXAMPLES = re.findall(r"(?s)```python\n(.*?)```\n\n```text\n(.*?)```", PAGE)


def test_the_page_has_its_examples():
    assert len(EXAMPLES) == len(re.findall("```python", PAGE)) == 2


@pytest.mark.parametrize(("program", "printed"), EXAMPLES)
def test_an_example_prints_what_the_page_shows(program, printed, tmp_path):
    path = tmp_path / "example.py"
    path.write_text(program)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, path], capture_output=True, text=True, check=False, cwd=tmp_path, env=environment
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout == printed


def test_every_option_that_the_page_names_exists():
    import inspect

    from runtime.worlds.libero.gym.environment import LiberoEnv

    options = set(inspect.signature(LiberoEnv).parameters)
    named = set(re.findall(r"`(\w+)=", PAGE))
    assert len(named) >= 10
    assert named - {"context", "options"} <= options  # of AsyncVectorEnv, and of reset


def test_the_horizons_are_those_of_the_program():
    from runtime.worlds.libero.scene.horizons import HORIZONS

    shown = re.search(r"horizon \((.*?);", PAGE)[1]
    assert [int(number) for number in re.findall(r" (\d{3})", shown)] == list(HORIZONS.values())
