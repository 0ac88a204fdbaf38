"""The versions of installed packages and of this checkout, which are published with results."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

__all__ = ["git", "version_of"]


def version_of(package: str) -> str | None:
    """The version of the installed distribution ``package``, or None."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def git(folder: Path, *arguments: str) -> str:
    """What git answers in the checkout that ``folder`` belongs to, or nothing outside one."""
    import subprocess  # noqa: PLC0415 - every command imports this module, and few ask git

    command = ["git", "-C", str(folder), *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603 - fixed arguments
    except OSError:
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
