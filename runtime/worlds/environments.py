"""The worlds' Gymnasium ids: registered once Gymnasium is imported, which this module never does itself.

``gymnasium.make("onto_evwm:ID")`` imports ``onto_evwm`` to have ``ID`` registered; where that module had been imported
before Gymnasium was, importing it again does nothing. So registering waits for Gymnasium. A module that registers ids
when it is imported is an entry point of the group ``onto_evwm.environments``.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType

__all__ = ["GROUP", "register", "register_worlds"]

GROUP = "onto_evwm.environments"

_waiting: list[Callable[[], None]] = []


def register(name: str, entry_point: str) -> None:
    """Register the class at ``entry_point`` as ``name`` with Gymnasium: now, or when Gymnasium is imported."""
    # The environments truncate themselves and need no wrapper: a horizon differs by task.
    _once_imported(lambda: sys.modules["gymnasium"].register(name, entry_point=entry_point))


def register_worlds() -> None:
    """Register the environments of all installed worlds: now, or when Gymnasium is imported."""
    _once_imported(_load_worlds)


def _load_worlds() -> None:
    from importlib.metadata import entry_points  # noqa: PLC0415 - costs more than the rest of `import onto_evwm`

    for point in entry_points(group=GROUP):
        point.load()


def _once_imported(action: Callable[[], None]) -> None:
    if "gymnasium" in sys.modules:
        action()
        return
    _waiting.append(action)
    if not any(isinstance(finder, _AfterGymnasium) for finder in sys.meta_path):
        sys.meta_path.insert(0, _AfterGymnasium())


class _AfterGymnasium:
    """A finder that lets the other finders import Gymnasium, and registers the waiting environments after that."""

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
                while _waiting:
                    _waiting.pop(0)()

            spec.loader.exec_module = execute_and_register  # type: ignore[method-assign]
        return spec
