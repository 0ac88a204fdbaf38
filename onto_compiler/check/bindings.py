"""Checks on names that programs answer to: regular expressions, grounding functions, and what serves a route."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from pyoxigraph import NamedNode

from onto_compiler.check.finding import Finding
from onto_compiler.check.model import Model
from onto_compiler.problems import near
from onto_compiler.rdf import CORE
from onto_compiler.registered import GROUNDINGS, SERVING, points_of, route_of
from onto_compiler.schema import local_name

__all__ = ["check_bindings"]

_PATTERN = NamedNode(CORE + "landmarkPattern")
_PATTERNS = "SELECT ?binding ?pattern WHERE { ?binding core:landmarkPattern ?pattern }"
_GROUNDED = """
SELECT ?term ?property ?name WHERE {
    VALUES ?property { core:groundedBy core:premiseGroundedBy } ?term ?property ?name }"""
_ROUTES = """
SELECT ?route ?level ?notation WHERE {
    ?route a/rdfs:subClassOf* core:CorrectionRoute ; core:level/skos:notation ?level .
    OPTIONAL { ?route skos:notation ?notation } }"""
_NAMED_GROUP = re.compile(r"\(\?<(?=\w)")  # SPARQL's relatives write a named group as JavaScript does


def check_bindings(model: Model) -> Iterator[Finding]:
    """Landmark patterns that are no regular expression or name no landmark; what no installed package registers."""
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
    registered = points_of((GROUNDINGS, *(group for group, _ in SERVING.values())))
    yield from _unregistered(model, {point.name for point in registered[GROUNDINGS]})
    yield from _unserved(model, {group: set(map(route_of, found)) for group, found in registered.items()})


def _back(text: str, position: int) -> int:
    """A place in the rewritten pattern as a place in ``text``: each named group before it grew by one character."""
    grown = sum(1 for match in _NAMED_GROUP.finditer(text) if match.end() < position)
    return max(min(position - grown, len(text) - 1), 0)


def _unregistered(model: Model, known: set[str]) -> Iterator[Finding]:
    """Grounding names that no installed package registers."""
    for row in model.rows(_GROUNDED):
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


def _unserved(model: Model, served: Mapping[str, set[str]]) -> Iterator[Finding]:
    """Routes that no installed package has a proposer, a skill or a mechanism for, ``served`` by its group."""
    for row in model.rows(_ROUTES):
        group, what = SERVING.get(row["level"].value, ("", ""))
        name = row["notation"].value if "notation" in row else local_name(row["route"].value)
        known = served.get(group, {name})
        if name not in known:
            yield Finding(
                "RTE015",
                "warning",
                f"no {what} is registered as `{name}`, so that nothing serves the route `{{subject}}`",
                near(name, known) or f"install the package that registers it in the entry-point group {group}",
                row["route"],
            )
