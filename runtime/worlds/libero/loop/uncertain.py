"""The verdicts that depend on the fixtures' poses, for a state that does not include them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import isnan, sin
from typing import Any

import mujoco
import numpy as np

from grounding.observation import Observation
from grounding.scenes import Scene
from onto_compiler.bddl.ast import TaskSpec
from onto_compiler.required import Fact
from onto_compiler.schema import Schema
from runtime.wording import atom, unit_of
from runtime.worlds.fixtures import Freedom, freedoms

__all__ = ["Placements", "Uncertain", "uncertain_row"]


@dataclass(frozen=True, slots=True)
class Uncertain:
    """Required fact ``index``, whose ``margin`` is within the ``reach`` (m) by which ``fixtures`` may be displaced.

    ``margin`` is NaN if none is defined; any displacement may then decide.
    """

    index: int
    fact: Fact
    margin: float
    fixtures: tuple[str, ...]
    reach: float


def uncertain_row(each: Uncertain, schema: Schema) -> dict[str, Any]:
    """The record as plain JSON values; lengths are in metres, an undefined margin is None."""
    return {
        "fact": atom(each.fact, schema),
        "margin": None if isnan(each.margin) else each.margin,
        "unit": unit_of(each.fact, schema),
        "fixtures": list(each.fixtures),
        "reach": each.reach,
    }


class Placements:
    """How far LIBERO's reset may have displaced the fixtures of one task."""

    def __init__(self, spec: TaskSpec, scene: Scene) -> None:
        self._scene = scene
        self._free: Mapping[str, Freedom] = freedoms(spec)

    def uncertain(self, facts: Sequence[Fact], observation: Observation, data: mujoco.MjData) -> tuple[Uncertain, ...]:
        """The facts whose verdict in ``observation``, of ``data``, another placement of the fixtures might change."""
        found = []
        for index, fact in enumerate(facts):
            reach = self._reaches(fact.native.arguments, data)
            total = sum(reach.values())
            margin = float(observation.margin[index])
            excess = abs((margin if fact.polarity else -margin) - fact.threshold)
            if total > 0.0 and (isnan(margin) or excess <= total):
                found.append(Uncertain(index, fact, margin, tuple(reach), total))
        return tuple(found)

    def _reaches(self, names: Iterable[str], data: mujoco.MjData) -> dict[str, float]:
        """How far each fixture among the arguments may be displaced relative to the other arguments.

        A fact about one fixture, such as that its drawer is open, does not depend on its pose.
        """
        owners = {name: self._scene.site_parent(name) if self._scene.is_site(name) else name for name in names}
        if len(set(owners.values())) < 2:
            return {}
        reach: dict[str, float] = {}
        for name, owner in owners.items():
            freedom = self._free.get(owner or "")
            if owner is not None and freedom is not None and freedom.shift + freedom.turn > 0.0:
                swing = 2.0 * sin(freedom.turn / 2.0) * self._lever(name, owner, data) if freedom.turn else 0.0
                reach[owner] = max(reach.get(owner, 0.0), freedom.shift + swing)
        return reach

    def _lever(self, name: str, owner: str, data: mujoco.MjData) -> float:
        """How far what is named reaches from the axis that its fixture is turned about, in metres."""
        scene, model = self._scene, self._scene.model
        axis = data.xpos[scene.root_body(owner)][:2]
        if scene.is_site(name):
            site = scene.site(name)
            return float(np.linalg.norm(data.site_xpos[site][:2] - axis) + np.linalg.norm(model.site_size[site]))
        geoms = scene.contact_geoms(owner)
        away = np.linalg.norm(data.geom_xpos[geoms][:, :2] - axis, axis=1) + model.geom_rbound[geoms]
        return float(away.max(initial=0.0))
