"""The commands and the program of docs/demos.md print what the page shows."""

import argparse
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("h5py")
pytestmark = pytest.mark.sim
ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/demos.md").read_text()


def without_drift(text: str) -> str:
    """``text``, whose largest drift is less than 1e-4: the page was written on a processor of its own."""
    found = re.search(r"largest drift ([\d.e-]+)", text)
    assert found
    assert float(found[1]) < 1e-4
    return text.replace(found[0], "")


def test_the_session_prints_what_the_page_shows(monkeypatch, capsys):
    from runtime.cli import main

    monkeypatch.chdir(ROOT)
    (session,) = re.findall(r"(?s)```console\n(.*?)```", PAGE)
    commands = re.findall(r"^\$ onto (.*)$", session, re.MULTILINE)
    assert len(commands) == 2
    assert [main(shlex.split(command)) for command in commands] == [0, 0]
    assert without_drift(capsys.readouterr().out) == without_drift(re.sub(r"(?m)^\$ .*\n", "", session))


def test_the_program_prints_what_the_page_shows():
    ((program, printed),) = re.findall(r"(?s)```python\n(.*?)```\n\n```text\n(.*?)```", PAGE)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=ROOT, env=environment
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout == printed


def test_every_command_of_the_page_is_understood():
    from runtime.worlds.libero.demos.command import DEMOS

    parser = argparse.ArgumentParser()
    DEMOS.configure(parser)
    (block,) = re.findall(r"(?s)```bash\n(.*?)```", PAGE)
    commands = [line.partition("#")[0] for line in block.splitlines()]
    assert len(commands) == 6
    assert {parser.parse_args(shlex.split(command)[2:]).action for command in commands} == {"collect", "replay", "show"}


def test_numbers_of_the_page_are_those_of_the_program():
    from runtime.worlds.libero.demos.collect import COUNTS
    from runtime.worlds.libero.demos.disturb import Strength
    from runtime.worlds.libero.demos.replay import AFTER
    from runtime.worlds.libero.demos.trial import HELD_OUT, PAST

    assert (HELD_OUT, PAST, AFTER) == (40, 10, 20)
    assert COUNTS == {"libero_goal": 50, "libero_spatial": 10, "libero_object": 10, "libero_10": 10}
    strength = Strength()
    assert (strength.noise, strength.twist, strength.push, strength.slip) == (0.15, 0.05, 0.6, 0.2)
    # 3 err / 0.05 balances an offset of one standard deviation at this many metres.
    assert strength.offset * 0.05 / 3 == pytest.approx(0.0025)
