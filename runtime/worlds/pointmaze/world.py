"""PointMaze as a :class:`~runtime.worlds.world.World`; light until a task is opened."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from onto_compiler.problems import OntoError, near
from runtime.worlds.world import TaskRef

if TYPE_CHECKING:
    from onto_compiler.required import RequiredABox
    from onto_compiler.schema import Schema
    from runtime.loop.proposer import Proposer
    from runtime.worlds.environment import TaskEnvironment

__all__ = ["SUITE", "WORLD", "PointMaze"]

SUITE = "pointmaze"
_FOLDER = Path(__file__).parent / "tasks"
_TASKS = ("u_maze",)


class PointMaze:
    """DINO-WM's maze, whose failures are corrected in plans: ``onto plan`` does."""

    name = "pointmaze"
    title = "PointMaze"
    level = "plan"
    domains: Sequence[str] = ("pointmaze",)

    def suites(self) -> Sequence[str]:
        """One suite."""
        return (SUITE,)

    def tasks(self, suite: str) -> Sequence[TaskRef]:
        """The tasks of the suite; raises ``SIM011`` for another."""
        if suite != SUITE:
            raise OntoError.of("SIM011", f"PointMaze has no suite `{suite}`", near(suite, (SUITE,)))
        return tuple(TaskRef(SUITE, index, name, _FOLDER / f"{name}.bddl") for index, name in enumerate(_TASKS))

    def initial_states(self, ref: TaskRef) -> int:  # noqa: ARG002  all tasks have as many
        """The published trials."""
        from runtime.worlds.pointmaze.trials import PUBLISHED  # noqa: PLC0415 - heavy imports wait

        return PUBLISHED

    def horizon(self, ref: TaskRef) -> int:  # noqa: ARG002  as above
        """Environment steps of an episode."""
        from runtime.worlds.pointmaze.environment import HORIZON  # noqa: PLC0415 - as above

        return HORIZON

    def prepare(self, ref: TaskRef, imports: Sequence[str]) -> None:
        """Nothing: this world has no objects of one's own."""

    def open(self, ref: TaskRef, required: RequiredABox, schema: Schema, seed: int) -> TaskEnvironment:
        """The maze of ``ref``; raises ``SIM001`` ff. where a fact names what a maze lacks."""
        from runtime.worlds.pointmaze.opened import OpenMaze  # noqa: PLC0415 - as above

        return OpenMaze(ref, required, schema, seed)

    def proposers(
        self,
        schema: Schema,  # noqa: ARG002  there is none to choose
        chosen: Mapping[str, str] | None = None,  # noqa: ARG002  as above
    ) -> Mapping[str, Proposer]:
        """None: what corrects a plan is a mechanism of :mod:`runtime.planning`."""
        return {}

    def skills(self, schema: Schema) -> Mapping[str, Any]:  # noqa: ARG002  as above
        """None."""
        return {}


WORLD = PointMaze()
