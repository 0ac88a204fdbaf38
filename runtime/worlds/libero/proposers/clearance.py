"""Overlap and support queries on a scratch copy of a state. It never steps.

Only positions are computed (``mj_kinematics``) and, where asked, contacts found (``mj_collision``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from runtime.worlds.libero.scene.geometry import Support, balance, extent

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from grounding.scenes import Scene

    Array = NDArray[np.float64]

__all__ = ["Clearance"]

LEANS_M = (0.0, 0.002, 0.005, 0.01)  # how far the centre of mass is moved to test a support
_BALANCED = 0.02  # of the weight: what the contacts may fail to carry
_SUPPORT_COSINE = 0.5  # a contact normal nearer to the vertical than 60 degrees supports


class Clearance:
    """Collision queries on a private ``MjData`` of ``scene.model``, starting from ``qpos`` (nq,)."""

    def __init__(self, scene: Scene, qpos: Array) -> None:
        self.scene = scene
        self.model = scene.model
        self.data = mujoco.MjData(scene.model)
        self.start = np.array(qpos, dtype=np.float64)
        self.place(self.start)

    def place(self, qpos: Array) -> None:
        """Write ``qpos`` to the scratch copy and find its contacts."""
        self.data.qpos[:] = qpos
        self.refresh()

    def refresh(self) -> None:
        """Recompute poses and contacts after a write to ``data.qpos``; without contacts, ``mj_kinematics`` does."""
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_collision(self.model, self.data)

    def geom_mask(self, bodies: Iterable[int]) -> NDArray[np.bool_]:
        """Mask (ngeom,) of the geoms that ride on ``bodies``."""
        return np.isin(self.model.geom_bodyid, np.fromiter(bodies, dtype=np.intp))

    def boxes(self) -> tuple[Array, Array]:
        """Lower and upper corners (ngeom, 3) in the world of the box around every geom; a plane's has no end."""
        model, data = self.model, self.data
        frames = data.geom_xmat.reshape(-1, 3, 3)
        centre = data.geom_xpos + np.einsum("gij,gj->gi", frames, model.geom_aabb[:, :3])
        reach = np.einsum("gij,gj->gi", np.abs(frames), model.geom_aabb[:, 3:])
        reach[model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE] = np.inf
        return centre - reach, centre + reach

    def pairs(self, moving: NDArray[np.bool_], within: NDArray[np.bool_] | None = None) -> NDArray[np.intp]:
        """Pairs (n, 2) of a ``moving`` geom and one that is not, which MuJoCo would let collide.

        Pairs inside ``within`` are left out: a drawer may rub its own cabinet.
        """
        model = self.model
        own, other = np.flatnonzero(moving), np.flatnonzero(~moving)
        collide = (model.geom_contype[own, None] & model.geom_conaffinity[None, other]) | (
            model.geom_conaffinity[own, None] & model.geom_contype[None, other]
        )
        if within is not None:
            collide = np.where(within[own, None] & within[None, other], 0, collide)
        rows, columns = np.nonzero(collide)
        return np.stack([own[rows], other[columns]], axis=1)

    def overlap(self, pairs: NDArray[np.intp]) -> float:
        """The deepest overlap (m) of ``pairs`` (n, 2) of geoms, 0.0 when there is none."""
        low, high = self.boxes()
        one, two = pairs[:, 0], pairs[:, 1]
        return self.deepest(pairs[np.all((low[one] < high[two]) & (low[two] < high[one]), axis=1)])

    def deepest(self, pairs: NDArray[np.intp], enough: float = np.inf) -> float:
        """As :meth:`overlap`, measuring every pair, but stopping at one deeper than ``enough``.

        Contacts do not suffice: MuJoCo's box-box routine reports half of an overlap, and none if a thin plate goes
        right through a box.
        """
        found = 0.0
        for first, second in pairs.tolist():
            found = max(found, -float(mujoco.mj_geomDistance(self.model, self.data, first, second, 0.0, None)))
            if found > enough:
                break
        return found

    def subtree(self, body: int) -> list[int]:
        """``body`` and all bodies below it."""
        inside = {body}
        for child in range(body + 1, self.model.nbody):  # a parent is numbered before its children
            if int(self.model.body_parentid[child]) in inside:
                inside.add(child)
        return sorted(inside)

    def supported_by(self, bodies: Iterable[int]) -> tuple[str, ...]:
        """Movable entities that rest on ``bodies``, directly or on one another, in the current scratch state."""
        carrying = set(bodies)
        free = {
            e: set(self.scene.bodies(e).tolist()) for e in self.scene.entities if self.scene.free_joint(e) is not None
        }
        free = {e: members for e, members in free.items() if not members & carrying}
        found: list[str] = []
        grown = True
        while grown:
            grown = False
            for entity, members in free.items():
                if entity not in found and self._rests(members, carrying):
                    found.append(entity)
                    carrying |= members
                    grown = True
        return tuple(found)

    def steadiness(self, entity: str, moving: NDArray[np.bool_]) -> float:
        """How far (m) the centre of mass of ``entity`` may be off before gravity tips it, in the steps of ``LEANS_M``.

        Judged from the contacts of ``moving`` geoms with all others; -1.0 when it is not balanced even as it is.
        """
        support = self._support(moving)
        bodies = self.scene.bodies(entity)
        mass = self.model.body_mass[bodies]
        centre = (mass[:, None] * self.data.xipos[bodies]).sum(axis=0) / max(float(mass.sum()), 1e-9)
        low, high = extent(self.model, self.data, self.scene.contact_geoms(entity))
        length = float(np.max(high - low)) / 2
        borne = -1.0
        for lean in LEANS_M:
            if balance(support, centre, length, lean) > _BALANCED:
                break
            borne = lean
        return borne

    def _support(self, moving: NDArray[np.bool_]) -> Support:
        contact = self.data.contact
        pairs = contact.geom if self.data.ncon else np.zeros((0, 2), dtype=np.intp)
        first, second = moving[pairs[:, 0]], moving[pairs[:, 1]]
        rows = np.flatnonzero(first != second)
        points = np.asarray(contact.pos, dtype=np.float64).reshape(-1, 3)[rows]
        towards = np.where(second[rows], 1.0, -1.0)[
            :, None
        ]  # a contact's normal points from its first to its second geom
        normals = np.asarray(contact.frame, dtype=np.float64).reshape(-1, 9)[rows, :3] * towards
        return Support(points, normals, np.asarray(contact.friction, dtype=np.float64).reshape(-1, 5)[rows, 0])

    def _rests(self, members: set[int], carrying: set[int]) -> bool:
        body = self.model.geom_bodyid
        for index in range(self.data.ncon):
            one, two = (int(body[g]) for g in self.data.contact.geom[index])
            upward = float(self.data.contact.frame[index].ravel()[2])
            if one in carrying and two in members and upward > _SUPPORT_COSINE:
                return True
            if two in carrying and one in members and -upward > _SUPPORT_COSINE:
                return True
        return False
