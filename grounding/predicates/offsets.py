"""How high an object is over a site, and how near to it: against the tolerance that the TBox declares."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from grounding.predicates.arguments import tolerance_of, two_names
from grounding.predicates.terms import Grounding, Term, all_of
from grounding.scenes import Scene
from onto_compiler.required import Fact
from onto_compiler.schema import Schema

__all__ = ["at_level", "near_site"]


def at_level(scene: Scene, fact: Fact, schema: Schema) -> Grounding:
    """Ground ``AtLevel(object, site)``: the origin is no more than the tolerance above the site, metres.

    Its negation is robosuite's "lifted" (``environments/manipulation/lift.py``, ``_check_success``), which is strict:
    at equality this holds. Raises ``SIM001``, ``SIM002`` for unknown names, ``SIM006`` without a tolerance.
    """
    name, site_name = two_names(fact)
    tolerance = tolerance_of(fact, schema)
    body, site = scene.root_body(name), scene.site(site_name)

    def terms(data: mujoco.MjData) -> Sequence[Term]:
        margin = float(data.site_xpos[site, 2] + tolerance - data.xpos[body, 2])
        return (Term("height", margin, margin >= 0.0),)

    return Grounding(terms, all_of)


def near_site(scene: Scene, fact: Fact, schema: Schema) -> Grounding:
    """Ground ``Near(object, site)``: the origin is no farther from the site than the tolerance, metres.

    Raises ``SIM001``, ``SIM002`` for unknown names, ``SIM006`` without a tolerance.
    """
    name, site_name = two_names(fact)
    tolerance = tolerance_of(fact, schema)
    body, site = scene.root_body(name), scene.site(site_name)

    def terms(data: mujoco.MjData) -> Sequence[Term]:
        margin = tolerance - float(np.linalg.norm(data.site_xpos[site] - data.xpos[body]))
        return (Term("distance", margin, margin >= 0.0),)

    return Grounding(terms, all_of)
