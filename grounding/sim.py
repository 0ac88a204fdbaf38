"""Ground required facts in a MuJoCo state: the observation whose truth equals the native predicates' (phi_sim)."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from grounding.observation import Observation, stack
from grounding.predicates.registry import ground
from grounding.predicates.terms import Grounding, Term
from grounding.scenes import Scene
from onto_compiler.problems import OntoError, Problem
from onto_compiler.required import Fact
from onto_compiler.schema import Schema

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

    def observe(self, data: mujoco.MjData, step: int = 0) -> Observation:
        """Ground every fact in ``data``, a forwarded state of the scene's model; entry i speaks of fact i.

        Raises ``SIM003`` when ``qpos`` is not finite, naming the joint, and ``SIM004`` when it is another scene's.
        """
        self._check(data)
        return stack("sim", step, [grounding(data) for grounding in self._groundings])

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
