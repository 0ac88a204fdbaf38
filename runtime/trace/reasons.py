"""The reasons of a decision: the rule and its location, what the route admits, and the other eligible routes.

A trace names the rules that fired; their text comes from the ontology, so the reasons are right only if the given
ontology is that of the run.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlparse

from pyoxigraph import Literal, NamedNode, Store

import ontology
from onto_compiler.rdf import RDF, SKOS, node
from onto_compiler.required import Fact
from onto_compiler.schema import Schema, local_name
from onto_compiler.sources import load_store
from onto_compiler.tables import EXHAUSTED, REPEAT
from onto_compiler.turtle.source_map import SourceMap, read_map
from onto_compiler.wording import counted
from runtime.loop.records import Attempt, Diagnosis, RouteDecision

__all__ = ["Reasons", "load_reasons"]


@dataclass(frozen=True)
class Reasons:
    """``store`` holds the ontology, one named graph per file; ``schema`` is what was compiled from it."""

    schema: Schema
    store: Store
    maps: dict[Path, SourceMap] = field(default_factory=dict, repr=False)

    def rule(self, iri: str) -> dict[str, Any]:
        """The name and text of a rule, and its file and line; None if unknown."""
        file, line, definition = None, None, None
        path = next(iter(self._files(iri)), None)
        if path is not None:
            if path not in self.maps:
                self.maps[path] = read_map(path)
            written = self.maps[path]
            place = written.find(node(iri), node(RDF + "type"))[0]
            definitions = [each.object for each in written.find(node(iri), node(SKOS + "definition"))]
            file, line = _shown(path), written.span(place.at_subject).line
            definition = next((term.value for term in definitions if isinstance(term, Literal)), None)
        return {
            "iri": iri,
            "label": self.schema.labels.get(iri, local_name(iri)),
            "definition": definition,
            "file": file,
            "line": line,
        }

    def kind(self, fact: Fact) -> str | None:
        """The kind that a fact's predicate is; None for a predicate that the ontology does not declare."""
        signature = self.schema.predicates.get(fact.predicate)
        return signature.kind if signature else None

    def eligible(self, diagnosis: Diagnosis, level: str) -> tuple[str, ...]:
        """Every route of ``level`` that admits the failure and supports the predicate's kind, by IRI."""
        kind = self.kind(diagnosis.fact)
        if kind is None:
            return ()
        kinds = self.schema.classes.get(kind, frozenset((kind,)))
        routes = [route for route in self.schema.routes.values() if route.level == level]
        return tuple(r.iri for r in routes if diagnosis.failure in r.admits and kinds & r.supports)

    def of_attempt(self, attempt: Attempt) -> dict[str, Any]:
        """The reasons of one attempt as plain JSON values."""
        decision = attempt.selected
        if decision is None:
            return {"diagnoses": [self._found(each, selected=False) for each in attempt.diagnoses], "route": None}
        diagnosis = decision.diagnosis
        kind = self.kind(diagnosis.fact)
        eligible = self.eligible(diagnosis, decision.level)
        return {
            "diagnoses": [self._found(each, selected=each.key == diagnosis.key) for each in attempt.diagnoses],
            "route": {
                "name": self._name(decision.route),
                "iri": decision.route,
                "level": decision.level,
                "decision": local_name(decision.decision).lower(),
                "after": self._name(decision.previous) if decision.previous else None,
                "admits": self._name(diagnosis.failure),
                "supports": local_name(kind) if kind else None,
                "rule": self.rule(decision.rule),
                "requested_level": decision.requested or None,
                "also_eligible": [self._name(iri) for iri in eligible if iri != decision.route],
            },
        }

    def _found(self, diagnosis: Diagnosis, *, selected: bool) -> dict[str, Any]:
        return {
            "fact_index": diagnosis.index,
            "priority": diagnosis.priority,
            "precondition": diagnosis.precondition,
            "selected": selected,
            "status": local_name(diagnosis.status),
            "source": diagnosis.source,
            "limit": diagnosis.limit or None,
            "required_margin": diagnosis.fact.threshold,
            "required_at": _required_at(diagnosis.fact),
            "rule": self.rule(diagnosis.rule),
        }

    # Sentences

    def of_diagnosis(self, diagnosis: Diagnosis) -> Iterator[str]:
        """Where the fact is required, and the text of the rule that named its failure."""
        place = _required_at(diagnosis.fact)
        least = f" with a margin of at least {diagnosis.fact.threshold:g}" if diagnosis.fact.threshold else ""
        if place is not None:
            yield f"Required at {place}{least}."
        elif least:
            yield f"Required{least}."
        yield from self._rule(diagnosis.rule)

    def of_selection(self, attempt: Attempt) -> Iterator[str]:
        """Why one of several diagnoses was selected."""
        others = len(attempt.diagnoses) - 1
        if not others or attempt.selected is None:
            return
        chosen = attempt.selected.diagnosis
        ties = [each for each in attempt.diagnoses if each.priority == chosen.priority]
        rank = f"priority {chosen.priority} is the least"
        first = ", and of those with it this fact comes first" if len(ties) > 1 else ""
        yield f"Chosen before {counted(others, 'other')}: {rank}{first}."

    def of_route(self, decision: RouteDecision) -> Iterator[str]:
        """What made the route eligible, which others are, and what the rule says that chose."""
        failure, kind = decision.diagnosis.failure, self.kind(decision.diagnosis.fact)
        known = self.schema.routes.get(decision.route)
        name = f"`{self._name(decision.route)}`"
        eligible = self.eligible(decision.diagnosis, decision.level)
        if decision.requested:
            yield f"The run acts at the {decision.requested} level."
        if known is not None and kind is not None and decision.route in eligible:
            predicate = self._name(decision.diagnosis.fact.predicate)
            yield f"{name} admits {self._name(failure)} and supports {local_name(kind)}, the kind of `{predicate}`."
        yield from self._rule(decision.rule)
        previous = self.schema.routes.get(decision.previous or "")
        if previous is not None and decision.attempt_status in {REPEAT, EXHAUSTED}:
            successor = previous.on_rejection
            before = f"`{previous.name}`"
            yield f"{before} names {f'`{self._name(successor)}`' if successor else 'no route'} for rejections."
        others = [iri for iri in eligible if iri != decision.route]
        successor = known.on_rejection if known is not None else None
        for iri in others:
            role = f", to which {name} leaves what it fails at" if iri == successor else ""
            yield f"Eligible as well: `{self._name(iri)}`{role}."
        if not others:
            yield f"No other route of the {decision.level} level is eligible."

    def _rule(self, iri: str) -> Iterator[str]:
        rule = self.rule(iri)
        if rule["definition"]:
            yield f"The rule: {rule['definition']}"
        yield f"Its place: {rule['file']}:{rule['line']} <{iri}>." if rule["file"] else f"Its name: <{iri}>."

    def _name(self, iri: str) -> str:
        return self.schema.notations.get(iri, local_name(iri))

    def _files(self, iri: str) -> list[Path]:
        """The files that declare ``iri``, the user's own before the shipped ones that they take the place of."""
        declared = self.store.quads_for_pattern(node(iri), node(RDF + "type"), None, None)
        paths = {path for quad in declared if (path := _path(quad.graph_name)) is not None}
        return sorted(paths, key=lambda path: (path.is_relative_to(ontology.ROOT), path))


def load_reasons(schema: Schema, extra: Sequence[str | Path]) -> Reasons:
    """Reasons from the shipped ontology with the user's own files on top.

    Raises:
        OntoError: TTL0nn, where one of the files is not Turtle.

    """
    return Reasons(schema, load_store(extra))


def _required_at(fact: Fact) -> str | None:
    span = fact.span
    return f"{span.file}:{span.line}:{span.column}" if span is not None else None


def _path(graph: object) -> Path | None:
    address = urlparse(graph.value) if isinstance(graph, NamedNode) else None
    return Path(unquote(address.path)) if address is not None and address.scheme == "file" else None


def _shown(path: Path) -> str:
    """A path relative to the working folder or to the shipped ontology."""
    for root in (Path.cwd(), ontology.ROOT.parent):
        if path.is_relative_to(root):
            return path.relative_to(root).as_posix()
    return str(path)
