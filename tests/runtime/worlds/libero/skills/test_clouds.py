"""Surface points of every type of geom lie on it, by MuJoCo's own distances and rays."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("mujoco")
pytestmark = pytest.mark.sim

VERTICES = "0 0 0  0.05 0 0  0 0.07 0  0 0 0.09  0.04 0.05 0.06"
GEOMS = {
    "box": 'type="box" size="0.03 0.05 0.02"',
    "sphere": 'type="sphere" size="0.04"',
    "cylinder": 'type="cylinder" size="0.03 0.05"',
    "capsule": 'type="capsule" size="0.02 0.05"',
    "ellipsoid": 'type="ellipsoid" size="0.02 0.03 0.05"',
    "mesh": 'type="mesh" mesh="shape"',
}
PAIR = '<geom name="{0}" {1} pos="{2}" quat="0.9 0.1 0.3 -0.2"/>'


def compiled(geoms):
    import mujoco

    asset = f'<asset><mesh name="shape" vertex="{VERTICES}"/></asset>'
    return mujoco.MjModel.from_xml_string(
        f'<mujoco>{asset}<worldbody><body name="thing" pos="0.3 -0.2 0.5">{geoms}</body></worldbody></mujoco>'
    )


def placed(model):
    import mujoco

    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data


def spread(points, count):
    """``count`` of the points, from all over the list."""
    return points[np.linspace(0, len(points) - 1, count).astype(int)]


@pytest.mark.parametrize("kind", GEOMS)
def test_every_point_lies_on_the_surface_by_mujoco_s_own_distance(kind):
    """A capsule is a cylinder and two balls, of which parts lie within it: of that, nothing lies outside."""
    import mujoco

    from runtime.worlds.libero.skills.clouds import geom_cloud

    tiny = 1e-4
    probe = f'<geom type="sphere" size="{tiny}" pos="1 0 0"/>'
    model = compiled(PAIR.format("g", GEOMS[kind], "0 0 0") + probe)
    data = placed(model)
    points = spread(geom_cloud(model, 0) @ data.geom_xmat[0].reshape(3, 3).T + data.geom_xpos[0], 400)
    assert len(points) == 400
    distances = []
    for point in points:
        data.geom_xpos[1] = point
        distances.append(mujoco.mj_geomDistance(model, data, 0, 1, 1.0, None) + tiny)
    assert max(distances) < 2e-4
    assert min(distances) > -2e-4 or kind == "capsule"


@pytest.mark.parametrize("kind", GEOMS)
def test_no_part_of_the_surface_is_far_from_every_point(kind):
    import mujoco

    from runtime.worlds.libero.skills.clouds import SPACING, geom_cloud

    model = compiled(PAIR.format("g", GEOMS[kind], "0 0 0"))
    data = placed(model)
    points = geom_cloud(model, 0) @ data.geom_xmat[0].reshape(3, 3).T + data.geom_xpos[0]
    middle = points.mean(axis=0)
    rng = np.random.default_rng(0)
    hit = np.zeros(1, dtype=np.int32)
    met = 0
    for _ in range(300):
        way = rng.normal(size=3)
        way /= np.linalg.norm(way)
        distance = mujoco.mj_ray(model, data, middle + 0.4 * way, -way, None, 1, -1, hit)
        if distance < 0:
            continue
        met += 1
        surface = middle + (0.4 - distance) * way
        assert np.linalg.norm(points - surface, axis=1).min() < 2 * SPACING
    assert met == 300


def test_a_plane_has_no_points():
    from runtime.worlds.libero.skills.clouds import geom_cloud

    assert geom_cloud(compiled('<geom type="plane" size="1 1 1"/>'), 0).shape == (0, 3)


def test_a_body_s_cloud_is_thinned_and_keeps_to_its_own_geoms():
    from runtime.worlds.libero.skills.clouds import THIN, body_cloud

    boxes = "".join(PAIR.format(n, GEOMS["box"], where) for n, where in (("a", "0 0 0"), ("b", "0.01 0 0")))
    model = compiled(boxes + PAIR.format("far", GEOMS["sphere"], "1 0 0"))
    cloud = body_cloud(model, 1, [0, 1])
    assert len(cloud) > 100
    assert cloud[:, 0].max() < 0.2
    cells = np.round(cloud / THIN).astype(int)
    assert len(np.unique(cells, axis=0)) == len(cloud)
    assert body_cloud(model, 0, [0, 1, 2]).shape == (0, 3)
    assert body_cloud(model, 1, [2]).mean(axis=0) == pytest.approx([1.0, 0.0, 0.0], abs=2e-3)
