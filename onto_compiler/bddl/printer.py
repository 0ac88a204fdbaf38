"""Syntax tree to text, in one canonical layout. Comments are not part of the tree, and are lost."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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

__all__ = ["format_task"]


def format_task(spec: TaskSpec) -> str:
    """``spec`` as a task file: ``parse(format_task(spec)) == spec``, and LIBERO's reader finds what it found before.

    Names that share a category and stand beside each other share a line. Numbers keep every digit that their value
    needs.
    """
    sections = [
        [f"(:domain {spec.domain})"],
        [f"(:requirements {' '.join(spec.requirements)})"] if spec.requirements else [],
        [f"(:language {spec.language})"] if spec.language or "language" in dialect_of(spec.domain).needed else [],
        _section(":regions", [line for region in spec.regions for line in _region(region)]),
        _section(":fixtures", list(_declarations(spec.fixtures))),
        _section(":objects", list(_declarations(spec.objects))),
        _section(":obj_of_interest", [symbol.name for symbol in spec.interest]),
        _section(":scene_properties", [f"({key} {value})" for key, value in spec.scene]),
        _section(":init", [*map(str, spec.init), *(f"(not {atom})" for atom in spec.absent)]) or ["(:init)"],
        _section(":goal", list(_formula(spec.goal))),
    ]
    body = "\n\n".join("\n".join(f"  {line}" for line in section) for section in sections if section)
    return f"(define (problem {spec.problem})\n{body}\n)\n"


def _section(keyword: str, lines: Sequence[str]) -> list[str]:
    return [f"({keyword}", *(f"  {line}" for line in lines), ")"] if lines else []


def _region(region: Region) -> Iterator[str]:
    yield f"({region.name}"
    yield f"  (:target {region.target})"
    if region.ranges:
        yield f"  (:ranges ({' '.join(map(_numbers, region.ranges))}))"
    if region.yaw is not None:
        yield f"  (:yaw_rotation ({_numbers(region.yaw)}))"
    if region.rgba is not None:
        yield f"  (:rgba {_numbers(region.rgba)})"
    yield ")"


def _numbers(values: Sequence[float]) -> str:
    return f"({' '.join(map(repr, values))})"


def _declarations(declarations: Sequence[Declaration]) -> Iterator[str]:
    for category, group in groupby(declarations, key=lambda each: each.category):
        yield f"{' '.join(each.name for each in group)} - {category}"


def _formula(formula: Formula) -> Iterator[str]:
    match formula:
        case Atom():
            yield str(formula)
        case Not(part=part):
            yield from _connective("Not", (part,))
        case And(parts=parts):
            yield from _connective("And", parts)
        case Or(parts=parts):
            yield from _connective("Or", parts)
        case Imply(antecedent=antecedent, consequent=consequent):
            yield from _connective("imply", (antecedent, consequent))
        case Quantified(kind=kind, variables=variables, body=body, count=count):
            number = "" if count is None else f" ({count})"
            yield f"({kind}{number} {' '.join(map(_variable, variables))}"
            yield from (f"  {line}" for line in _formula(body))
            yield ")"


def _variable(variable: Variable) -> str:
    return f"({variable.name} - {variable.category})"


def _connective(word: str, parts: Sequence[Formula]) -> Iterator[str]:
    if not parts:
        yield f"({word})"
    elif len(parts) == 1 and isinstance(parts[0], Atom):
        yield f"({word} {parts[0]})"
    else:
        yield f"({word}"
        for part in parts:
            yield from (f"  {line}" for line in _formula(part))
        yield ")"
