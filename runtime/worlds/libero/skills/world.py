"""A skill's view of a simulation: the gripper, and the shapes and poses of entities."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

import mujoco
import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.simulator.compiled import CompiledScene
from runtime.worlds.libero.simulator.simulation import Simulation
from runtime.worlds.libero.skills.clouds import body_cloud
from runtime.worlds.libero.skills.frames import Pose

__all__ = ["SkillWorld", "SurfacePoints"]

Array = NDArray[np.float64]

_ROBOT = ("robot0_", "gripper0_", "mount0_")


class SurfacePoints:
    """Surface points of every body of a scene, in the body's frame: computed once for a scene, when first asked for."""

    def __init__(self, scene: CompiledScene) -> None:
        self.scene = scene
        model = scene.model
        collides = (model.geom_contype | model.geom_conaffinity) != 0
        self._geoms = np.flatnonzero(collides)
        names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, b) or "" for b in range(model.nbody)]
        self.robot = np.array([name.startswith(_ROBOT) for name in names])
        self.bodies = np.unique(model.geom_bodyid[self._geoms])
        self.of_body = cache(self._of_body)

    def _of_body(self, body: int) -> Array:
        return body_cloud(self.scene.model, body, self._geoms)


class SkillWorld:
    """A read-only view of ``sim``."""

    def __init__(self, sim: Simulation, shapes: SurfacePoints | None = None) -> None:
        self.sim = sim
        self.model, self.data = sim.model, sim.data
        self.index = sim.scene.index
        self.shapes = shapes or SurfacePoints(sim.scene)
        self._site = sim.scene.arm.site
        fingers = sim.scene.arm.fingers
        joints = sim.model.actuator_trnid[fingers, 0]
        self._fingers = sim.model.jnt_qposadr[joints]

    @property
    def eef(self) -> Pose:
        """Pose of the grip site: x closes, z approaches."""
        data, site = self.data, self._site
        return Pose(data.site_xpos[site].copy(), data.site_xmat[site].reshape(3, 3).copy())

    @property
    def aperture(self) -> float:
        """Distance between the fingers in metres, 0 when closed."""
        first, second = self.data.qpos[self._fingers]
        return float(first - second)

    @property
    def base(self) -> Array:
        """Position (3,) of the arm's first joint's axis at its foot."""
        return np.array(self.data.xanchor[self.model.dof_jntid[self.sim.scene.arm.dof[0]]])

    def pose(self, entity: str) -> Pose:
        """Pose of an entity's root body; raises ``SIM001`` if there is none."""
        body = self.index.root_body(entity)
        return self.body_pose(body)

    def body_pose(self, body: int) -> Pose:
        """Pose of a body."""
        return Pose(self.data.xpos[body].copy(), self.data.xmat[body].reshape(3, 3).copy())

    def site_pose(self, site: str) -> Pose:
        """Pose of a site; raises ``SIM002`` if there is none."""
        number = self.index.site(site)
        return Pose(self.data.site_xpos[number].copy(), self.data.site_xmat[number].reshape(3, 3).copy())

    def site_half(self, site: str) -> Array:
        """Half extents (3,) of a site's box in its own frame."""
        return np.array(self.model.site_size[self.index.site(site)])

    def cloud(self, entity: str) -> Array:
        """Surface points (n, 3) of an entity in the world."""
        return self.points(self.index.bodies(entity))

    def points(self, bodies: Iterable[int]) -> Array:
        """Surface points (n, 3) of some bodies in the world."""
        parts = [np.empty((0, 3))]
        for body in bodies:
            local = self.shapes.of_body(int(body))
            if len(local):
                parts.append(local @ self.data.xmat[body].reshape(3, 3).T + self.data.xpos[body])
        return np.concatenate(parts)

    def surroundings(self, *without: str) -> Array:
        """Surface points (n, 3) of everything but the robot and the entities named."""
        left_out = {int(b) for name in without for b in self.index.bodies(name)}
        return self.points(b for b in self.shapes.bodies if not self.shapes.robot[b] and int(b) not in left_out)

    def near(self, points: Array, centre: Array, radius: float) -> Array:
        """Those of ``points`` within ``radius`` (metres, seen from above) of ``centre``."""
        return np.asarray(points[np.linalg.norm(points[:, :2] - centre[:2], axis=1) < radius])
