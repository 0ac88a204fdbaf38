"""Whether an exception comes from our code or from a package that registered a proposer, a skill or a function."""

from __future__ import annotations

import traceback
from importlib.metadata import EntryPoint

from onto_compiler.problems import OntoError, Problem
from onto_compiler.registered import package, points

__all__ = ["foreign_problem"]

_KINDS = {
    "onto_evwm.groundings": "grounding function",
    "onto_evwm.proposers": "proposer",
    "onto_evwm.skills": "skill",
    "onto_evwm.mechanisms": "mechanism",
    "onto_evwm.encoders": "encoder",
    "onto_evwm.protocols": "protocol",
    "onto_evwm.worlds": "world",
    "onto_evwm.commands": "command",
}
_OURS = {"benchmarks", "grounding", "onto_compiler", "ontology", "runtime"}


def foreign_problem(error: Exception) -> OntoError | None:
    """``error`` as a problem at the line of the registered code that raised it; None if it arose in our own code."""
    registered = [
        (point, kind) for group, kind in _KINDS.items() for point in points(group) if _top(point.module) not in _OURS
    ]
    if not registered:
        return None
    frames = [
        (str(frame.f_globals.get("__name__", "")), line, frame)
        for frame, line in traceback.walk_tb(error.__traceback__)
    ]
    for module, line, frame in reversed(frames):
        found = _registered(module, [name for name, _, _ in frames], registered)
        if found is not None:
            point, kind = found
            text = " ".join(str(error).split())
            raised = f"{type(error).__name__}{f': {text}' if text else ''}"
            where = f"the {kind} `{point.name}` (`{point.value}`, package `{package(point)}`)"
            message = f"{where} raised {raised}"
            hint = "correct it there, or tell the authors of the package; ONTO_DEBUG=1 shows the whole traceback"
            return OntoError(Problem(frame.f_code.co_filename, line, 1, "RUN007", "error", message, hint))
    return None


def _registered(
    module: str, all_modules: list[str], registered: list[tuple[EntryPoint, str]]
) -> tuple[EntryPoint, str] | None:
    """The entry point that ``module`` belongs to: the one whose own module is in the traceback before any other."""
    own = [(point, kind) for point, kind in registered if _top(point.module) == _top(module)]
    exact = [(point, kind) for point, kind in own if point.module in {module, *all_modules}]
    return next(iter(exact or own), None)


def _top(module: str) -> str:
    return module.partition(".")[0]
