"""What docs/pointmaze.md shows is what its commands and programs print, and what the ontology declares."""

import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from onto_compiler.knowledge import load_knowledge
from onto_compiler.rdf import NAV
from onto_compiler.tables import ABSENT, EXPLICITLY_FALSE, FIRST, MARGIN_VIOLATED, REPEAT
from runtime.cli import main
from runtime.trace.file import write_trace
from runtime.trace.store import open_trace
from tests.runtime.trace.samples import SCHEMA, planned

pytestmark = pytest.mark.sim
ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/pointmaze.md").read_text()
EXAMPLES = re.findall(r"(?s)```python\n(.*?)```\n\n```text\n(.*?)```", PAGE)


def test_the_page_has_its_examples():
    assert len(EXAMPLES) == len(re.findall("```python", PAGE)) >= 2


@pytest.mark.parametrize(("program", "printed"), EXAMPLES)
def test_an_example_prints_what_the_page_shows(program, printed, tmp_path):
    path = tmp_path / "example.py"
    path.write_text(program)
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}
    done = subprocess.run(
        [sys.executable, path], capture_output=True, encoding="utf-8", check=False, cwd=tmp_path, env=environment
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout == printed


def test_the_session_prints_what_the_page_shows(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    command, shown = re.search(r"(?s)```console\n\$ onto (compile .*?)\n(.*?)```", PAGE).groups()
    assert main(command.split()) == 0
    assert capsys.readouterr().out == shown


def test_failures_and_routes_of_the_page_are_those_of_the_rules():
    rows = [tuple(re.findall(r"`(\w+)`", line)) for line in PAGE.splitlines() if line.count("|") == 5]
    shown = {row[0]: row[1:] for row in rows if len(row) == 3}
    schema, tables = load_knowledge().schema, load_knowledge().tables
    found = {}
    for predicate in ("at_target", "velocity_matches", "free_of"):
        for status in (ABSENT, EXPLICITLY_FALSE, MARGIN_VIOLATED):
            failure = tables.diagnosis[NAV + predicate, True, status].failure
            first = tables.routing[NAV + predicate, failure, FIRST, None, "plan"].route
            then = tables.routing[NAV + predicate, failure, REPEAT, first, "plan"].route
            found[schema.notations[failure]] = (schema.routes[first].name, schema.routes[then].name)
    assert shown == found
    assert len(found) == 4


def test_tolerances_of_the_page_are_those_of_the_ontology():
    schema = load_knowledge().schema
    shown = {row[1]: float(row[2]) for row in re.finditer(r"\| `(\w+)\(ball, \w+\)` \| ([\d.]+) ", PAGE)}
    assert shown == {p.name: p.tolerance for p in schema.predicates.values() if p.iri.startswith(NAV)}
    margins = re.search(r"requires margins of ([\d.]+) m and ([\d.]+) m/s", PAGE).groups()
    asked = {b.lifts.removeprefix(NAV): b.goal_margin for b in schema.bindings if b.lifts.startswith(NAV)}
    assert asked == {"at_target": float(margins[0]), "velocity_matches": float(margins[1]), "free_of": 0.0}


def test_every_option_that_the_page_names_exists():
    from runtime.worlds.pointmaze.environment import PointMazeEnv

    options = set(inspect.signature(PointMazeEnv).parameters)
    named = set(re.findall(r"`(\w+)=", PAGE.partition("## Many states at once")[0]))
    assert named == {"observe", "size", "terminate", "maze"}
    assert named <= options


def without_numbers(text):
    """Text in which no digit counts: seconds are the machine's, and search may differ in its last digits."""
    return re.sub(r"\d+([.,]\d+)*", "#", " ".join(text.split()))


def test_the_planned_trials_are_those_that_the_page_shows(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    command, shown = re.search(r"(?s)```console\n\$ onto (plan .*?)\n(.*?)```", PAGE).groups()
    assert main(command.split()) == 1
    assert without_numbers(capsys.readouterr().out) == without_numbers(shown)


def test_the_query_of_the_page_finds_what_promised_too_much(tmp_path):
    (query,) = re.findall(r"(?s)```sparql\n(.*?)```", PAGE)
    path = tmp_path / "trace.trig"
    write_trace(path, [("run", [planned()])], SCHEMA)
    rows = open_trace(path).query(query).records()
    assert [(row["predicate"].rpartition("#")[2], row["plans"], row["worst"]) for row in rows] == [
        ("at_target", 1, -0.1),
        ("velocity_matches", 1, -0.1),
    ]
