"""An index of a compiled MuJoCo scene: entities, regions, their geoms and joints.

robosuite, and LIBERO with it, builds each object and fixture ``NAME`` as a body ``NAME_main`` directly under the world;
a region is a site, either on a body of an entity (a drawer, a burner) or on the table or floor. What a world names
otherwise is in its :class:`Naming`. A :class:`Scene` reads those names once. It never builds, steps or writes a model.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

import mujoco
import numpy as np

from onto_compiler.problems import OntoError, near

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

__all__ = ["Naming", "Scene"]

T = TypeVar("T")

QPOS_WIDTH = {
    mujoco.mjtJoint.mjJNT_FREE: 7,
    mujoco.mjtJoint.mjJNT_BALL: 4,
    mujoco.mjtJoint.mjJNT_SLIDE: 1,
    mujoco.mjtJoint.mjJNT_HINGE: 1,
}
DOF_WIDTH = {
    mujoco.mjtJoint.mjJNT_FREE: 6,
    mujoco.mjtJoint.mjJNT_BALL: 3,
    mujoco.mjtJoint.mjJNT_SLIDE: 1,
    mujoco.mjtJoint.mjJNT_HINGE: 1,
}


@dataclass(frozen=True, slots=True)
class Naming:
    """What a world calls the parts of its models.

    ``root_suffix`` ends the name of an entity's root body, which stands directly under the world. ``roots`` are further
    root bodies, by the name of their entity. ``joints`` are the joints of names that stand for joints alone. ``parts``
    are named groups of collision geoms that belong to no entity of a task, such as the pads of a gripper: only a
    contact asks for them.
    """

    root_suffix: str = "_main"
    collision_group: int = 0
    roots: Mapping[str, str] = field(default_factory=dict)
    joints: Mapping[str, Sequence[str]] = field(default_factory=dict)
    parts: Mapping[str, Sequence[str]] = field(default_factory=dict)


class Scene:
    """Names of ``model`` resolved to ids. All ids are MuJoCo's; all arrays of ids are sorted and read-only."""

    def __init__(self, model: mujoco.MjModel, naming: Naming | None = None) -> None:
        """Index ``model``; it is kept, and nothing of it is changed. Without ``naming``, as robosuite names."""
        self.model = model
        self.naming = naming = naming or Naming()
        parents = [int(p) for p in model.body_parentid]
        self._owner: list[str | None] = [None] * model.nbody  # entity that a body belongs to
        self._roots: dict[str, int] = {}
        for body in range(1, model.nbody):
            name = _name(model, mujoco.mjtObj.mjOBJ_BODY, body)
            entity = self._entity(name) if parents[body] == 0 else None
            if entity is not None:
                self._roots[entity] = body
                self._owner[body] = entity
            else:  # MuJoCo numbers a parent before its children
                self._owner[body] = self._owner[parents[body]]
        self._sites = {
            name: site
            for site in range(model.nsite)
            if (name := _name(model, mujoco.mjtObj.mjOBJ_SITE, site)) and not name.endswith("_default_site")
        }
        self._bodies = {e: _ids(b for b in range(model.nbody) if self._owner[b] == e) for e in self._roots}
        self._geoms = {e: self._collision_geoms(e) for e in self._roots}
        self._geoms |= {part: self._named_geoms(names) for part, names in naming.parts.items()}
        self._joints = {e: _ids(j for j in range(model.njnt) if self._owner_of_joint(j) == e) for e in self._roots}
        self._joints |= {name: _ids(model.joint(each).id for each in names) for name, names in naming.joints.items()}

    @property
    def entities(self) -> tuple[str, ...]:
        """Names of the objects and fixtures, in the model's order."""
        return tuple(self._roots)

    @property
    def sites(self) -> tuple[str, ...]:
        """Names of the sites (LIBERO's regions among them), in the model's order."""
        return tuple(self._sites)

    def root_body(self, name: str) -> int:
        """Id of the body whose pose LIBERO takes for the pose of entity ``name``; ``SIM001`` when there is none."""
        return self._lookup(self._roots, name)

    def bodies(self, name: str) -> NDArray[np.intp]:
        """Ids of the bodies of entity ``name``: its root and all below; ``SIM001`` when there is none."""
        return self._lookup(self._bodies, name)

    def contact_geoms(self, name: str) -> NDArray[np.intp]:
        """Ids of the geoms that robosuite's ``check_contact`` compares for entity ``name``.

        They are the geoms of group 0 below its root body (``robosuite/models/objects/objects.py``, ``contact_geoms``),
        or those of one of the naming's parts. Raises ``SIM001`` when there is no such entity.
        """
        return self._lookup(self._geoms, name)

    def joints(self, name: str) -> NDArray[np.intp]:
        """Ids of all joints of an entity, or of the hinges and slides of the body that carries a region's site.

        The second is what LIBERO keeps as ``SiteObject.joints``: it reads them before the free joint is added.
        Raises ``SIM002`` when ``name`` is neither.
        """
        if name in self._joints:
            return self._joints[name]
        body = int(self.model.site_bodyid[self.site(name)])
        free = mujoco.mjtJoint.mjJNT_FREE
        return _ids(j for j in range(self.model.njnt) if self._carries(body, j) and self.model.jnt_type[j] != free)

    def free_joint(self, name: str) -> int | None:
        """Id of the free joint that moves entity ``name``, None for a fixture; ``SIM001`` when there is no entity."""
        free = mujoco.mjtJoint.mjJNT_FREE
        ids = self._lookup(self._joints, name)
        return next((int(j) for j in ids if self.model.jnt_type[j] == free), None)

    def site(self, name: str) -> int:
        """Id of site ``name``; ``SIM002`` when there is none."""
        if name not in self._sites:
            kind = "is an entity, not a region" if name in self._roots else "has no such site"
            message = f"task names `{name}` as a region; in the scene it {kind}"
            if name not in self._roots:
                message = f"task names `{name}`, the scene {kind}"
            raise OntoError.of("SIM002", message, near(name, self._sites))
        return self._sites[name]

    def site_parent(self, site: str) -> str | None:
        """Name the entity that carries ``site``; None on the table or floor (LIBERO's ``parent_name``)."""
        return self._owner[int(self.model.site_bodyid[self.site(site)])]

    def is_site(self, name: str) -> bool:
        """Whether ``name`` is a site."""
        return name in self._sites

    def qpos_slice(self, joint: int) -> slice:
        """Where ``qpos`` holds ``joint``: 7 numbers (position, quaternion wxyz) if free, 1 for a hinge or slide."""
        start = int(self.model.jnt_qposadr[joint])
        return slice(start, start + QPOS_WIDTH[mujoco.mjtJoint(int(self.model.jnt_type[joint]))])

    def dof_slice(self, joint: int) -> slice:
        """Where ``qvel`` holds ``joint``."""
        start = int(self.model.jnt_dofadr[joint])
        return slice(start, start + DOF_WIDTH[mujoco.mjtJoint(int(self.model.jnt_type[joint]))])

    def joint_at(self, qpos_address: int) -> str:
        """Name of the joint that ``qpos[qpos_address]`` belongs to, for messages."""
        joint = int(np.searchsorted(self.model.jnt_qposadr, qpos_address, side="right")) - 1
        return _name(self.model, mujoco.mjtObj.mjOBJ_JOINT, joint) or f"joint {joint}"

    def _entity(self, body: str) -> str | None:
        """The entity whose root ``body`` is, by the world's names."""
        naming = self.naming
        given = next((entity for entity, root in naming.roots.items() if root == body), None)
        if given is None and body.endswith(naming.root_suffix):
            return body.removesuffix(naming.root_suffix)
        return given

    def _named_geoms(self, names: Sequence[str]) -> NDArray[np.intp]:
        return _ids(sorted(int(self.model.geom(name).id) for name in names))

    def _collision_geoms(self, entity: str) -> NDArray[np.intp]:
        model = self.model
        return _ids(
            g
            for g in range(model.ngeom)
            if self._owner[int(model.geom_bodyid[g])] == entity
            and model.geom_group[g] == self.naming.collision_group
            and _name(model, mujoco.mjtObj.mjOBJ_GEOM, g)
        )

    def _owner_of_joint(self, joint: int) -> str | None:
        return self._owner[int(self.model.jnt_bodyid[joint])]

    def _carries(self, body: int, joint: int) -> bool:
        return int(self.model.jnt_bodyid[joint]) == body

    def _lookup(self, table: Mapping[str, T], name: str) -> T:
        if name in table:
            return table[name]
        kind = "is a region there, not an entity" if name in self._sites else "has no such body"
        raise OntoError.of("SIM001", f"task names `{name}`, the scene {kind}", near(name, table))


def _name(model: mujoco.MjModel, kind: mujoco.mjtObj, index: int) -> str:
    return mujoco.mj_id2name(model, kind, index) or ""


def _ids(values: Iterable[int]) -> NDArray[np.intp]:
    array = np.fromiter(values, dtype=np.intp)
    array.flags.writeable = False
    return array
