"""A stove that is on shows its burner. LIBERO toggles that site after every step; it affects only pictures.

Source: LIBERO ``envs/problems/*.py`` (``set_visualization``). When a stove is on is in the ontology's thresholds.
"""

from __future__ import annotations

import mujoco
import numpy as np

from onto_compiler.bddl.ast import TaskSpec
from onto_compiler.schema import Schema
from runtime.worlds.libero.simulator.compiled import CompiledScene

__all__ = ["StoveLights"]

_NATIVE = "Turnon"
_ALPHA = 3  # in RGBA


class StoveLights:
    """The sites ``STOVE_burner`` of one scene; without any, nothing is done."""

    def __init__(self, scene: CompiledScene, spec: TaskSpec, schema: Schema) -> None:
        """Find the stoves among the declared fixtures and objects."""
        model = scene.model
        self._rgba = model.site_rgba
        self._start = model.site_rgba.copy()
        self._stoves = []
        for declared in spec.declarations:
            threshold = schema.thresholds.get((declared.category, _NATIVE))
            site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, f"{declared.name}_burner")
            if threshold is not None and site >= 0:
                addresses = model.jnt_qposadr[scene.index.joints(declared.name)]
                self._stoves.append((site, addresses, threshold.bound))

    def reset(self) -> None:
        """Show every site as the scene was compiled."""
        self._rgba[:] = self._start

    def update(self, data: mujoco.MjData) -> None:
        """Show the burners of the stoves that ``data`` has turned on, and hide the others."""
        for site, addresses, bound in self._stoves:
            on = bool(np.any(data.qpos[addresses] >= bound))
            if (self._rgba[site, _ALPHA] > 0) != on:
                self._rgba[site, _ALPHA] = 1 - self._rgba[site, _ALPHA]
