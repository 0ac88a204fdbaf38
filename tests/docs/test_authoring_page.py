"""The package that docs/authoring.md shows is the one in docs/examples/lineup, and it repairs what it says."""

import os
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "docs/examples/lineup"
PAGE = (ROOT / "docs/authoring.md").read_text().partition("## A whole package")[2].partition("\n## ")[0]
FILES = {"turtle": "lineup.ttl", "python": "lineup.py", "toml": "pyproject.toml"}


def blocks(language):
    return re.findall(rf"(?s)```{language}\n(.*?)```", PAGE)


@pytest.mark.parametrize("language", FILES)
def test_what_the_page_shows_is_in_the_package(language):
    text = (FOLDER / FILES[language]).read_text()
    parts = [part.strip() for block in blocks(language) for part in re.split(r"\n\n(?=\w+:\w+ a )", block)]
    assert parts
    assert [part for part in parts if part not in text] == []


def test_the_page_shows_every_term_and_the_whole_program():
    terms = re.findall(r"^lineup:\w+", (FOLDER / "lineup.ttl").read_text(), re.MULTILINE)
    shown = [term for block in blocks("turtle") for term in re.findall(r"^lineup:\w+", block, re.MULTILINE)]
    assert sorted(shown) == sorted(terms)
    assert blocks("python") == [(FOLDER / "lineup.py").read_text()]


@pytest.mark.sim
def test_the_session_prints_what_the_page_shows(tmp_path):
    entries = tomllib.loads((FOLDER / "pyproject.toml").read_text())["project"]["entry-points"]
    information = tmp_path / "lineup-0.1.0.dist-info"  # as an installer leaves it
    information.mkdir()
    (information / "METADATA").write_text("Metadata-Version: 2.1\nName: lineup\nVersion: 0.1.0\n")
    sections = [f"[{group}]\n" + "".join(f"{k} = {v}\n" for k, v in names.items()) for group, names in entries.items()]
    (information / "entry_points.txt").write_text("\n".join(sections))
    path = os.pathsep.join(map(str, (tmp_path, FOLDER, ROOT)))
    (session,) = blocks("console")
    change, *commands = re.split(r"^\$ ", session, flags=re.MULTILINE)[1:]
    assert change == "cd docs/examples/lineup\n"
    assert [command.split()[1] for command in commands] == ["check", "diagnose", "repair"]
    for command in commands:
        line, _, printed = command.partition("\n")
        program = [sys.executable, "-m", "onto_evwm", *shlex.split(line)[1:]]
        environment = {**os.environ, "PYTHONPATH": path}
        done = subprocess.run(program, capture_output=True, text=True, check=False, cwd=FOLDER, env=environment)
        assert done.stdout == printed, done.stderr
        assert max(map(len, printed.splitlines()), default=0) <= 80
