"""``In``: an origin inside a region's box (LIBERO's ``SiteObject.in_box``).

LIBERO also asks for contact, but a region answers that it is always in contact. It defines ``In`` for regions only: an
object has no ``in_box``, so there is nothing to reproduce for ``In(object, object)``.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from grounding.plans import SiteBox
from grounding.predicates.arguments import two_names
from grounding.predicates.terms import Grounding, Term, all_of
from grounding.scenes import Scene
from onto_compiler.required import Fact
from onto_compiler.schema import Schema

__all__ = ["in_site", "inside_site"]

SINK = 0.01  # metres that an origin may lie below the box


def in_site(scene: Scene, fact: Fact, schema: Schema) -> Grounding:  # noqa: ARG001  a factory's signature
    """Ground ``In(object, region)``: the origin lies strictly inside the region's box, 1 cm of depth allowed below it.

    The box is axis-aligned with half sizes ``abs(xmat @ size)``, as upstream has it: exact for turns by right angles
    only. Raises ``SIM001`` or ``SIM002`` for an unknown name, ``SIM006`` for a wrong number of arguments.
    """
    return _in_box(scene, fact, SINK)


def inside_site(scene: Scene, fact: Fact, schema: Schema) -> Grounding:  # noqa: ARG001  a factory's signature
    """Ground ``In(object, region)`` with no depth allowed below the box; raises as :func:`in_site`."""
    return _in_box(scene, fact, 0.0)


def _in_box(scene: Scene, fact: Fact, sink: float) -> Grounding:
    name, region = two_names(fact)
    body, site = scene.root_body(name), scene.site(region)
    size = scene.model.site_size[site].copy()

    def terms(data: mujoco.MjData) -> Sequence[Term]:
        centre = data.site_xpos[site]
        half = np.abs(data.site_xmat[site].reshape((3, 3)) @ size)
        lower, upper = centre - half, centre + half
        lower[2] -= sink
        origin = data.xpos[body]
        below, above = (origin - lower).tolist(), (upper - origin).tolist()
        return tuple(
            Term(axis, margin, margin > 0.0)
            for axis, margin in zip(("x", "y", "depth", "x", "y", "height"), (*below, *above), strict=True)
        )

    x, y, z = size.tolist()
    return Grounding(terms, all_of, SiteBox(body, site, (x, y, z), sink))
