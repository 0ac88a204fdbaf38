"""What adding a field to a record takes: it is added to a scratch copy of the tree, and goes through every form there.

:func:`add_a_field` edits the sources as a person would, generates what is generated, and lets a fresh process write,
read, print, tell and validate an episode that has the new field. ``python -m benchmarks.house_field`` prints what it
edited.
"""

from __future__ import annotations

import filecmp
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

__all__ = ["FIELD", "FileEdit", "add_a_field"]

ROOT = Path(__file__).resolve().parents[1]
PARTS = ("ontology", "onto_compiler", "grounding", "runtime", "benchmarks", "schema")
FIELD = "remark"
"""The field that is added: what somebody says of a verification; an empty one is left out."""


@dataclass(frozen=True, slots=True)
class FileEdit:
    """Put ``text`` after the one place of ``file`` that reads ``after``."""

    file: str
    after: str
    text: str

    def make(self, root: Path) -> None:
        """Edit the file below ``root``; raises ValueError where there is not exactly one such place."""
        path = root / self.file
        before = path.read_text(encoding="utf-8")
        if before.count(self.after) != 1:
            raise ValueError(f"`{self.file}` has {before.count(self.after)} places that read {self.after!r}")
        path.write_text(before.replace(self.after, self.after + self.text), encoding="utf-8")


TERM = f"""
trace:{FIELD} a owl:DatatypeProperty , owl:FunctionalProperty ;
    rdfs:label "{FIELD}"@en ;
    skos:definition "What somebody says of a verification."@en ;
    rdfs:domain trace:Verification ;
    rdfs:range xsd:string ;
    rdfs:isDefinedBy <https://w3id.org/onto-evwm/trace> .
"""
_BEFORE = """
trace:reason a owl:DatatypeProperty , owl:FunctionalProperty ;
    rdfs:label "reason"@en ;
    skos:definition "Why a mechanism gave up, in its own words."@en ;
    rdfs:domain trace:Application ;
    rdfs:range xsd:string ;
    rdfs:isDefinedBy <https://w3id.org/onto-evwm/trace> .
"""
EDITS = (
    FileEdit("runtime/loop/records.py", "    settle_steps: int = 0\n", f'    {FIELD}: str = ""\n'),
    FileEdit(
        "runtime/trace/table.py",
        '        Field("settle_steps", TRACE + "settleSteps", INTEGER, asked=False, key=""),\n',
        f'        Field("{FIELD}", TRACE + "{FIELD}", TEXT, missing=""),\n',
    ),
    FileEdit("ontology/trace.ttl", _BEFORE, TERM),
    FileEdit(
        "runtime/trace/narrate.py",
        '    text = f"Verification: {judge} {verdict} {verification.query}"\n',
        f'    text += f" ({{verification.{FIELD}}})" * bool(verification.{FIELD})\n',
    ),
)
PROOF = f"""
import json
from dataclasses import replace

import numpy as np
from jsonschema import Draft202012Validator
from pyoxigraph import Literal, Quad, Store

import runtime
from benchmarks.generated import generated_episode
from onto_compiler.knowledge import load_knowledge
from onto_compiler.rdf import TRACE
from onto_compiler.validator.records import record_validator
from runtime.trace.names import iri_of
from runtime.trace.narrate import narrate
from runtime.trace.read import read_episode
from runtime.trace.summary import episode_summary
from runtime.trace.write import episode_quads

assert runtime.__file__.startswith(ROOT), runtime.__file__
knowledge = load_knowledge()
plain = generated_episode(np.random.default_rng(1), knowledge, 0)
episode = replace(plain, attempts=(), verification=replace(plain.verification, {FIELD}="seen twice"))
store = Store()
store.extend(episode_quads(episode, knowledge.schema, "house"))
back = read_episode(store, iri_of("house", episode))
assert back.verification == episode.verification, back.verification

record = episode_summary(back, knowledge.schema)
assert record["verification"]["{FIELD}"] == "seen twice", record["verification"]
schema = json.loads(open(ROOT + "/schema/records.schema.json", encoding="utf-8").read())
row = Draft202012Validator({{"$ref": "#/$defs/Verification", "$defs": schema["$defs"]}})
assert row.is_valid(record["verification"])
assert not row.is_valid({{**record["verification"], "{FIELD}": 7}})

quads = list(store)
assert not record_validator().validate(quads)
(said,) = [quad for quad in quads if quad.predicate.value == TRACE + "{FIELD}"]
twice = Quad(said.subject, said.predicate, Literal("again"), said.graph_name)
assert {{result.code for result in record_validator().validate([*quads, twice])}} == {{"ABX004"}}
assert any("(seen twice)" in line for line in narrate(back, knowledge.schema))
"""


def add_a_field(scratch: Path | None = None) -> list[str]:
    """Add :data:`FIELD` to a copy of the tree in ``scratch`` (a temporary folder, if left out) and prove it there.

    Returns the paths of the sources that had to be edited, as a comparison of the two trees finds them; the files that
    ``onto schema --write`` generates are not among them.

    Raises:
        ValueError: where a source no longer reads as the edit expects.
        subprocess.CalledProcessError: where the new field is lost on its way, or ``onto`` finds a problem.
    """
    if scratch is None:
        with tempfile.TemporaryDirectory(prefix="onto-field-") as folder:
            return add_a_field(Path(folder))
    for part in PARTS:
        shutil.copytree(ROOT / part, scratch / part, ignore=shutil.ignore_patterns("__pycache__"), symlinks=False)
    shutil.copy(ROOT / "pyproject.toml", scratch)
    for edit in EDITS:
        edit.make(scratch)
    for words in (("schema", "--write"), ("schema", "--check"), ("fmt", "--check", "ontology"), ("check",)):
        _python(scratch, "-c", "import sys; from runtime.cli import main; sys.exit(main(sys.argv[1:]))", *words)
    _python(scratch, "-c", f"ROOT = {str(scratch)!r}\n{PROOF}")
    generated = set(
        tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["onto"]["schema"].values()
    )
    return sorted(set(_changed(scratch)) - generated)


def _python(root: Path, *words: str) -> None:
    """Run Python in the copy, whose packages come before the installed ones."""
    environment = {**os.environ, "PYTHONPATH": str(root)}
    subprocess.run([sys.executable, *words], cwd=root, env=environment, check=True, stdout=sys.stderr)  # noqa: S603


def _changed(scratch: Path) -> Iterator[str]:
    for part in PARTS:
        for path in (scratch / part).rglob("*"):
            name = path.relative_to(scratch)
            if path.is_file() and path.suffix != ".pyc":
                before = ROOT / name
                if not before.is_file() or not filecmp.cmp(before, path, shallow=False):
                    yield name.as_posix()


if __name__ == "__main__":
    sys.stdout.write("\n".join(add_a_field()) + "\n")
