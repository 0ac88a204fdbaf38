"""The target of an unmet fact, from its arguments and the scene: a joint's side, a region, or an object."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grounding.scenes import Scene
    from onto_compiler.required import Fact, RequiredABox
    from onto_compiler.schema import JointThreshold, Schema

__all__ = ["PlacementTarget", "place_of", "slot_of", "threshold_of"]


@dataclass(frozen=True, slots=True)
class PlacementTarget:
    """Where an object must be or must not be: at a site, or on an entity.

    ``parent`` carries the site; None for a table, and where nothing of it can be touched.
    """

    subject: str
    site: str | None
    parent: str | None
    contains: bool  # the native predicate asks for the site's volume rather than for what lies on it


def place_of(scene: Scene, fact: Fact) -> PlacementTarget | None:
    """The place that ``fact`` asks of a movable object, or forbids it; None when it speaks of something else."""
    names = fact.native.arguments
    if len(names) != 2 or names[0] not in scene.entities:
        return None
    if scene.free_joint(names[0]) is None:
        return None
    contains = fact.native.predicate.casefold() == "in"
    if scene.is_site(names[1]):
        parent = scene.site_parent(names[1])
        solid = parent is not None and len(scene.contact_geoms(parent)) > 0
        return PlacementTarget(names[0], names[1], parent if solid else None, contains)
    if names[1] in scene.entities and names[1] != names[0] and len(scene.contact_geoms(names[1])) > 0:
        return PlacementTarget(names[0], None, names[1], contains)
    return None


def threshold_of(schema: Schema, fact: Fact) -> JointThreshold | None:
    """The joint threshold that is the second argument of ``fact``, or None."""
    if len(fact.arguments) != 2:
        return None
    return schema.threshold(fact.arguments[1].type)


def slot_of(required: RequiredABox, fact: Fact) -> tuple[int, int]:
    """Which of how many facts ``fact`` is that share its second native argument: objects must leave each other room."""
    sharing = [f for f in required.facts if f.native.arguments[1:] == fact.native.arguments[1:] and f.polarity]
    return (sharing.index(fact), len(sharing)) if fact in sharing else (0, 1)
