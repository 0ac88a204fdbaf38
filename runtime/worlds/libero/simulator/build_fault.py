"""Why LIBERO cannot build a task, derived from its generic exceptions."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import numpy as np

from onto_compiler.bddl.ast import Atom, TaskSpec
from onto_compiler.bddl.dialects import LIBERO, dialect_of
from onto_compiler.bddl.parse import parse_file
from onto_compiler.problems import OntoError, Problem, Span, near
from runtime.worlds.libero.simulator.missing_asset import advice, missing_asset
from runtime.worlds.libero.simulator.native_import import randomization_error
from runtime.worlds.libero.simulator.own_code import place_of

__all__ = ["build_fault"]

_DOUBT = "look at the task file with `onto compile`; where that is sound, an asset may be damaged"


def build_fault(error: Exception, bddl: Path) -> OntoError:
    """The problem that ``error``, raised while LIBERO built ``bddl``, tells of: ``SIM016`` or ``SIM020``."""
    own = place_of(error)
    if (asset := missing_asset(error)) is not None:
        where = f"correct the path in {own[0]}:{own[1]}, or put the file there" if own is not None else advice(asset)
        return OntoError.of("SIM020", f"LIBERO's asset file `{asset}` is missing", where, str(bddl))
    try:
        spec = parse_file(bddl)
    except OntoError:
        spec = None
    if spec is not None:
        dialect = dialect_of(spec.domain)
        if dialect is not LIBERO:
            return _plain(error, bddl, f"it is a task of {dialect.name}, which LIBERO does not play")
        found = _no_category(error, spec) or _no_room(error, spec)
        if found is not None:
            span, message, hint = found
            return OntoError(Problem(str(bddl), span.line, span.column, "SIM016", "error", message, hint))
    if own is not None:
        file, line, column = own
        message = f"LIBERO cannot build `{bddl.name}` with this code: {type(error).__name__}: {error}"
        return OntoError(Problem(file, line, column, "SIM016", "error", message, "correct it there"))
    return _plain(error, bddl, _DOUBT)


def _plain(error: Exception, bddl: Path, hint: str) -> OntoError:
    return OntoError.of("SIM016", f"LIBERO cannot build this task: {type(error).__name__} {error}", hint, str(bddl))


def _no_category(error: Exception, spec: TaskSpec) -> tuple[Span, str, str] | None:
    """A declared category that nothing has registered with LIBERO."""
    known = importlib.import_module("libero.libero.envs.objects").get_object_dict()
    if not isinstance(error, KeyError) or not error.args or error.args[0] in known:
        return None
    declared = next((each for each in spec.declarations if each.category == error.args[0]), None)
    if declared is None:
        return None
    own = "a category of your own is registered by a module that `--import MODULE` names"
    guess = near(declared.category, known)
    hint = f"{guess} Otherwise {own}" if guess else own
    return declared.span, f"LIBERO has no category `{declared.category}`, of which `{declared.name}` is to be", hint


def _no_room(error: Exception, spec: TaskSpec) -> tuple[Span, str, str] | None:
    """An object for which robosuite's sampler found no room, and the objects in its way."""
    if not isinstance(error, randomization_error()):
        return None
    local = _sampler(error)
    subject = getattr(local.get("obj"), "name", None)
    placing = next((atom for atom in spec.init if len(atom.arguments) > 1 and atom.arguments[0].name == subject), None)
    if placing is None:
        return None
    where = placing.arguments[1].name
    others = _in_the_way(placing, spec, local)
    many = f"{_count(1 + len(others))} objects have" if others else "one object has"
    names = " and ".join(f"`{name}`" for name in (subject, *others))
    hint = "make the region larger, or put one of them elsewhere: LIBERO keeps the circles around objects apart"
    return placing.span, f"{many} no room in region `{where}`: {names}", hint


def _count(number: int) -> str:
    return ("", "one", "two", "three", "four", "five")[number] if number < 6 else str(number)


def _sampler(error: Exception) -> dict[str, Any]:
    """The local variables of the sampler that gave up, since robosuite's message names no object."""
    trace, local = error.__traceback__, {}
    while trace is not None:
        local, trace = trace.tb_frame.f_locals, trace.tb_next
    return dict(local)


def _in_the_way(placing: Atom, spec: TaskSpec, local: dict[str, Any]) -> list[str]:
    """What is placed already and reaches into the region: objects of the same region first, then its neighbours."""
    subject, where = (argument.name for argument in placing.arguments[:2])
    placed = local.get("placed_objects", {})
    same = [a.arguments[0].name for a in spec.init if len(a.arguments) > 1 and a.arguments[1].name == where]
    inside = [name for name in same if name != subject and name in placed]
    region = next((region for region in spec.regions if region.site == where and region.ranges), None)
    if inside or region is None:
        return inside
    base = np.asarray(local.get("base_offset", np.zeros(3)))[:2]
    radius = float(local.get("horizontal_radius", 0.0))
    near_by = []
    for name, (position, _, other) in placed.items():
        for x0, y0, x1, y1 in region.ranges:
            centre, half = np.add(base, [(x0 + x1) / 2, (y0 + y1) / 2]), np.hypot(x1 - x0, y1 - y0) / 2
            if np.linalg.norm(np.asarray(position)[:2] - centre) <= half + radius + other.horizontal_radius:
                near_by.append(name)
                break
    return near_by
