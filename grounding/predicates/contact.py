"""Contact between two entities: robosuite's ``check_contact`` for truth, depth or gap in metres for the margin."""

from __future__ import annotations

import math
import sys

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.predicates.boxes import Box, box_distance
from grounding.predicates.terms import Term
from grounding.scenes import Scene

__all__ = ["ContactTerm"]

TINY = sys.float_info.min
FAR = 100.0  # metres; LIBERO's rooms are smaller
AGREE = 1e-6  # metres between two accounts of one distance


class ContactTerm:
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
        self._geoms = a, b
        contype, affinity = model.geom_contype, model.geom_conaffinity
        collide = ((contype[a][:, None] & affinity[b]) | (contype[b] & affinity[a][:, None])) != 0
        self.sides = (np.flatnonzero(self._side[:-1] == 1), np.flatnonzero(self._side[:-1] == 2))
        bounds = model.geom_rbound
        radii = np.where(bounds == 0.0, np.inf, bounds)  # MuJoCo gives a plane no radius
        self._reach: NDArray[np.float64] = np.where(collide, radii[a][:, None] + radii[b], -np.inf)
        self._witness = np.zeros(6)

    def __call__(self, data: mujoco.MjData, least: float = math.inf) -> Term:
        """The term ``contact`` of a forwarded state; where its margin is above ``least``, any margin that is, too."""
        if data.ncon:
            contact = data.contact
            sides = self._side[contact.geom]
            hits = np.flatnonzero(sides[:, 0] * sides[:, 1] == 2)  # one geom of each side
            if hits.size:
                depth = float((contact.includemargin[hits] - contact.dist[hits]).max())
                return Term("contact", max(depth, TINY), True, self._label)
        return Term("contact", min(-self._gap(data, -least), -TINY), False, self._label)

    def _gap(self, data: mujoco.MjData, enough: float = 0.0) -> float:
        """Smallest distance (metres) over the pairs, nearest bounding spheres first, until none can be nearer.

        A distance below ``enough`` will do, whichever it is.
        """
        a, b = self._geoms
        centres = data.geom_xpos
        offsets = centres[a][:, None, :] - centres[b]
        lower = (np.sqrt(np.einsum("ijk,ijk->ij", offsets, offsets)) - self._reach).ravel()
        best = FAR
        if enough > 0.0 and lower.size:
            best = self._of_pair(data, int(np.argmin(lower)), FAR)
        if best < enough:
            return best
        for index in np.argsort(lower):
            if lower[index] >= best or best < enough:
                break
            best = min(best, self._of_pair(data, int(index), best))
        return best

    def _of_pair(self, data: mujoco.MjData, index: int, limit: float) -> float:
        a, b = self._geoms
        first, second = divmod(index, len(b))
        return self._distance(data, int(a[first]), int(b[second]), limit)

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
