"""robosuite as a :class:`~runtime.worlds.world.World`; light until a task is opened."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from onto_compiler.problems import OntoError
from runtime.worlds.single_suite import SingleSuite

if TYPE_CHECKING:
    from onto_compiler.required import RequiredABox
    from onto_compiler.schema import Schema
    from runtime.loop.proposer import Proposer
    from runtime.worlds.environment import TaskEnvironment
    from runtime.worlds.world import TaskRef

__all__ = ["SUITE", "WORLD", "Robosuite"]

SUITE = "robosuite"
_HORIZON = 500


class Robosuite(SingleSuite):
    """Four of robosuite's own tasks, named as their environments."""

    name = SUITE
    title = "robosuite"
    level = "state"
    domains: Sequence[str] = ("robosuite_suite",)
    folder = Path(__file__).parent / "tasks"
    task_names = ("Lift", "Stack", "PickPlaceCan", "Door")

    def suites(self) -> Sequence[str]:
        """One suite; raises ``SIM010`` if robosuite is not installed."""
        if importlib.util.find_spec("robosuite") is None:
            raise OntoError.of("SIM010", "robosuite is not installed", 'pip install "onto-evwm[sim]"')
        return super().suites()

    def initial_states(self, ref: TaskRef) -> int:  # noqa: ARG002  all tasks have as many
        """The number of resets that are drawn from the seed."""
        from runtime.worlds.robosuite.native import INITIAL_STATES  # noqa: PLC0415 - heavy imports wait

        return INITIAL_STATES

    def horizon(self, ref: TaskRef) -> int:  # noqa: ARG002  as above
        """Control steps of an episode, as in robosuite's benchmark."""
        return _HORIZON

    def open(self, ref: TaskRef, required: RequiredABox, schema: Schema, seed: int) -> TaskEnvironment:
        """Robosuite's own environment of ``ref``; raises ``SIM`` problems."""
        from runtime.worlds.robosuite.environment import RobosuiteEnvironment  # noqa: PLC0415 - as above

        return RobosuiteEnvironment(ref, required, schema, seed)

    def proposers(self, schema: Schema, chosen: Mapping[str, str] | None = None) -> Mapping[str, Proposer]:
        """The proposers that are registered for the routes of ``schema``; raises as ``load_proposers``."""
        from runtime.loop.registry import load_proposers  # noqa: PLC0415 - as above

        return load_proposers(schema, chosen)


WORLD = Robosuite()
