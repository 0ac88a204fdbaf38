"""The attributes by which LIBERO's tools know a file of demonstrations and its scene, without a path of this machine.

Source: LIBERO ``scripts/collect_demonstration.py`` and ``scripts/create_dataset.py``.
"""

from __future__ import annotations

import importlib
import json
import re
from collections.abc import Mapping
from typing import Any

from runtime.worlds.libero.demos.records import IMAGES
from runtime.worlds.libero.simulator.assets import TaskRef
from runtime.worlds.libero.simulator.native import NativeTask
from runtime.worlds.native_import import quiet

__all__ = ["SIZE", "describe", "portable"]

SIZE = 128  # pixels, as in LIBERO's files
_FILE = re.compile(r'(?<=file=")([^"]+)(?=")')


def describe(ref: TaskRef, *, images: bool) -> tuple[dict[str, Any], str]:
    """Attributes of the group ``data``, and the scene as MJCF with the fixtures where they stand.

    Builds the native environment, in some seconds; raises as
    :class:`~runtime.worlds.libero.simulator.native.NativeTask`.
    """
    with NativeTask.open(ref) as task, quiet():
        environment: str = type(task.env).__name__
        model = portable(task.env.sim.model.get_xml())
        problem = importlib.import_module("libero.libero.envs.bddl_utils").get_problem_info(str(ref.bddl))
        controller = importlib.import_module("robosuite.controllers").load_controller_config(
            default_controller="OSC_POSE"
        )
    bddl = f"libero/libero/bddl_files/{ref.suite}/{ref.bddl.name}"
    return {
        "bddl_file_content": ref.bddl.read_text(encoding="utf-8"),
        "bddl_file_name": bddl,
        "env_args": json.dumps(_arguments(environment, bddl, controller, images=images), sort_keys=True),
        "env_name": environment,
        "macros_image_convention": "opengl",
        "problem_info": json.dumps(problem, sort_keys=True),
    }, model


def portable(xml: str) -> str:
    """``xml`` with the paths of assets from their package on, as LIBERO's ``postprocess_model_xml`` looks for them."""
    return _FILE.sub(lambda match: _from_package(match[1]), xml)


def _from_package(path: str) -> str:
    parts = path.replace("\\", "/")
    _, robosuite, after = parts.rpartition("/robosuite/")
    if robosuite:
        return f"robosuite/{after}"
    _, assets, after = parts.rpartition("/assets/")
    return f"libero/libero/assets/{after}" if assets else parts


def _arguments(environment: str, bddl: str, controller: Mapping[str, Any], *, images: bool) -> dict[str, Any]:
    arguments = {
        "robots": ["Panda"],
        "controller_configs": controller,
        "bddl_file_name": bddl,
        "has_renderer": False,
        "has_offscreen_renderer": images,
        "use_camera_obs": images,
        "ignore_done": True,
        "reward_shaping": True,
        "control_freq": 20,
        "camera_names": list(IMAGES.values()),
        "camera_heights": SIZE,
        "camera_widths": SIZE,
        "camera_depths": False,
        "camera_segmentations": None,
    }
    # robomimic's number for robosuite
    return {
        "type": 1,
        "env_name": environment,
        "problem_name": environment.lower(),
        "bddl_file": bddl,
        "env_kwargs": arguments,
    }
