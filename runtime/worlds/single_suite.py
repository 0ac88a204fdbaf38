"""What worlds share whose one suite is a folder of task files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from onto_compiler.problems import OntoError, near
from runtime.worlds.world import TaskRef

if TYPE_CHECKING:
    from onto_compiler.schema import Schema

__all__ = ["SingleSuite"]


class SingleSuite:
    """One suite, named as its world: ``task_names`` in their official order, each a BDDL file of ``folder``."""

    name: str
    title: str
    folder: ClassVar[Path]
    task_names: ClassVar[tuple[str, ...]]

    def suites(self) -> Sequence[str]:
        """The one suite."""
        return (self.name,)

    def tasks(self, suite: str) -> Sequence[TaskRef]:
        """The tasks of the suite; raises ``SIM011`` for another suite."""
        if suite != self.name:
            raise OntoError.of("SIM011", f"{self.title} has no suite `{suite}`", near(suite, (self.name,)))
        return tuple(TaskRef(suite, i, name, self.folder / f"{name}.bddl") for i, name in enumerate(self.task_names))

    def prepare(self, ref: TaskRef, imports: Sequence[str]) -> None:
        """Do nothing: these tasks need no modules of the user's own."""

    def skills(self, schema: Schema) -> Mapping[str, Any]:  # noqa: ARG002 - there is none to choose
        """No skills."""
        return {}
