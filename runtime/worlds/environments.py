"""The Gymnasium ids of all worlds, registered once Gymnasium is imported and not before.

``gymnasium.make("onto_evwm:ID")`` imports ``onto_evwm`` to have ``ID`` registered; where that module had been imported
before Gymnasium was, importing it again does nothing. So registering waits for Gymnasium.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import ModuleType

__all__ = ["register"]

_PACKAGES = ("runtime.worlds.libero.gym", "runtime.worlds.pointmaze")  # each registers its id when it is imported


def register() -> None:
    """Register the ids of all worlds: now, or as soon as Gymnasium is imported."""
    if "gymnasium" in sys.modules:
        for package in _PACKAGES:
            import_module(package)
    elif not any(isinstance(finder, _Waiting) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Waiting())


class _Waiting:
    """Finds nothing itself: it has Gymnasium found by the others, and registers when Gymnasium has been loaded."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != "gymnasium":
            return None
        sys.meta_path.remove(self)
        found = (finder.find_spec(fullname, path, target) for finder in sys.meta_path)
        spec = next((one for one in found if one is not None), None)
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def execute_and_register(module: ModuleType) -> None:
                execute(module)
                register()

            spec.loader.exec_module = execute_and_register  # type: ignore[method-assign]
        return spec
