"""Syntax tree to text, in one canonical layout.

Comments are not part of the tree; :mod:`onto_compiler.bddl.layout` puts them back beside what they stood beside.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from onto_compiler.bddl.ast import (
    And,
    Atom,
    Declaration,
    Formula,
    Imply,
    Not,
    Or,
    Quantified,
    Region,
    TaskSpec,
    Variable,
)
from onto_compiler.bddl.dialects import dialect_of
from onto_compiler.problems import Span

__all__ = ["Line", "format_task", "layout"]


@dataclass(frozen=True, slots=True)
class Line:
    """A printed line, the keyword of its section, and the place in the source of what it prints (None: a bracket)."""

    text: str
    at: Span | None = None
    section: str = ""


def format_task(spec: TaskSpec) -> str:
    """``spec`` as a task file: ``parse(format_task(spec)) == spec``, and LIBERO's reader finds what it found before.

    Names that share a category and stand beside each other share a line. Numbers keep every digit that their value
    needs.
    """
    return "".join(f"{line.text}\n" for line in layout(spec))


def layout(spec: TaskSpec) -> Iterator[Line]:
    """The lines of ``spec`` in the order in which they are printed; sections are set apart by empty ones."""
    language = spec.language or "language" in dialect_of(spec.domain).needed
    negated = [Line(f"(not {atom})", atom.span) for atom in spec.absent]
    initial = [Line(str(atom), atom.span) for atom in spec.init] + negated
    sections = {
        ":domain": [Line(f"(:domain {spec.domain})", spec.domain_span)],
        ":requirements": [Line(f"(:requirements {' '.join(spec.requirements)})")] if spec.requirements else [],
        ":language": [Line(f"(:language {spec.language})", spec.language_span)] if language else [],
        ":regions": _section(":regions", [line for region in spec.regions for line in _region(region)]),
        ":fixtures": _section(":fixtures", list(_declarations(spec.fixtures))),
        ":objects": _section(":objects", list(_declarations(spec.objects))),
        ":obj_of_interest": _section(":obj_of_interest", [Line(each.name, each.span) for each in spec.interest]),
        ":scene_properties": _section(":scene_properties", [Line(f"({key} {value})") for key, value in spec.scene]),
        ":init": _section(":init", initial) or [Line("(:init)")],
        ":goal": _section(":goal", list(_formula(spec.goal))),
    }
    yield Line(f"(define (problem {spec.problem})", section="problem")
    shown = {keyword: lines for keyword, lines in sections.items() if lines}
    for number, (keyword, lines) in enumerate(shown.items()):
        if number:
            yield Line("")
        yield from (replace(line, section=keyword) for line in _indented(lines))
    yield Line(")")


def _indented(lines: Iterable[Line]) -> Iterator[Line]:
    return (replace(line, text=f"  {line.text}") for line in lines)


def _section(keyword: str, lines: Sequence[Line]) -> list[Line]:
    return [Line(f"({keyword}"), *_indented(lines), Line(")")] if lines else []


def _region(region: Region) -> Iterator[Line]:
    yield Line(f"({region.name}", region.span)
    yield Line(f"  (:target {region.target})", region.target.span)
    if region.ranges:
        yield Line(f"  (:ranges ({' '.join(map(_numbers, region.ranges))}))")
    if region.yaw is not None:
        yield Line(f"  (:yaw_rotation ({_numbers(region.yaw)}))")
    if region.rgba is not None:
        yield Line(f"  (:rgba {_numbers(region.rgba)})")
    yield Line(")")


def _numbers(values: Sequence[float]) -> str:
    return f"({' '.join(map(repr, values))})"


def _declarations(declarations: Sequence[Declaration]) -> Iterator[Line]:
    for category, group in groupby(declarations, key=lambda each: each.category):
        names = list(group)
        yield Line(f"{' '.join(each.name for each in names)} - {category}", names[0].span)


def _formula(formula: Formula) -> Iterator[Line]:
    match formula:
        case Atom():
            yield Line(str(formula), formula.span)
        case Not(part=part):
            yield from _connective("Not", (part,), formula.span)
        case And(parts=parts):
            yield from _connective("And", parts, formula.span)
        case Or(parts=parts):
            yield from _connective("Or", parts, formula.span)
        case Imply(antecedent=antecedent, consequent=consequent):
            yield from _connective("imply", (antecedent, consequent), formula.span)
        case Quantified(kind=kind, variables=variables, body=body, count=count):
            number = "" if count is None else f" ({count})"
            yield Line(f"({kind}{number} {' '.join(map(_variable, variables))}", formula.span)
            yield from _indented(_formula(body))
            yield Line(")")


def _variable(variable: Variable) -> str:
    return f"({variable.name} - {variable.category})"


def _connective(word: str, parts: Sequence[Formula], span: Span) -> Iterator[Line]:
    if not parts:
        yield Line(f"({word})", span)
    elif len(parts) == 1 and isinstance(parts[0], Atom):
        yield Line(f"({word} {parts[0]})", span)
    else:
        yield Line(f"({word}", span)
        for part in parts:
            yield from _indented(_formula(part))
        yield Line(")")
