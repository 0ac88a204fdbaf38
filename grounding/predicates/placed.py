"""Whether something stands where the task's premise puts it: its origin above a region's rectangle.

In an initial state, ``On(thing, region of the table)`` tells LIBERO's sampler the rectangle in which to put the thing.
The native predicate also asks that the origin lies in a band of height over the region, which fixtures meet (in all 130
tasks of the five suites), but which an object may miss: it depends on where its asset has its origin.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import mujoco

from grounding.plans import Box
from grounding.predicates.arguments import two_names
from grounding.predicates.terms import Grounding, Term, all_of
from grounding.scenes import Scene
from onto_compiler.required import Fact
from onto_compiler.schema import Schema

__all__ = ["placed_in_region"]


def placed_in_region(scene: Scene, fact: Fact, schema: Schema) -> Grounding:  # noqa: ARG001  a factory's signature
    """Ground a premise ``On(thing, region)``: the x and y of its root body lie within the region, edges included."""
    name, region = two_names(fact)
    body, site = scene.root_body(name), scene.site(region)
    half_x, half_y, _ = scene.model.site_size[site].tolist()

    def terms(data: mujoco.MjData) -> Sequence[Term]:
        frame = data.site_xmat[site].reshape((3, 3))
        x, y, _ = (frame @ (data.xpos[body] - data.site_xpos[site])).tolist()
        margins = (("x", half_x - abs(x)), ("y", half_y - abs(y)))
        return tuple(Term(axis, margin, margin >= 0.0) for axis, margin in margins)

    plan = Box(body, site, (-half_x, -half_y, -math.inf), (half_x, half_y, math.inf))
    return Grounding(terms, all_of, plan)
