"""Ground required facts in a MuJoCo state: the observation whose truth equals the native predicates' (phi_sim)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.memory import contact_places
from grounding.observation import Observation, stack
from grounding.predicates.registry import ground
from grounding.predicates.terms import Grounding, Term
from grounding.scenes import Scene
from onto_compiler.problems import OntoError, Problem
from onto_compiler.required import Fact
from onto_compiler.schema import Schema

if TYPE_CHECKING:
    from grounding.compiled import CompiledTruth

__all__ = ["SimGrounder"]


class SimGrounder:
    """Grounds ``facts`` on ``scene``: every name is resolved at construction. It reads states and changes nothing."""

    def __init__(self, scene: Scene, facts: Sequence[Fact], schema: Schema) -> None:
        """Resolve every fact; raises one error with all that is wrong (``SIM001``, ``SIM002``, ``SIM005`` ...)."""
        self.scene = scene
        self.facts = tuple(facts)
        problems: list[Problem] = []
        resolved = []
        for fact in self.facts:
            try:
                resolved.append(ground(scene, fact, schema))
            except OntoError as error:
                problems += error.problems
        if problems:
            raise OntoError(*problems)
        self._groundings = tuple(resolved)
        self._known: mujoco.MjData | None = None

    def observe(self, data: mujoco.MjData, step: int = 0) -> Observation:
        """Ground every fact in ``data``, a forwarded state of the scene's model; entry i is for fact i.

        Raises ``SIM003`` when ``qpos`` is not finite, naming the joint, and ``SIM004`` when it is another scene's.
        """
        self._check(data)
        return stack("sim", step, [grounding(data) for grounding in self._groundings])

    def truth(self, data: mujoco.MjData) -> NDArray[np.bool_]:
        """The truth of every fact as :meth:`observe` gives it, without margins: some fifty times as fast.

        Raises ``SIM003`` or ``SIM004`` as :meth:`observe`.
        """
        return np.frombuffer(self.pattern(data), dtype=np.bool_)

    def pattern(self, data: mujoco.MjData) -> bytes:
        """:meth:`truth` as one byte a fact, 0 or 1: what a table can be asked with."""
        compiled = self._compiled
        if compiled is None:
            return self.observe(data).truth.tobytes()
        if data is not self._known:
            self._check(data)
            self._known = data
        left = compiled(data)
        if left:
            self._check(data)
            for fact in compiled.open:
                compiled.truth[fact] = self._groundings[fact](data).truth
        return compiled.truth.tobytes()

    @property
    def planned(self) -> tuple[bool, ...]:
        """Of each fact, whether its grounding function has a plan, and so a margin of the sign of its truth."""
        return tuple(isinstance(g, Grounding) and g.plan is not None for g in self._groundings)

    @cached_property
    def _compiled(self) -> CompiledTruth | None:
        """None if the installed MuJoCo keeps its memory in a way that is not known here."""
        try:
            contact_places()
        except OntoError:
            return None
        from grounding.compiled import CompiledTruth  # noqa: PLC0415  numba takes half a second to import

        return CompiledTruth(self.scene, [g.plan if isinstance(g, Grounding) else None for g in self._groundings])

    def terms(self, data: mujoco.MjData) -> tuple[tuple[Term, ...], ...]:
        """Every fact's conditions with their margins; empty for a grounding function that has no breakdown."""
        self._check(data)
        return tuple(tuple(g.terms(data)) if isinstance(g, Grounding) else () for g in self._groundings)

    def _check(self, data: mujoco.MjData) -> None:
        qpos = data.qpos
        if qpos.size != self.scene.model.nq:
            message = f"the state has {qpos.size} joint positions, the scene needs {self.scene.model.nq}"
            raise OntoError.of("SIM004", message, "ground a state with the scene of the same model")
        finite = np.isfinite(qpos)
        if not finite.all():
            address = int(np.argmin(finite))
            message = f"joint `{self.scene.joint_at(address)}` has the position {qpos[address]}"
            raise OntoError.of("SIM003", message, "the simulation diverged, or a proposal wrote a number that is none")
