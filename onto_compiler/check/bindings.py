"""Checks on the strings of bindings: regular expressions, and the names of grounding functions."""

from __future__ import annotations

import re
from collections.abc import Iterator

from pyoxigraph import NamedNode

import ontology
from onto_compiler.check.finding import Finding
from onto_compiler.check.model import Model
from onto_compiler.problems import near
from onto_compiler.rdf import CORE

__all__ = ["check_bindings"]

_PATTERN = NamedNode(CORE + "landmarkPattern")
_PATTERNS = "SELECT ?binding ?pattern WHERE { ?binding core:landmarkPattern ?pattern }"
_GROUNDED = """
SELECT ?term ?property ?name ?file WHERE {
    VALUES ?property { core:groundedBy core:premiseGroundedBy } GRAPH ?file { ?term ?property ?name } }"""
_NAMED_GROUP = re.compile(r"\(\?<(?=\w)")  # SPARQL's relatives write a named group as JavaScript does


def check_bindings(model: Model) -> Iterator[Finding]:
    """Landmark patterns that are no regular expression or name no landmark; grounding names that are not registered."""
    for row in model.rows(_PATTERNS):
        text = row["pattern"].value
        try:
            groups = re.compile(_NAMED_GROUP.sub("(?P<", text)).groupindex
        except re.error as error:
            yield Finding(
                "BND004",
                "error",
                f"the landmark pattern of `{{subject}}` is no regular expression: {error.msg}",
                "write one as `(?<landmark>.+)_left_region`",
                row["binding"],
                _PATTERN,
                row["pattern"],
                inside=(_back(text, error.pos or 0), 1),
            )
            continue
        if "landmark" not in groups:
            yield Finding(
                "BND005",
                "error",
                "the landmark pattern of `{subject}` has no group named landmark",
                "put `(?<landmark>...)` around what names the second argument",
                row["binding"],
                _PATTERN,
                row["pattern"],
            )
    yield from _unregistered(model)


def _back(text: str, position: int) -> int:
    """A place in the rewritten pattern as a place in ``text``: each named group before it grew by one character."""
    grown = sum(1 for match in _NAMED_GROUP.finditer(text) if match.end() < position)
    return max(min(position - grown, len(text) - 1), 0)


def _unregistered(model: Model) -> Iterator[Finding]:
    """Grounding names that neither the shipped bindings nor any installed package (by its entry points) know."""
    files = {path.as_uri() for path in ontology.turtle_files()}
    rows = list(model.rows(_GROUNDED))
    known = {row["name"].value for row in rows if row["file"].value in files}
    new = [row for row in rows if row["name"].value not in known]
    if not new:
        return
    from importlib.metadata import entry_points  # noqa: PLC0415 - a slow import that the clean path does without

    known |= {entry.name for entry in entry_points(group="onto_evwm.groundings")}
    for row in new:
        name = row["name"].value
        if name not in known:
            yield Finding(
                "BND011",
                "warning",
                f"no grounding function is registered as `{name}`, which `{{subject}}` names",
                near(name, known) or "register it as an entry point of the group onto_evwm.groundings",
                row["term"],
                row["property"],
                row["name"],
            )
