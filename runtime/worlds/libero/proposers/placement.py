"""Puts a movable entity down at a pose: it is moved with what rests on it, and lowered until it touches something."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from runtime.worlds.libero.proposers.candidates import StateCandidate
from runtime.worlds.libero.proposers.clearance import Clearance
from runtime.worlds.libero.scene.geometry import cube_rotations, level, matrix_of, quaternion_of, yaw_matrix

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from grounding.scenes import Scene

    Array = NDArray[np.float64]

__all__ = ["ENCLOSED", "UNBALANCED", "Mover", "Placement", "Window", "drop", "rest_orientations", "yaws"]

TOUCH_M = 4e-4  # about as deep as MuJoCo's default contacts let a light object sink under its own weight
_STEP_M = 4e-3  # of the descent: what is thinner than this and the object together is met all the same
_RESOLUTION_M = 1e-5
_STEADY_M = 0.002  # the lean that a resting object must withstand
UNBALANCED, ENCLOSED = 2, 1  # flaws: gravity would tip it; the region is covered


@dataclass(frozen=True, slots=True, eq=False)
class Placement:
    """Where the origin of an object comes to lie horizontally (m), its orientation (3, 3), and why."""

    x: float
    y: float
    matrix: Array
    note: str


@dataclass(frozen=True, slots=True)
class Window:
    """Heights (m): the origin may come to rest between ``low`` and ``high``; the descent clears ``roof`` at first."""

    low: float
    high: float
    roof: float


def yaws(matrix: Array, turns: Sequence[float]) -> Iterator[tuple[Array, float]]:
    """``matrix`` turned about the vertical by each of ``turns`` (rad)."""
    for turn in turns:
        yield yaw_matrix(turn) @ matrix, turn


def rest_orientations(scene: Scene, qpos: Array, entity: str) -> list[Array]:
    """Orientations that ``entity`` may rest in, no two alike but for the yaw.

    As it stands now, upright to the nearest axis, as modelled, and lying on each of its other sides.
    """
    free = scene.free_joint(entity)
    if free is None:
        return []
    where = scene.qpos_slice(free)
    now, modelled = (matrix_of(quat) for quat in (qpos[where][3:], scene.model.qpos0[where][3:]))
    upright = level(now, np.pi / 2)
    found: list[Array] = []
    for matrix in (level(now), upright, level(modelled), *(cube @ upright for cube in cube_rotations())):
        if not any(np.allclose(matrix[2], other[2], atol=1e-3) for other in found):
            found.append(matrix)
    return found


def drop(mover: Mover, pose: Placement, window: Window, flaws: int = 0) -> Iterator[StateCandidate]:
    """Lower ``mover``'s entity at ``pose`` and yield each height in ``window`` at which it comes to touch something.

    The entity sinks in by ``TOUCH_M`` at most. A resting pose that gravity would tip has the flaw ``UNBALANCED``
    in addition to the caller's ``flaws``.
    """
    mover.aim(pose)
    top, bottom = window.roof + mover.below + _STEP_M, window.low - _STEP_M
    previous = None
    for height in np.linspace(top, bottom, max(int(np.ceil((top - bottom) / _STEP_M)) + 1, 2)):
        hit = mover.hits(float(height))
        if hit and previous is not None and height <= window.high:
            touch = _bisect(mover, previous, float(height))
            if window.low <= touch <= window.high:
                yield mover.candidate(touch, flaws)
        previous = None if hit else float(height)


def _bisect(mover: Mover, clear: float, hit: float) -> float:
    while clear - hit > _RESOLUTION_M:
        middle = (clear + hit) / 2
        if mover.hits(middle):
            hit = middle
        else:
            clear = middle
    return clear


class Mover:
    """Writes poses of one entity, and of what rests on it, to the scratch state."""

    def __init__(self, clearance: Clearance, entity: str) -> None:
        scene = clearance.scene
        clearance.place(clearance.start)
        self.clearance, self.entity = clearance, entity
        riders = clearance.supported_by(scene.bodies(entity).tolist())
        self.riders = riders
        self.slices = [scene.qpos_slice(j) for e in (entity, *riders) if (j := scene.free_joint(e)) is not None]
        self.moving = clearance.geom_mask(b for e in (entity, *riders) for b in scene.bodies(e).tolist())
        self._pairs = clearance.pairs(self.moving)
        first = clearance.start[self.slices[0]]
        self.home, self.home_matrix = first[:3].copy(), matrix_of(first[3:])
        self.aim(Placement(float(self.home[0]), float(self.home[1]), self.home_matrix, "as it is"))

    def aim(self, pose: Placement) -> None:
        """Take up ``pose``; the methods below say at which height."""
        clearance = self.clearance
        turn = pose.matrix @ self.home_matrix.T
        target = np.array([pose.x, pose.y, 0.0])
        self.pose, self._aimed = pose, clearance.start.copy()
        for where in self.slices:
            old = clearance.start[where]
            self._aimed[where] = np.concatenate(
                [target + turn @ (old[:3] - self.home), quaternion_of(turn @ matrix_of(old[3:]))]
            )
        self.write(0.0)
        low, high = clearance.boxes()
        self.below = -float(low[clearance.scene.contact_geoms(self.entity), 2].min())
        one, two = self._pairs[:, 0], self._pairs[:, 1]
        beside = np.all((low[one, :2] < high[two, :2]) & (low[two, :2] < high[one, :2]), axis=1)
        self._column = self._pairs[beside]  # what can meet while only the height changes
        one, two = one[beside], two[beside]
        self._meets = low[two, 2] - high[one, 2], high[two, 2] - low[one, 2]  # heights between which their boxes meet

    def write(self, height: float) -> None:
        """Put the entity's origin at ``height`` (m) in the scratch state, without finding contacts."""
        data = self.clearance.data
        data.qpos[:] = self._aimed
        for where in self.slices:
            data.qpos[where.start + 2] += height
        mujoco.mj_kinematics(self.clearance.model, data)

    def hits(self, height: float) -> bool:
        """Whether the entity, or what it carries, sinks into anything else by more than ``TOUCH_M`` there."""
        near = (self._meets[0] < height) & (height < self._meets[1])
        if not near.any():
            return False
        self.write(height)
        return self.clearance.deepest(self._column[near], TOUCH_M) > TOUCH_M

    def candidate(self, height: float, flaws: int) -> StateCandidate:
        """The state with the entity there, ranked by how far it can lean."""
        self.write(height)
        self.clearance.refresh()
        lean = self.clearance.steadiness(self.entity, self.moving)
        note = self.pose.note if not self.riders else f"{self.pose.note}, carrying {', '.join(self.riders)}"
        return StateCandidate(
            self.clearance.data.qpos.copy(), note, flaws + (UNBALANCED if lean < _STEADY_M else 0), -lean
        )
