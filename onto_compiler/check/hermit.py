"""``onto check --reasoner hermit``: finds with HermiT what OWL 2 RL does not, and reports it as problems."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from pyoxigraph import NamedNode

from onto_compiler.check.finding import Finding
from onto_compiler.check.imports import Imports
from onto_compiler.check.locate import locate
from onto_compiler.check.model import Model, load_model
from onto_compiler.check.run import Report
from onto_compiler.check.tasks import split
from onto_compiler.problems import OntoError, Problem
from onto_compiler.rdf import OWL, RDF
from onto_compiler.reasoning.hermit import empty_classes

__all__ = ["with_hermit"]

_CODES = ("OWL005", "OWL006", "OWL009", "OWL010")  # codes that report a contradiction or an empty class


def with_hermit(
    report: Report,
    paths: Sequence[Path | str],
    texts: Mapping[Path, str] | None = None,
    imported: Mapping[str, Path] | None = None,
) -> Report:
    """``report`` of ``paths``, with the contradictions and empty classes that only HermiT finds.

    ``imported`` are files by the IRI that they are imported by.

    Raises:
        OntoError: CLI006, where HermiT cannot run.

    """
    turtle, tasks = split(paths)
    if tasks and not turtle:
        return report
    try:
        model = load_model(turtle, texts, lead=Imports(imported or {}))
    except OntoError:  # in the report already: files that are not Turtle are not reasoned with
        return report
    logical = {problem for problem in report.problems if problem.code in _CODES}
    # A contradiction that is named already would only be found again, without its axioms.
    contradiction = any(problem.code in {"OWL005", "OWL009"} for problem in logical)
    fresh = () if contradiction else locate(model, _findings(model))
    empty = {(problem.file, _named(problem)) for problem in logical}
    new = {problem for problem in fresh if (problem.file, _named(problem)) not in empty}
    return replace(report, problems=tuple(sorted({*report.problems, *new})))


def _named(problem: Problem) -> str:
    """The class that a problem is about: its message begins with it."""
    return problem.message.partition("` ")[0]


def _findings(model: Model) -> Iterator[Finding]:
    found = empty_classes(model.store)
    if found is None:
        for graph in model.graphs:
            for quad in model.store.quads_for_pattern(
                None, NamedNode(RDF + "type"), NamedNode(OWL + "Ontology"), graph
            ):
                yield Finding(
                    "OWL009",
                    "error",
                    "HermiT finds a contradiction in `{subject}` and what it imports",
                    "take out axioms by halves until it is gone; HermiT does not say which clash",
                    quad.subject,
                    graph=graph,
                )
    for iri in found or ():
        yield Finding(
            "OWL010",
            "error",
            "`{subject}` can have no instance, as HermiT finds",
            "correct what the class is a subclass of; HermiT does not say which axioms clash",
            NamedNode(iri),
        )
