"""The fixtures' poses in a demonstration, from its window record or its ``model_file``."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import numpy as np

from onto_compiler.problems import OntoError, near
from runtime.worlds.fixtures import FixturePoses, poses_in
from runtime.worlds.fixtures import fixtures_of as fixtures_of_mjcf
from runtime.worlds.libero.demos.read import load
from runtime.worlds.libero.demos.records import Demonstration
from runtime.worlds.snapshot import check_scene, identity

__all__ = ["fixtures_of", "fixtures_of_demo"]

_FILE = re.compile(r"(?P<file>.+\.(hdf5|h5))(/(?P<demo>[^/]+))?", re.IGNORECASE)


def fixtures_of(source: str, model: mujoco.MjModel) -> FixturePoses:
    """The poses of the fixtures of ``model`` in a file: MJCF, or demonstrations in HDF5 (``FILE.hdf5/demo_3`` is one).

    Raises:
        OntoError: ``SIM023`` if the file does not say them, or its demonstrations say several; ``DEM001``,
            ``DEM002``, ``DEM004`` for an HDF5 file; ``SIM004`` for a window record of another scene.
    """
    match = _FILE.fullmatch(source)
    if match is None:
        return fixtures_of_mjcf(Path(source), model)
    file, name = match["file"], match["demo"]
    demos = load(file).demos
    names = [demo.name for demo in demos]
    if name is not None and name not in names:
        raise OntoError.of("SIM023", f"the file holds no `{name}`", near(name, names), file)
    found = [fixtures_of_demo(demo, model, file) for demo in demos if name in {None, demo.name}]
    first, *others = found
    if first is None or any(other is None for other in others):
        message = "the file has neither window records nor the attribute `model_file`, which say where fixtures stand"
        raise OntoError.of("SIM023", message, "give the MJCF of its scene, or the seed of its reset", file)
    if any(other is not None and not np.array_equal(first.body_pos, other.body_pos) for other in others):
        message = f"the {len(demos)} demonstrations were recorded with the fixtures in different places"
        raise OntoError.of("SIM023", message, f"name one of them, such as {file}/{names[0]}", file)
    return first


def fixtures_of_demo(demo: Demonstration, model: mujoco.MjModel, file: str) -> FixturePoses | None:
    """Where the fixtures of ``model`` stood in ``demo``; None if it does not say. Raises ``SIM023``, ``SIM004``."""
    if demo.start is not None:
        check_scene(demo.start, model, identity(model))
        return FixturePoses(demo.start.body_pos, demo.start.body_quat)
    return poses_in(demo.model_file, model, file) if demo.model_file.strip() else None
