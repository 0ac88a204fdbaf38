"""The versions of installed packages, which decide results and stand beside them."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

__all__ = ["version_of"]


def version_of(package: str) -> str | None:
    """The version of the installed distribution ``package``, or None."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None
