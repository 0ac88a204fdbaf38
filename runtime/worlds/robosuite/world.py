"""robosuite as a :class:`~runtime.worlds.world.World`; light until a task is opened."""

from __future__ import annotations

import importlib.util
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

__all__ = ["SUITE", "WORLD", "Robosuite"]

SUITE = "robosuite"
_FOLDER = Path(__file__).parent / "tasks"
_TASKS = ("Lift", "Stack", "PickPlaceCan", "Door")
_HORIZON = 500  # of robosuite's benchmark


class Robosuite:
    """Four of robosuite's own tasks, each by the name of its environment."""

    name = "robosuite"
    title = "robosuite"
    level = "state"
    domains: Sequence[str] = ("robosuite_suite",)

    def suites(self) -> Sequence[str]:
        """One suite; raises ``SIM010`` where robosuite is not installed."""
        if importlib.util.find_spec("robosuite") is None:
            raise OntoError.of("SIM010", "robosuite is not installed", 'pip install "onto-evwm[sim]"')
        return (SUITE,)

    def tasks(self, suite: str) -> Sequence[TaskRef]:
        """The tasks of the suite; raises ``SIM011`` for another."""
        if suite != SUITE:
            raise OntoError.of("SIM011", f"robosuite has no suite `{suite}`", near(suite, (SUITE,)))
        return tuple(TaskRef(SUITE, index, name, _FOLDER / f"{name}.bddl") for index, name in enumerate(_TASKS))

    def initial_states(self, ref: TaskRef) -> int:  # noqa: ARG002  all tasks have as many
        """How many resets are drawn from the seed."""
        from runtime.worlds.robosuite.native import INITIAL_STATES  # noqa: PLC0415 - heavy imports wait

        return INITIAL_STATES

    def horizon(self, ref: TaskRef) -> int:  # noqa: ARG002  as above
        """Control steps of an episode, as robosuite's benchmark has them."""
        return _HORIZON

    def prepare(self, ref: TaskRef, imports: Sequence[str]) -> None:
        """Nothing: this world has no objects of one's own."""

    def open(self, ref: TaskRef, required: RequiredABox, schema: Schema, seed: int) -> TaskEnvironment:
        """Robosuite's own environment of ``ref``; raises ``SIM`` problems."""
        from runtime.worlds.robosuite.environment import RobosuiteEnvironment  # noqa: PLC0415 - as above

        return RobosuiteEnvironment(ref, required, schema, seed)

    def proposers(self, schema: Schema, chosen: Mapping[str, str] | None = None) -> Mapping[str, Proposer]:
        """Those that are registered for the routes of ``schema``; raises as ``load_proposers``."""
        from runtime.loop.registry import load_proposers  # noqa: PLC0415 - as above

        return load_proposers(schema, chosen)

    def skills(self, schema: Schema) -> Mapping[str, Any]:  # noqa: ARG002  there is none to choose
        """None: no skill plays these tasks."""
        return {}


WORLD = Robosuite()
