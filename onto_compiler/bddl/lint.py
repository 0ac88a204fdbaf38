"""Finds what is legal in a task file but likely a mistake. Findings are warnings; harmless ones are information."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import PurePath

from onto_compiler.bddl import codes
from onto_compiler.bddl.ast import Declaration, TaskSpec
from onto_compiler.bddl.dialects import DIALECTS, LIBERO, dialect_of
from onto_compiler.bddl.lint_goal import lint_goal
from onto_compiler.bddl.literals import GoalLiterals
from onto_compiler.problems import Problem, near

__all__ = ["lint"]

# A language model introduced its list of paraphrases, and the introduction became a task's instruction.
PREAMBLE = re.compile(
    r"\b(?:here (?:are|is)|below (?:are|is)|the following|these are)\b.*"
    r"\b(?:variations?|versions?|paraphrases?|rephrasings?|rewordings?|instructions?|sentences)\b"
    r"|\b\d+ (?:variations?|versions?|paraphrases?|rephrasings?|rewordings?)\b"
    r"|\bas an ai\b|\boriginal instruction\b",
    re.IGNORECASE,
)
FILE_WORD = re.compile(r"\.bddl\b|\b\w+_\w*\d\w*\b|\b[A-Z]+(?:_[A-Z]+)+\d*\b|_")


def lint(spec: TaskSpec, goal: GoalLiterals | None = None) -> tuple[Problem, ...]:
    """Warnings on ``spec`` in file order; ``goal`` is what its goal came to, or None if it came to nothing."""
    found = [
        *_domain(spec),
        *_language(spec),
        *_targets(spec),
        *_split(spec.fixtures),
        *_split(spec.objects),
        *_placed(spec),
        *_rotated(spec),
        *_interest(spec),
        *spec.passed_over,
    ]
    if goal is not None:
        found += lint_goal(spec, goal)
    return tuple(sorted(set(found)))


def _domain(spec: TaskSpec) -> Iterator[Problem]:
    if all(spec.domain not in dialect.domains for dialect in DIALECTS):
        message = f"the domain is `{spec.domain}`; LIBERO plays `robosuite` alone"
        yield Problem.at(spec.domain_span, codes.FOREIGN_DOMAIN, message, "write (:domain robosuite)", "warning")


def _language(spec: TaskSpec) -> Iterator[Problem]:
    """An instruction that is not one: what came before it in a model's answer, or the name of a file."""
    hint = "write what a person would ask of the robot, and nothing else"
    if match := PREAMBLE.search(spec.language):
        message = f"the instruction announces instructions: `{match.group()}`"
        yield Problem.at(spec.language_span, codes.STRANGE_LANGUAGE, message, hint, "warning")
    elif (piece := FILE_WORD.search(spec.language)) is not None or (piece := _suffix(spec)) is not None:
        message = f"the instruction holds a piece of a file's name: `{piece.group()}`"
        yield Problem.at(spec.language_span, codes.STRANGE_LANGUAGE, message, hint, "warning")


def _suffix(spec: TaskSpec) -> re.Match[str] | None:
    """The end of the instruction where it is a numbered end of the file's name too, as ``view 0 0 100``."""
    stem = PurePath(spec.file).name.removesuffix(".bddl").replace("_", " ").lower()
    match = re.search(r"(?:\b[a-z]+ )?\d+(?: \d+)*$", spec.language.lower())
    return match if match is not None and stem.endswith(match.group()) else None


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
        # LIBERO's own files hold such regions; an atom that uses one is an error of its own.
        yield Problem.at(target.span, codes.UNDECLARED_TARGET, message, hint, "info")


def _split(declarations: Sequence[Declaration]) -> Iterator[Problem]:
    """A category that comes back: the readers of LIBERO and BEHAVIOR keep only the last list of a category."""
    seen: set[str] = set()
    for category, group in groupby(declarations, key=lambda each: each.category):
        if category in seen:
            message = f"the names of category `{category}` are in two lists; readers use only the last"
            hint = f"write them as one list before `- {category}`"
            yield Problem.at(next(group).span, codes.SPLIT_CATEGORY, message, hint, "warning")
        seen.add(category)


def _placed(spec: TaskSpec) -> Iterator[Problem]:
    """Objects that no initial fact mentions: their position is unknown."""
    places = dialect_of(spec.domain).places
    located = {
        symbol.name
        for atom in (*spec.init, *(() if places else spec.absent))
        if not places or atom.predicate.lower() in places
        for symbol in (atom.arguments[:1] if places else atom.arguments)
    }
    for each in spec.objects:
        if each.name not in located:
            message = f"`{each.name}` is declared, and `:init` does not place it"
            hint = f"say where it is, as in `(On {each.name} ...)`, or remove it" if places else "say where it is"
            yield Problem.at(each.span, codes.NEVER_PLACED, message, hint, "warning")


def _rotated(spec: TaskSpec) -> Iterator[Problem]:
    """Rotations of regions that LIBERO does not read: it turns fixtures by their region, and objects by their class.

    Source: ``_add_placement_initializer`` of LIBERO's ``bddl_base_domain.py``.
    """
    if dialect_of(spec.domain) is not LIBERO:
        return
    objects = {each.name for each in spec.objects}
    starts: dict[str, list[str]] = {}
    for atom in spec.init:
        if atom.predicate.lower() in LIBERO.places and len(atom.arguments) == 2:
            starts.setdefault(atom.arguments[1].name, []).append(atom.arguments[0].name)
    for region in spec.regions:
        here = starts.get(region.site, [])
        turned = [name for name in here if name not in objects]
        if region.yaw in {None, (0.0, 0.0)} or turned:  # LIBERO's generator writes (0 0) for no rotation
            continue
        who = f"`{here[0]}`, an object, starts there, and LIBERO turns it as its class says" if here else ""
        message = f"LIBERO does not read the `:yaw_rotation` of `{region.site}`: {who or 'no fixture starts there'}"
        hint = "remove it: only a fixture that `:init` puts on the region is turned by it"
        yield Problem.at(region.yaw_span, codes.IGNORED_ROTATION, message, hint, "warning" if here else "info")


def _interest(spec: TaskSpec) -> Iterator[Problem]:
    """Names of interest that nothing bears."""
    known = {each.name for each in spec.declarations} | {region.site for region in spec.regions}
    for symbol in spec.interest:
        if symbol.name not in known:
            message = f"`{symbol.name}` is not an object, fixture or region of this task"
            yield Problem.at(symbol.span, codes.UNKNOWN_NAME, message, near(symbol.name, known), "warning")
