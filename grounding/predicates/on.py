"""``On``: LIBERO's two meanings, resting on an object and resting on a region.

Sources: ``libero/envs/object_states/base_object_states.py`` (``check_ontop``) and
``libero/envs/objects/site_object.py`` (``under``). Every formula keeps the order of the native operations, so that
truth is equal bit for bit.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from grounding.plans import Box, Disc
from grounding.predicates.arguments import two_names
from grounding.predicates.contact import ContactTerm
from grounding.predicates.terms import Grounding, Term, all_of
from grounding.scenes import Scene
from onto_compiler.required import Fact
from onto_compiler.schema import Schema

__all__ = ["on_object", "on_site"]

NEAR = 0.03  # metres between the two origins, seen from above
SINK = 0.005  # metres that an origin may lie below the top of a region
HEADROOM = 0.10  # metres above the top of a region


def on_object(scene: Scene, fact: Fact, schema: Schema) -> Grounding:  # noqa: ARG001  a factory's signature
    """Ground ``On(upper, lower)``: they touch, upper's origin is not below lower's and within 3 cm of it from above.

    Raises ``SIM001`` for an unknown name, ``SIM006`` for a wrong number of arguments.
    """
    upper_name, lower_name = two_names(fact)
    upper, lower = scene.root_body(upper_name), scene.root_body(lower_name)
    contact = ContactTerm(scene, lower_name, upper_name)

    def terms(data: mujoco.MjData) -> Sequence[Term]:
        above, below = data.xpos[upper], data.xpos[lower]
        height = float(above[2] - below[2])
        near = float(NEAR - np.linalg.norm(below[:2] - above[:2]))
        return (Term("height", height, height >= 0.0), Term("xy", near, near > 0.0))

    return Grounding(terms, all_of, Disc(upper, lower, NEAR, contact.sides), contact)


def on_site(scene: Scene, fact: Fact, schema: Schema) -> Grounding:  # noqa: ARG001  a factory's signature
    """Ground ``On(object, region)``: the origin is in or up to 10 cm above the box, and it touches the carrier.

    The box's frame is the site's, applied as upstream does (``xmat @ offset``, without a transpose). A region of the
    table or floor has no carrier, and no contact is asked for. Raises ``SIM001``, ``SIM002``, ``SIM006``.
    """
    name, region = two_names(fact)
    body, site, carrier = scene.root_body(name), scene.site(region), scene.site_parent(region)
    contact = ContactTerm(scene, carrier, name) if carrier else None
    half = scene.model.site_size[site].copy()
    floor, ceiling = float(half[2] - SINK), float(half[2] + HEADROOM)

    def terms(data: mujoco.MjData) -> Sequence[Term]:
        frame = data.site_xmat[site].reshape((3, 3))
        x, y, z = (frame @ (data.xpos[body] - data.site_xpos[site])).tolist()
        box = (
            ("x", float(half[0]) - abs(x)),
            ("y", float(half[1]) - abs(y)),
            ("height", z - floor),
            ("ceiling", ceiling - z),
        )
        return tuple(Term(term, margin, margin > 0.0) for term, margin in box)

    x, y, _ = half.tolist()
    plan = Box(body, site, (-x, -y, floor), (x, y, ceiling), contact.sides if contact else None)
    return Grounding(terms, all_of, plan, contact)
