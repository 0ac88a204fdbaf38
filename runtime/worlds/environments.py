"""The worlds' Gymnasium ids: registered once Gymnasium is imported, which this module never does itself.

``gymnasium.make("onto_evwm:ID")`` imports ``onto_evwm`` to have ``ID`` registered; where that module had been imported
before Gymnasium was, importing it again does nothing. So registering waits for Gymnasium.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import ModuleType

__all__ = ["register", "register_worlds"]

_WORLDS = ("runtime.worlds.libero.gym", "runtime.worlds.pointmaze.gym")
_entry_points: dict[str, str] = {}  # of ids that wait for Gymnasium


def register(name: str, entry_point: str) -> None:
    """Have ``gymnasium.make(name)`` make an instance of the class at ``entry_point``: now, or from its import on."""
    _entry_points[name] = entry_point
    if "gymnasium" in sys.modules:
        _register_waiting()
    elif not any(isinstance(finder, _AfterGymnasium) for finder in sys.meta_path):
        sys.meta_path.insert(0, _AfterGymnasium())


def register_worlds() -> None:
    """Register what every world of this project registers."""
    for package in _WORLDS:
        import_module(package)


def _register_waiting() -> None:
    gymnasium = sys.modules["gymnasium"]
    while _entry_points:
        name, entry_point = _entry_points.popitem()
        # The environments truncate themselves and need no wrapper: a horizon differs by task.
        gymnasium.register(name, entry_point=entry_point)


class _AfterGymnasium:
    """Finds no module itself: it has Gymnasium found by the others, and registers when that has been loaded."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The spec of Gymnasium, whose loading ends with registering; None for every other module."""
        if fullname != "gymnasium":
            return None
        sys.meta_path.remove(self)
        found = (finder.find_spec(fullname, path, target) for finder in sys.meta_path)
        spec = next((one for one in found if one is not None), None)
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def execute_and_register(module: ModuleType) -> None:
                execute(module)
                _register_waiting()

            spec.loader.exec_module = execute_and_register  # type: ignore[method-assign]
        return spec
