"""What the index and the ontology say of LIBERO's assets, against what LIBERO's own classes say."""

from __future__ import annotations

import math

import numpy as np
import pytest

pytestmark = pytest.mark.sim

SUITES = ("libero_goal", "libero_spatial", "libero_object", "libero_10")
METHODS = {"Open": "is_open", "Close": "is_close", "Turnon": "turn_on", "Turnoff": "turn_off"}


@pytest.fixture(scope="module")
def assets():
    """Asset category -> LIBERO's class."""
    import importlib

    from runtime.worlds.libero.simulator.native_import import control_env

    control_env()
    return importlib.import_module("libero.libero.envs.base_object").OBJECTS_DICT


@pytest.fixture(scope="module")
def thresholds(assets, schema):
    """What is declared of LIBERO's assets; other worlds have assets of their own."""
    found = {key: threshold for key, threshold in schema.thresholds.items() if key[0] in assets}
    assert set(schema.thresholds) - set(found) == {("door", "Open")}
    return found


def built(assets, category):
    return assets[category](name=f"{category}_1", joints=None)


def decides(asset, native):
    """Whether LIBERO's class defines the test behind ``native``."""
    method = getattr(asset, METHODS[native], None)
    if method is None:
        return False
    try:
        method(0.0)
    except NotImplementedError:
        return False
    return True


def test_every_joint_threshold_is_what_the_asset_itself_decides(assets, thresholds):
    checked = 0
    for (category, native), threshold in thresholds.items():
        asset = built(assets, category)
        for qpos in (
            threshold.bound,
            math.nextafter(threshold.bound, math.inf),
            math.nextafter(threshold.bound, -math.inf),
            *np.linspace(-3, 3, 61),
        ):
            beyond = qpos > threshold.bound if threshold.above else qpos < threshold.bound
            expected = beyond or (threshold.inclusive and qpos == threshold.bound)
            assert bool(getattr(asset, METHODS[native])(qpos)) is bool(expected), (category, native, qpos)
            checked += 1
        assert threshold.every_joint is (native in {"Close", "Turnoff"})
    assert checked == 64 * len(thresholds)


def test_every_asset_that_can_open_or_turn_has_its_thresholds_declared(assets, thresholds):
    articulated = [
        category
        for category, asset in assets.items()
        if any(callable(getattr(asset, m, None)) for m in METHODS.values())
    ]
    decided = {(c, native) for c in articulated for native in METHODS if decides(built(assets, c), native)}
    assert decided == set(thresholds)
    assert len(decided) == 16


@pytest.mark.parametrize("suite", SUITES)
def test_the_index_of_every_scene_is_libero_s_own(suite):
    from grounding.scenes import Scene
    from runtime.worlds.libero.simulator.assets import tasks
    from runtime.worlds.libero.simulator.native import NativeTask

    compared = 0
    assert len(tasks(suite)) == 10
    for ref in tasks(suite):
        with NativeTask.open(ref) as native:
            env, model = native.env, native.model
            scene = Scene(model)
            things = {**env.fixtures_dict, **env.objects_dict}
            assert set(scene.entities) == set(things)
            for name, thing in things.items():
                assert model.body(scene.root_body(name)).name == thing.root_body
                assert {model.geom(int(g)).name for g in scene.contact_geoms(name)} == set(thing.contact_geoms)
                assert [model.joint(int(j)).name for j in scene.joints(name)] == list(thing.joints)
                compared += 1
            for name, region in env.object_sites_dict.items():
                assert scene.site_parent(name) == region.parent_name
                assert [model.joint(int(j)).name for j in scene.joints(name)] == list(region.joints or ())
                assert np.array_equal(model.site_size[scene.site(name)], np.asarray(region.size, dtype=np.float64))
                compared += 1
    assert compared >= 100


@pytest.mark.parametrize(
    ("predicate", "slides", "expected"),
    [
        ("Open", (-0.15, 0.0, 0.0), True),
        ("Open", (-0.13, -0.13, -0.13), False),
        ("Close", (0.001, 0.001, 0.001), True),
        ("Close", (0.001, 0.001, -0.001), False),
    ],
)
def test_a_whole_cabinet_is_open_by_any_drawer_and_closed_by_all(schema, predicate, slides, expected):
    from grounding.scenes import Scene
    from grounding.sim import SimGrounder
    from onto_compiler.required import Entity, Fact, NativeAtom
    from runtime.worlds.libero.simulator.assets import find_task
    from runtime.worlds.libero.simulator.native import NativeTask

    threshold = schema.thresholds["wooden_cabinet", predicate]
    atom = NativeAtom(predicate, ("wooden_cabinet_1",))
    fact = Fact("urn:p", (Entity("wooden_cabinet_1", ""), Entity("t", threshold.iri)), atom, "joint_threshold")
    with NativeTask.open(find_task("libero_goal", 0)) as native:
        scene = Scene(native.model)
        qpos = native.data.qpos.copy()
        qpos[native.model.jnt_qposadr[scene.joints("wooden_cabinet_1")]] = slides
        native.write_qpos(qpos)
        assert native.evaluate(atom) is expected
        assert SimGrounder(scene, [fact], schema).observe(native.data).truth.tolist() == [expected]


def test_the_gap_between_objects_is_the_smallest_over_all_their_boxes():
    import mujoco

    from grounding.predicates.boxes import box_distance
    from grounding.predicates.contact import ContactTerm
    from grounding.scenes import Scene
    from runtime.worlds.libero.simulator.assets import find_task
    from runtime.worlds.libero.simulator.native import NativeTask

    rng = np.random.default_rng(3)
    with NativeTask.open(find_task("libero_goal", 9)) as native:
        model, data, scene = native.model, native.data, Scene(native.model)
        contact = ContactTerm(scene, "wine_bottle_1", "wine_rack_1")
        geoms = [scene.contact_geoms(name) for name in ("wine_bottle_1", "wine_rack_1")]
        assert all((model.geom_type[ids] == mujoco.mjtGeom.mjGEOM_BOX).all() for ids in geoms)
        apart = 0
        for _ in range(25):
            qpos = data.qpos.copy()
            pose = qpos[scene.qpos_slice(scene.free_joint("wine_bottle_1"))]
            pose[:3] = data.xpos[scene.root_body("wine_rack_1")] + rng.uniform([-0.2, -0.2, 0.0], [0.2, 0.2, 0.4])
            pose[3:] = rng.normal(size=4)
            native.write_qpos(qpos)
            term = contact(data)
            if term.holds:
                continue
            first, second = (
                [(data.geom_xpos[g], data.geom_xmat[g].reshape(3, 3), model.geom_size[g]) for g in ids] for ids in geoms
            )
            assert term.margin == pytest.approx(-min(box_distance(a, b) for a in first for b in second), abs=1e-6)
            apart += 1
        assert apart >= 10
