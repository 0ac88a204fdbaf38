"""Environments that differ from this one in the version of one package: a small environment in front of this one."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import sysconfig
from pathlib import Path

from onto_compiler.problems import OntoError

__all__ = ["overlay"]

_MARK = ".complete"
_PROJECT = Path(__file__).resolve().parents[1]


def overlay(package: str, version: str, folder: Path) -> Path:
    """The interpreter of an environment below ``folder`` that has ``package`` at ``version``, and all else of ours.

    It is made where it is not there yet. Raises ``BEN004`` where pip cannot install that version.
    """
    ours = (str(_PROJECT), sysconfig.get_path("purelib"))
    place = folder / f"{package}-{version}-{hashlib.sha256(repr(ours).encode()).hexdigest()[:8]}"
    python = place / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if (place / _MARK).exists():
        return python
    wanted = (
        f"{package}=={version}",
        *((f"mujoco-core=={version}",) if package == "mujoco" and _split(version) else ()),
    )
    place.mkdir(parents=True, exist_ok=True)
    for command in (
        [sys.executable, "-m", "venv", "--clear", str(place)],
        [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", *wanted],
    ):
        done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603 - fixed arguments
        if done.returncode != 0:
            last = done.stderr.strip().splitlines()[-1:]
            raise OntoError.of(
                "BEN004", f"cannot install {package} {version}: {''.join(last)}", "look at `pip install`"
            )
    asked = [str(python), "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"]
    theirs = subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip()  # noqa: S603 - as above
    # Their own packages come first. A .pth file adds what runs now behind them, and then ours with what ours add.
    lines = f"{ours[0]}\nimport site; site.addsitedir({ours[1]!r})\n"
    (Path(theirs) / "onto_evwm_overlay.pth").write_text(lines, encoding="utf-8")
    (place / _MARK).touch()
    return python


def _split(version: str) -> bool:
    """Whether this version of MuJoCo comes in two distributions."""
    return int(version.partition(".")[0]) >= 4
