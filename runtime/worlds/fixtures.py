"""Fixture poses, which LIBERO's flat state lacks: read from MJCF, and how far LIBERO may place them elsewhere.

LIBERO draws the poses of fixtures (a stove, a cabinet) at every reset and writes them into the compiled model, so that
a state of time, qpos and qvel fits several scenes. MJCF that was saved from the model, such as the attribute
``model_file`` of LIBERO's demonstrations, holds them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
from numpy.typing import NDArray

from onto_compiler.bddl.ast import Region, TaskSpec
from onto_compiler.problems import OntoError

__all__ = ["FixturePoses", "Freedom", "fixtures_of", "freedoms", "poses_in"]

_POSE = ("name", "pos", "quat", "euler", "axisangle", "xyaxes", "zaxis")
_ANGLES = ("angle", "eulerseq")
_PRINTED = 1e-5  # MJCF is saved with six digits
_HINT = "give the MJCF that was saved from the same task, or the seed of its reset"


@dataclass(frozen=True, slots=True, eq=False)
class FixturePoses:
    """The pose of every body in its parent's frame: ``body_pos`` (nbody, 3) in metres, ``body_quat`` (nbody, 4) wxyz.

    Fixtures are children of the world body. A body with a free joint is placed by qpos, whatever its body pose.
    """

    body_pos: NDArray[np.float64]
    body_quat: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Freedom:
    """The largest difference of two placements of a fixture: ``shift`` in metres in the plane, ``turn`` in radians."""

    shift: float
    turn: float = 0.0


def poses_in(mjcf: str, model: mujoco.MjModel, file: str = "") -> FixturePoses:
    """The poses of the fixtures in ``mjcf``, and of everything else in ``model``; no asset is opened.

    A pose that ``mjcf`` gives to the precision of its digits stays as ``model`` has it. Raises ``SIM023`` if
    ``mjcf`` cannot be read, or lacks a fixture or object of ``model``; ``file`` is named then.
    """
    other = _skeleton(mjcf, file)
    pos, quat = model.body_pos.copy(), model.body_quat.copy()
    for body in range(1, model.nbody):
        if model.body_parentid[body] != 0:
            continue
        name = model.body(body).name
        found = mujoco.mj_name2id(other, mujoco.mjtObj.mjOBJ_BODY, name)
        if found < 0:
            raise OntoError.of("SIM023", f"the model file is of another scene: it has no body `{name}`", _HINT, file)
        if model.body_jntnum[body] == 0:
            pos[body] = _exact(pos[body], other.body_pos[found])
            quat[body] = _exact(quat[body], other.body_quat[found])
    return FixturePoses(pos, quat)


def fixtures_of(path: Path, model: mujoco.MjModel) -> FixturePoses:
    """The poses of the fixtures of ``model`` that the MJCF file ``path`` holds; raises ``SIM023``."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise OntoError.of("SIM023", f"the model file cannot be read: {error}", _HINT, str(path)) from error
    return poses_in(text, model, str(path))


def freedoms(spec: TaskSpec) -> Mapping[str, Freedom]:
    """How far LIBERO's reset may move each fixture that the task places in a region of table or floor."""
    fixtures = {declared.name for declared in spec.fixtures}
    regions = {region.site: region for region in spec.regions}
    placed = ((a.arguments[0].name, a.arguments[1].name) for a in spec.init if len(a.arguments) == 2)
    return {name: _freedom(regions[where]) for name, where in placed if name in fixtures and where in regions}


def _freedom(region: Region) -> Freedom:
    if not region.ranges:
        return Freedom(0.0)
    corners = np.array(region.ranges).reshape(-1, 2)
    low, high = region.yaw or (0.0, 0.0)
    return Freedom(float(np.linalg.norm(np.ptp(corners, axis=0))), min(abs(high - low), math.pi))


def _exact(known: NDArray[np.float64], parsed: NDArray[np.float64]) -> NDArray[np.float64]:
    return known if np.allclose(known, parsed, rtol=_PRINTED, atol=1e-9) else parsed


def _skeleton(mjcf: str, file: str) -> mujoco.MjModel:
    """Only the bodies of ``mjcf``, compiled, so that MuJoCo parses every notation of a pose."""
    try:
        root = ET.fromstring(mjcf)  # noqa: S314  expat limits what entities expand to, and opens no file
    except ET.ParseError as error:
        raise OntoError.of("SIM023", f"the model file is not XML: {error}", _HINT, file) from error
    world = root.find("worldbody")
    if root.tag != "mujoco" or world is None:
        raise OntoError.of("SIM023", "the model file is not MJCF: it has no bodies", _HINT, file)
    bare = ET.Element("mujoco")
    given = root.find("compiler")
    kept = {} if given is None else {name: given.attrib[name] for name in _ANGLES if name in given.attrib}
    ET.SubElement(bare, "compiler", kept)
    _copy_bodies(world, ET.SubElement(bare, "worldbody"))
    try:
        # Through a spec: robosuite writes the last model that was loaded from a string when it is asked for a scene's.
        return mujoco.MjSpec.from_string(ET.tostring(bare, encoding="unicode")).compile()
    except ValueError as error:
        raise OntoError.of("SIM023", f"MuJoCo cannot read the model file's bodies: {error}", _HINT, file) from error


def _copy_bodies(source: ET.Element, target: ET.Element) -> None:
    for child in _bodies(source):
        pose = {name: child.attrib[name] for name in _POSE if name in child.attrib}
        _copy_bodies(child, ET.SubElement(target, child.tag, pose))


def _bodies(element: ET.Element) -> Iterator[ET.Element]:
    return (child for child in element if child.tag in {"body", "frame"})
