"""What a notebook needs of Onto-EV-WM, under the name of the distribution; see docs/notebook.md.

Each name is imported from where it is defined when it is first used. Importing this module also lets Gymnasium know the
worlds, so that ``gymnasium.make("onto_evwm:onto/Libero-v0", task="libero_goal/8")`` works. The program ``onto`` starts
here, too: where another package has the name of one of ours, this module is the one that can still say so.
"""

import sys
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

__all__ = [
    "Knowledge",
    "OntoError",
    "check",
    "compile_task",
    "diagnose",
    "ground",
    "main",
    "narrate",
    "open_trace",
    "repair",
]

_HOMES = {
    "Knowledge": "onto_compiler.knowledge",
    "OntoError": "onto_compiler.problems",
    "check": "onto_compiler.check.run",
    "compile_task": "onto_compiler.bddl.compile",
    "diagnose": "runtime.commands.tasks",
    "ground": "runtime.commands.tasks",
    "narrate": "runtime.trace.narrate",
    "open_trace": "runtime.trace.store",
    "repair": "runtime.commands.tasks",
}
_PACKAGES = ("ontology", "onto_compiler", "grounding", "runtime", "benchmarks")


def main() -> int:
    """Run the program ``onto``; its exit code."""
    if _HIDDEN:
        sys.stderr.write(f"error[CLI008]: {_HIDDEN}\n")
        return 2
    code: int = import_module("runtime.cli").main()
    return code


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if _HIDDEN:
        raise ImportError(f"CLI008: {_HIDDEN}")
    value = globals()[name] = getattr(import_module(_HOMES[name]), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def _hidden() -> str:
    """What hides a package of ours, in a sentence; nothing where all are found beside this module."""
    here = Path(__file__).resolve().parent
    for name in _PACKAGES:
        spec = find_spec(name)
        if spec is None:
            return f"the package `{name}` of onto-evwm is missing beside `{here}`: install onto-evwm again"
        place = Path(next(iter(spec.submodule_search_locations or ()), spec.origin or "")).resolve()
        if place != here / name:
            remedy = "rename it, or take its folder off Python's search path (PYTHONPATH, or where Python was started)"
            return f"`{place}` hides the package `{name}` of onto-evwm: {remedy}"
    return ""


_HIDDEN = _hidden()
if not _HIDDEN:
    import_module("runtime.worlds.environments").register_worlds()

if __name__ == "__main__":
    sys.exit(main())
