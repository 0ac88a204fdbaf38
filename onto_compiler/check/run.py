"""All checks in a row. A clean run is a load and some two hundred SPARQL queries; no Python reads Turtle in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, cast

from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from onto_compiler.check.bindings import check_bindings
from onto_compiler.check.consistency import check_consistency
from onto_compiler.check.finding import Finding, Term
from onto_compiler.check.hierarchy import check_hierarchy
from onto_compiler.check.model import Model, load_model
from onto_compiler.check.prefixes import check_prefixes
from onto_compiler.check.profile_dl import check_dl
from onto_compiler.check.profile_rl import check_rl
from onto_compiler.check.queries import query_checks, run_query
from onto_compiler.check.rules import check_rules
from onto_compiler.check.terms import check_terms
from onto_compiler.problems import OntoError, Problem
from onto_compiler.rdf import SH
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
    """The problems, and the number of files and triples."""

    problems: tuple[Problem, ...]
    files: tuple[Path, ...]
    triples: int
    validation: Validated | None = None


def check(paths: Sequence[Path | str] = (), texts: Mapping[Path, str] | None = None) -> Report:
    """Check ``paths`` before the shipped ontology, or the shipped ontology itself; ``texts`` as :func:`load_model`.

    A file that is missing or is not Turtle is a problem as any other; nothing else is then checked, because what such a
    file would have declared is not known.
    """
    try:
        model = load_model(paths, texts)
    except OntoError as error:
        return Report(error.problems, tuple(dict.fromkeys(Path(problem.file) for problem in error.problems)), 0)
    return Report(check_model(model), model.files, model.triples)


def check_model(model: Model) -> tuple[Problem, ...]:
    """Every problem of the model's reported files, in file order."""
    problems = list(check_prefixes(model))
    findings = [finding for one in query_checks() for finding in run_query(model, one)]
    findings += [*check_hierarchy(model), *check_terms(model), *check_rules(model), *check_bindings(model)]
    findings += _shape_findings(model)
    # A value of the wrong class is often a contradiction too; the first word on a triple is the clearer one.
    reported = {(finding.subject, finding.predicate, finding.object) for finding in findings}
    logical = (*check_dl(model), *check_rl(model), *check_consistency(model))
    findings += (one for one in logical if (one.subject, one.predicate, one.object) not in reported)
    if findings:
        from onto_compiler.check.locate import locate  # noqa: PLC0415 - a clean run never needs a source map

        problems += locate(model, findings)
    return tuple(sorted(set(problems)))


def _shape_findings(model: Model) -> Iterator[Finding]:
    faults: list[ShapeFault] = []
    shapes = with_implications(compile_graph(model.graph, faults))
    for result in validate_graph(model.graph, shapes, faults):
        yield _finding(model, result)
    yield from map(fault_finding, faults)


def fault_finding(fault: ShapeFault) -> Finding:
    """A shape that cannot run, at the parameter that is at fault."""
    code, message, hint = fault.fields
    parameter = NamedNode(SH + fault.parameter) if fault.parameter else None
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
        values=values,
        result=_record(model, result),
    )
    named = isinstance(result.focus, (NamedNode, BlankNode))
    return finding if named else _of_value(model, result.focus, finding)


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
