"""What is legal in a task file and yet likely a slip. Findings are warnings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

from onto_compiler.bddl import codes
from onto_compiler.bddl.ast import Declaration, TaskSpec
from onto_compiler.problems import Problem, near

__all__ = ["lint"]


def lint(spec: TaskSpec) -> tuple[Problem, ...]:
    """Warnings on ``spec`` in file order."""
    return tuple(
        sorted([*_domain(spec), *_targets(spec), *_split(spec.fixtures), *_split(spec.objects), *_interest(spec)])
    )


def _domain(spec: TaskSpec) -> Iterator[Problem]:
    if spec.domain != "robosuite":
        message = f"the domain is `{spec.domain}`; LIBERO plays `robosuite` alone"
        yield Problem.at(spec.domain_span, codes.FOREIGN_DOMAIN, message, "write (:domain robosuite)", "warning")


def _targets(spec: TaskSpec) -> Iterator[Problem]:
    """Regions of something that is not there; one finding for each such target."""
    declared = {each.name for each in spec.declarations}
    seen: set[str] = set()
    for region in spec.regions:
        target = region.target
        if target.name in declared or target.name in seen:
            continue
        seen.add(target.name)
        message = f"region `{region.name}` is part of `{target.name}`, which is not declared"
        hint = near(target.name, declared) or f"declare `{target.name}` or remove the region"
        yield Problem.at(target.span, codes.UNDECLARED_TARGET, message, hint, "warning")


def _split(declarations: Sequence[Declaration]) -> Iterator[Problem]:
    """A category that comes back: LIBERO's reader keeps only the last list of a category."""
    seen: set[str] = set()
    for category, group in groupby(declarations, key=lambda each: each.category):
        if category in seen:
            message = f"the names of category `{category}` stand in two lists; LIBERO keeps only the last"
            hint = f"write them as one list before `- {category}`"
            yield Problem.at(next(group).span, codes.SPLIT_CATEGORY, message, hint, "warning")
        seen.add(category)


def _interest(spec: TaskSpec) -> Iterator[Problem]:
    """Names of interest that nothing bears."""
    known = {each.name for each in spec.declarations} | {region.site for region in spec.regions}
    for symbol in spec.interest:
        if symbol.name not in known:
            message = f"`{symbol.name}` is not an object, fixture or region of this task"
            yield Problem.at(symbol.span, codes.UNKNOWN_NAME, message, near(symbol.name, known), "warning")
