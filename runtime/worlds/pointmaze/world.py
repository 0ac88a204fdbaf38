"""PointMaze as a :class:`~runtime.worlds.world.World`; light until a task is opened."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from runtime.worlds.single_suite import SingleSuite

if TYPE_CHECKING:
    from onto_compiler.required import RequiredABox
    from onto_compiler.schema import Schema
    from runtime.loop.proposer import Proposer
    from runtime.worlds.environment import TaskEnvironment
    from runtime.worlds.world import TaskRef

__all__ = ["SUITE", "WORLD", "PointMaze"]

SUITE = "pointmaze"


class PointMaze(SingleSuite):
    """DINO-WM's maze. Its failures are corrected in plans (``onto plan``)."""

    name = SUITE
    title = "PointMaze"
    level = "plan"
    domains: Sequence[str] = ("pointmaze",)
    folder = Path(__file__).parent / "tasks"
    task_names = ("u_maze",)

    def initial_states(self, ref: TaskRef) -> int:  # noqa: ARG002  all tasks have as many
        """The number of published trials."""
        from runtime.worlds.pointmaze.trials import PUBLISHED  # noqa: PLC0415 - heavy imports wait

        return PUBLISHED

    def horizon(self, ref: TaskRef) -> int:  # noqa: ARG002  as above
        """Environment steps of an episode."""
        from runtime.worlds.pointmaze.environment import HORIZON  # noqa: PLC0415 - as above

        return HORIZON

    def open(self, ref: TaskRef, required: RequiredABox, schema: Schema, seed: int) -> TaskEnvironment:
        """The maze of ``ref``; raises ``SIM001`` ff. if a fact names an object that the maze lacks."""
        from runtime.worlds.pointmaze.opened import OpenMaze  # noqa: PLC0415 - as above

        return OpenMaze(ref, required, schema, seed)

    def proposers(
        self,
        schema: Schema,  # noqa: ARG002  there is none to choose
        chosen: Mapping[str, str] | None = None,  # noqa: ARG002  as above
    ) -> Mapping[str, Proposer]:
        """No proposers: the mechanisms of :mod:`runtime.planning` correct plans."""
        return {}


WORLD = PointMaze()
