"""Contact between two entities: robosuite's ``check_contact`` for truth, depth or gap in metres for the margin."""

from __future__ import annotations

import sys

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.predicates.boxes import Box, box_distance
from grounding.predicates.terms import Term
from grounding.scenes import Scene

__all__ = ["Contact"]

TINY = sys.float_info.min
FAR = 100.0  # metres; LIBERO's rooms are smaller
AGREE = 1e-6  # metres between two accounts of one distance


class Contact:
    """Whether any two contact geoms of entities ``first`` and ``second`` have an entry in ``data.contact``.

    The native test (``robosuite/environments/base.py``, ``check_contact``) takes every entry of the list, whatever its
    distance; so does this. Touching: the margin is the largest of ``includemargin - dist``, made positive. Apart: minus
    the smallest distance between two geoms that can collide, made negative; that part costs more, as nothing is cached.
    ``sides`` are the geoms of either entity.
    """

    def __init__(self, scene: Scene, first: str, second: str) -> None:
        """Resolve both entities; raises ``SIM001``."""
        model = scene.model
        self._model = model
        self._label = f"{first}, {second}"
        a, b = scene.contact_geoms(first), scene.contact_geoms(second)
        self._side = np.zeros(model.ngeom + 1, dtype=np.int8)  # the last stands for -1, a flex contact
        self._side[a] = 1
        self._side[b] = 2
        pairs = np.stack([np.repeat(a, len(b)), np.tile(b, len(a))], axis=1)
        contype, affinity = model.geom_contype, model.geom_conaffinity
        left, right = pairs[:, 0], pairs[:, 1]
        collide = ((contype[left] & affinity[right]) | (contype[right] & affinity[left])) != 0
        self._pairs: NDArray[np.intp] = pairs[collide]
        self.sides = (np.flatnonzero(self._side[:-1] == 1), np.flatnonzero(self._side[:-1] == 2))
        bounds = model.geom_rbound
        radii = bounds[self._pairs].sum(axis=1)
        unbounded = (bounds[self._pairs] == 0.0).any(axis=1)  # MuJoCo gives a plane no radius
        self._reach = np.where(unbounded, np.inf, radii)
        self._witness = np.zeros(6)

    def __call__(self, data: mujoco.MjData) -> Term:
        """The term ``contact`` of a forwarded state."""
        if data.ncon:
            contact = data.contact
            sides = self._side[contact.geom]
            hits = np.flatnonzero(sides[:, 0] * sides[:, 1] == 2)  # one geom of each side
            if hits.size:
                depth = float((contact.includemargin[hits] - contact.dist[hits]).max())
                return Term("contact", max(depth, TINY), True, self._label)
        return Term("contact", min(-self._gap(data), -TINY), False, self._label)

    def _gap(self, data: mujoco.MjData) -> float:
        """Smallest distance (metres) over the pairs, nearest bounding spheres first, until none can be nearer."""
        centres = data.geom_xpos
        offsets = centres[self._pairs[:, 0]] - centres[self._pairs[:, 1]]
        lower = np.sqrt(np.einsum("ij,ij->i", offsets, offsets)) - self._reach
        best = FAR
        for index in np.argsort(lower):
            if lower[index] >= best:
                break
            first, second = self._pairs[index]
            best = min(best, self._distance(data, int(first), int(second), best))
        return best

    def _distance(self, data: mujoco.MjData, first: int, second: int, limit: float) -> float:
        """Distance of two geoms, or ``limit`` when it is larger.

        ``mj_geomDistance`` now and then answers 0 for boxes that lie far apart (0.3 % of the pairs tried, MuJoCo
        3.3.7). Its witness points then contradict it, and the distance of the bounding boxes is taken: exact for boxes.
        """
        found = mujoco.mj_geomDistance(self._model, data, first, second, limit, self._witness)
        if found >= limit:
            return limit
        apart = float(np.linalg.norm(self._witness[3:] - self._witness[:3]))
        if found > 0.0 and abs(apart - found) < AGREE:
            return float(found)
        return min(limit, box_distance(self._box(data, first), self._box(data, second)))

    def _box(self, data: mujoco.MjData, geom: int) -> Box:
        frame, local = data.geom_xmat[geom].reshape((3, 3)), self._model.geom_aabb[geom]
        return data.geom_xpos[geom] + frame @ local[:3], frame, local[3:]
