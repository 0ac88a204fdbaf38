"""Packages beside this one, on the path of a process as an installer would leave them."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def environment_with(package: Path, folder: Path) -> dict[str, str]:
    """The environment of a process that has the package in ``package`` installed; ``folder`` gets its metadata."""
    project = tomllib.loads((package / "pyproject.toml").read_text())["project"]
    information = folder / f"{project['name']}-{project['version']}.dist-info"
    information.mkdir(parents=True)
    (information / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n"
    )
    sections = (
        f"[{group}]\n" + "".join(f"{name} = {value}\n" for name, value in entries.items())
        for group, entries in project["entry-points"].items()
    )
    (information / "entry_points.txt").write_text("\n".join(sections))
    return {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (folder, package, ROOT)))}


def run_with(environment: dict[str, str], *words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run Python with ``words`` in ``cwd``."""
    return subprocess.run(
        [sys.executable, *words], capture_output=True, text=True, check=False, cwd=cwd, env=environment
    )
