"""LIBERO as a :class:`~runtime.worlds.world.World`; light until a task is opened."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from runtime.worlds.libero.simulator import assets
from runtime.worlds.world import ANY_DOMAIN, TaskRef

if TYPE_CHECKING:
    from onto_compiler.required import RequiredABox
    from onto_compiler.schema import Schema
    from runtime.loop.proposer import Proposer
    from runtime.worlds.environment import TaskEnvironment

__all__ = ["WORLD", "Libero"]


class Libero:
    """LIBERO's suites and those of the packages that extend it."""

    name = "libero"
    title = "LIBERO"
    level = "state"
    domains: Sequence[str] = ("robosuite", ANY_DOMAIN)

    def suites(self) -> Sequence[str]:
        """The suites whose task files are installed; raises ``SIM010``."""
        return assets.suites()

    def tasks(self, suite: str) -> Sequence[TaskRef]:
        """The tasks of ``suite`` in the official order; raises ``SIM010``, ``SIM011``."""
        return assets.tasks(suite)

    def initial_states(self, ref: TaskRef) -> int:
        """The number of official initial states; 1, the seeded reset, where there are none. Raises ``SIM014``."""
        return len(assets.initial_states(ref)) if ref.initial_states.is_file() else 1

    def horizon(self, ref: TaskRef) -> int:
        """Control steps of an episode, as the field's evaluations have them."""
        from runtime.worlds.libero.scene.horizons import horizon_of  # noqa: PLC0415 - heavy imports wait

        return horizon_of(ref.suite)

    def prepare(self, ref: TaskRef, imports: Sequence[str]) -> None:
        """Import ``imports`` and what the project lists; raises ``SIM024``."""
        from runtime.worlds.libero.simulator.own_code import import_own  # noqa: PLC0415 - heavy imports wait

        import_own(imports, ref.bddl.parent)

    def open(self, ref: TaskRef, required: RequiredABox, schema: Schema, seed: int) -> TaskEnvironment:
        """LIBERO's own environment of ``ref``; raises ``SIM`` problems."""
        from runtime.worlds.libero.loop.environment import LiberoEnvironment  # noqa: PLC0415 - as above

        return LiberoEnvironment(ref, required, schema, seed)

    def proposers(self, schema: Schema, chosen: Mapping[str, str] | None = None) -> Mapping[str, Proposer]:
        """Those that are registered for the routes of ``schema``; raises as ``load_proposers``."""
        from runtime.loop.registry import load_proposers  # noqa: PLC0415 - as above

        return load_proposers(schema, chosen)

    def skills(self, schema: Schema) -> Mapping[str, Any]:
        """Those that are registered for the routes of ``schema``; raises ``RUN011``."""
        from runtime.worlds.libero.skills.registry import load_skills  # noqa: PLC0415 - as above

        return load_skills(schema)


WORLD = Libero()
