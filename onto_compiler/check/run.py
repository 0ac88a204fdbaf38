"""All checks in a row. A clean run is a load and some two hundred SPARQL queries; no Python reads Turtle in it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, cast

from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from onto_compiler.check.bindings import check_bindings
from onto_compiler.check.consistency import check_consistency
from onto_compiler.check.datatypes import check_datatypes
from onto_compiler.check.deprecated import check_deprecated
from onto_compiler.check.domains import check_domains
from onto_compiler.check.finding import Finding, Term
from onto_compiler.check.hierarchy import check_hierarchy
from onto_compiler.check.house import House
from onto_compiler.check.imports import Imports
from onto_compiler.check.model import Model, load_model
from onto_compiler.check.prefixes import check_prefixes
from onto_compiler.check.profile_dl import check_dl
from onto_compiler.check.profile_rl import check_rl
from onto_compiler.check.progress import Step, silent
from onto_compiler.check.queries import query_checks, run_query
from onto_compiler.check.query_terms import check_query_terms
from onto_compiler.check.rules import check_rules
from onto_compiler.check.settings import DEFAULT, Settings
from onto_compiler.check.suppressions import unsuppressed
from onto_compiler.check.terms import check_terms
from onto_compiler.check.undeclared import check_imports, check_undeclared
from onto_compiler.problems import OntoError, Problem
from onto_compiler.reasoning.axioms import TYPE
from onto_compiler.shacl.compile import compile_graph
from onto_compiler.shacl.graph import Graph
from onto_compiler.shacl.model import ShapeFault, ShapeResult
from onto_compiler.shacl.naming import shape_id, shape_label, shape_name
from onto_compiler.shacl.report import record
from onto_compiler.shacl.severity import level
from onto_compiler.shacl.validate import validate_graph
from onto_compiler.terms import Sentence, sentence, show
from onto_compiler.validator.engine import with_implications

__all__ = ["Report", "Validated", "check", "check_model"]


@dataclass(frozen=True, slots=True)
class Validated:
    """The results of a validation with shapes, for a report of their own."""

    results: tuple[ShapeResult, ...]
    shapes: Graph
    complete: bool = True  # every shape ran


@dataclass(frozen=True, slots=True)
class Report:
    """The problems, and the number of files and triples.

    ``consulted`` are files that decide the result beside those: imported ones, and catalogs that are there or not.
    """

    problems: tuple[Problem, ...]
    files: tuple[Path, ...]
    triples: int
    validation: Validated | None = None
    consulted: tuple[Path, ...] = ()


def check(
    paths: Sequence[Path | str] = (),
    texts: Mapping[Path, str] | None = None,
    settings: Settings = DEFAULT,
    step: Step = silent,
) -> Report:
    """Check ``paths`` before the shipped ontology, or the shipped ontology itself; ``texts`` as :func:`load_model`.

    A file that is missing or is not Turtle is a problem as any other. What it would have declared is not known: of the
    other files, problems are then left out that such a declaration would solve. ``step`` is called before each part of
    the work.
    """
    unreadable: list[Problem] = []
    lead = Imports(settings.imported)
    try:
        model = load_model(paths, texts, unreadable, lead)
    except OntoError as error:
        return Report(error.problems, tuple(dict.fromkeys(Path(problem.file) for problem in error.problems)), 0)
    found = check_model(model, settings, step) if model.files else ()
    if unreadable:
        found = tuple(one for one in found if not one.code.startswith(_OF_ALL_FILES))
    files = dict.fromkeys((*model.files, *(Path(problem.file) for problem in unreadable)))
    found = (*found, *unreadable, *settings.chosen(lead.unused(dict(settings.mapped))))
    return Report(tuple(sorted(set(found))), tuple(files), model.triples, consulted=tuple(sorted(lead.consulted)))


def check_model(model: Model, settings: Settings = DEFAULT, step: Step = silent) -> tuple[Problem, ...]:
    """Every problem of the model's reported files, in file order."""
    house = House(model, settings.namespaces, settings.select)
    parts = len(_CHECKS) + len(_LOGICAL) + 1
    problems = [house.judged_problem(problem, graph) for problem, graph in check_prefixes(model)]
    findings: list[Finding] = []
    for done, (doing, run) in enumerate(_CHECKS):
        step(doing, done, parts)
        findings += house.judged(run(model))
    # A value of the wrong class is often a contradiction too; the first word on a triple is the clearer one.
    reported = {(finding.subject, finding.predicate, finding.object) for finding in findings}
    for done, (doing, run) in enumerate(_LOGICAL, len(_CHECKS)):
        step(doing, done, parts)
        logical = house.judged(run(model))
        findings += (one for one in logical if (one.subject, one.predicate, one.object) not in reported)
    if findings:
        from onto_compiler.check.locate import locate  # noqa: PLC0415 - a clean run never needs a source map

        step("lines and columns", parts - 1, parts)
        problems += locate(model, findings)
    return tuple(sorted(_unsuppressed(model, set(settings.chosen(problems)), settings)))


def _unsuppressed(model: Model, problems: set[Problem], settings: Settings) -> Iterator[Problem]:
    by_file: dict[str, list[Problem]] = {str(path): [] for path in model.files}
    for problem in problems:
        by_file.setdefault(problem.file, []).append(problem)
    for path in model.files:
        yield from unsuppressed(str(path), model.text(path), by_file.pop(str(path)), settings.reports)
    for others in by_file.values():
        yield from others


def _queried(model: Model) -> Iterator[Finding]:
    for one in query_checks():
        for finding in run_query(model, one):
            if finding.code != "OWL003" or finding.object in model.unresolved:  # no query sees where a catalog leads
                yield finding


def _shape_findings(model: Model) -> Iterator[Finding]:
    faults: list[ShapeFault] = []
    shapes = with_implications(compile_graph(model.graph, faults))
    for result in validate_graph(model.graph, shapes, faults):
        yield _finding(model, result)
    yield from map(fault_finding, faults)


def fault_finding(fault: ShapeFault) -> Finding:
    """A shape that cannot run, at the parameter that is at fault."""
    code, message, hint = fault.fields
    parameter = fault.predicate
    return Finding(code, "error", message, hint, fault.shape, parameter, fault.value, inside=fault.inside)


def _finding(model: Model, result: ShapeResult) -> Finding:
    template, values = _sentence(model, result)
    finding = Finding(
        code=result.code or "SHP001",
        severity=level(result.severity, model.graph),
        message=f"`{{subject}}` {template}",
        hint=result.hint or "change the data, or the shape; see `onto explain SHP001`",
        subject=result.focus,
        predicate=result.path if isinstance(result.path, NamedNode) else None,
        object=result.value if isinstance(result.path, NamedNode) else None,
        values={**values, **_untyped(model, result)},
        result=_record(model, result),
    )
    named = isinstance(result.focus, (NamedNode, BlankNode))
    return finding if named else _of_value(model, result.focus, finding)


def _untyped(model: Model, result: ShapeResult) -> Mapping[str, Term]:
    """The value that lacks the class which a shape asks for, where it has no class at all."""
    value = result.value
    if result.component.endswith("ClassConstraintComponent") and isinstance(value, NamedNode):
        return {} if model.graph.objects(value, TYPE) else {"untyped": value}
    return {}


def _sentence(model: Model, result: ShapeResult) -> tuple[str, dict[str, Term | Triple | str]]:
    """What a result says of its focus node: a template, and what fills it with the prefixes of a file."""
    values: dict[str, Term | Triple | str] = {}

    def slot(part: Term | Triple | str) -> str:
        values[f"part{len(values)}"] = show(part) if isinstance(part, Literal) else part
        return f"{{part{len(values) - 1}}}"

    named = partial(shape_name, model.graph, name=slot)
    said: Sentence = result.message or result.expected
    parts = (said,) if isinstance(said, str) else said
    text = sentence(tuple(slot(part) if isinstance(part, str) else part for part in parts), slot, named)
    return (text if result.code else f"violates {named(result.shape)}: {text}"), values


def _record(model: Model, result: ShapeResult) -> dict[str, Any]:
    name = shape_id(model.graph, result.shape, show)
    label = shape_label(model.graph, result.shape)
    return {**record(result, model.graph), "shape": {"name": name, "label": label}}


def _of_value(model: Model, value: Term | Triple, finding: Finding) -> Finding:
    """The finding about a term that is no subject, as a literal: it belongs to the first triple that holds it."""
    holders = (quad for quad in model.written if quad.object == value and quad.graph_name in model.graphs)
    first = next(holders, None)
    if first is None:
        return replace(finding, subject=None)
    subject = cast("Term", first.subject)
    values = {**finding.values, "subject": show(value) if isinstance(value, Literal) else value}
    return replace(finding, subject=subject, predicate=first.predicate, object=value, values=values)


_OF_ALL_FILES = (
    "BND",
    "CFG002",
    "IMP001",
    "OWL003",
    "OWL007",
    "OWL008",
    "RTE",
    "RUL",
    "SCR",
    "SIG",
    "VOC001",
    "VOC002",
    "VOC003",
)
"""How the codes begin of what is wrong only where no other file declares it."""
_CHECKS: tuple[tuple[str, Callable[[Model], Iterable[Finding]]], ...] = (
    ("declarations", _queried),
    ("undeclared names", check_undeclared),
    ("imports", check_imports),
    ("hierarchy", check_hierarchy),
    ("domains and ranges", check_domains),
    ("datatypes", check_datatypes),
    ("deprecated terms", check_deprecated),
    ("standard vocabularies", check_terms),
    ("names in queries", check_query_terms),
    ("rules", check_rules),
    ("bindings", check_bindings),
    ("shapes", _shape_findings),
)
_LOGICAL: tuple[tuple[str, Callable[[Model], Iterable[Finding]]], ...] = (
    ("OWL 2 DL", check_dl),
    ("OWL 2 RL", check_rl),
    ("contradictions", check_consistency),
)
