"""The core installation by itself: the wheel without extras in an environment of its own, and how large that is."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from venv import EnvBuilder

__all__ = ["core_env_mib", "core_environment"]

_ROOT = Path(__file__).resolve().parent.parent
_SOURCES = ("onto_evwm-stubs", "ontology", "onto_compiler", "grounding", "runtime", "benchmarks")
_FILES = ("onto_evwm.py", "pyproject.toml", "README.md", "LICENSE")


def core_env_mib() -> float:
    """MiB that the site-packages of a core environment take on disk, after `onto check` has passed in it.

    The environment holds this checkout's wheel, installed without extras, and what that depends on, as compiled by pip.
    It holds no pip and no setuptools: they are run from outside. Every file and folder counts with the blocks that it
    occupies, as ``du`` counts them.

    Raises:
        RuntimeError: where a step fails, with what it said.
    """
    with tempfile.TemporaryDirectory() as folder:
        python = core_environment(Path(folder))
        _run([str(python.parent / "onto"), "check"], cwd=Path(folder))
        (packages,) = python.parent.parent.glob("lib/python*/site-packages")
        return sum(path.lstat().st_blocks for path in packages.rglob("*")) * 512 / 2**20


def core_environment(folder: Path) -> Path:
    """Build the wheel below ``folder`` and install it there without extras; the path of the environment's Python.

    Raises:
        RuntimeError: where building or installing fails.
    """
    source, wheels, environment = folder / "source", folder / "wheels", folder / "environment"
    source.mkdir()
    for name in _SOURCES:
        # A copy: setuptools builds within its source, and takes up what an earlier build left there.
        shutil.copytree(_ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in _FILES:
        shutil.copy(_ROOT / name, source / name)
    EnvBuilder(with_pip=False).create(environment)
    python = environment / "bin" / "python"
    pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check"]
    _run([*pip, "wheel", "--no-deps", "--wheel-dir", str(wheels), str(source)], cwd=folder)
    (wheel,) = wheels.glob("*.whl")
    constraints = ["--constraint", str(_ROOT / "constraints.txt")]
    _run([*pip, "--python", str(python), "install", *constraints, str(wheel)], cwd=folder)
    return python


def _run(command: Sequence[str], cwd: Path) -> None:
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)  # noqa: S603 - our own words
    if done.returncode:
        output = (done.stderr or done.stdout).strip()
        raise RuntimeError(f"`{' '.join(command)}` ended with {done.returncode}: {output}")
