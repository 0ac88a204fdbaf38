"""The package that docs/authoring.md shows is what `onto new package` writes, and it repairs what the page says."""

import os
import re
import shlex
from pathlib import Path

import pytest

from tests.plugins import environment_with, run_with

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "docs/examples/in_line"
PAGE = (ROOT / "docs/authoring.md").read_text().partition("## A whole package")[2].partition("\n## ")[0]


def blocks(language):
    return re.findall(rf"(?s)```{language}\n(.*?)```", PAGE)


def test_the_page_shows_every_term_and_the_whole_programs():
    terms = re.split(r"\n\n(?=in_line:\w+ a )", (FOLDER / "in_line/in_line.ttl").read_text().strip())[1:]
    shown = [term.strip() for block in blocks("turtle") for term in re.split(r"\n\n(?=in_line:\w+ a )", block)]
    assert sorted(shown) == sorted(terms)
    assert len(shown) == 8
    assert blocks("python") == [(FOLDER / f"in_line/{name}.py").read_text() for name in ("grounding", "proposer")]
    assert blocks("toml")[0] in (FOLDER / "pyproject.toml").read_text()


@pytest.mark.sim
def test_the_session_prints_what_the_page_shows(tmp_path):
    (session,) = blocks("console")
    new, *commands = re.split(r"^\$ ", session, flags=re.MULTILINE)[1:]
    assert commands[:3] == ["cd in_line\n", "pip install -e .\n", "pytest\n"]
    assert [command.split()[1] for command in commands[3:]] == ["check", "diagnose", "repair"]
    plain = {**os.environ, "PYTHONPATH": str(ROOT)}
    made = run_with(plain, "-m", "onto_evwm", *shlex.split(new.partition("\n")[0])[1:], cwd=tmp_path)
    assert made.stdout == new.partition("\n")[2], made.stderr
    folder = tmp_path / "in_line"
    files = sorted(path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    assert [(folder / file).read_text() for file in files] == [(FOLDER / file).read_text() for file in files]
    environment = environment_with(folder, tmp_path / "installed")
    for command in commands[3:]:
        line, _, printed = command.partition("\n")
        done = run_with(environment, "-m", "onto_evwm", *shlex.split(line)[1:], cwd=folder)
        assert done.stdout == printed, done.stderr
        assert max(map(len, printed.splitlines()), default=0) <= 80
