"""Let robosuite compile each scene only once: repeated requests get copies of one model.

LIBERO compiles when it makes an environment and again at every reset that builds the scene anew, and the tasks of one
room differ in no word of their MJCF. A copy takes a third of the time, and is equal to the last bit.
"""

from __future__ import annotations

import copy
import importlib
import os
import re
from functools import partial
from typing import Any

import mujoco

from runtime.worlds.fixtures import FixturePoses

__all__ = ["SceneCompiler", "install"]

_FILES = re.compile(r'file="([^"]+)"')
Key = tuple[str, tuple[tuple[int, int], ...]]


class SceneCompiler:
    """MJCF to models. The last one is kept as it was compiled, with the size and time of each file that it names."""

    def __init__(self) -> None:
        self._key: Key | None = None
        self._model: mujoco.MjModel | None = None

    def __call__(self, xml: str) -> mujoco.MjModel:
        """A model of the caller's own; raises what ``mujoco.MjModel.from_xml_string`` does."""
        key = _key(xml)
        if key is None:
            return mujoco.MjModel.from_xml_string(xml)
        if key != self._key:
            self._key = self._model = None  # two are never held at once: each may take hundreds of megabytes
            self._model = mujoco.MjModel.from_xml_string(xml)
            self._key = key
        return copy.copy(self._model)


def install() -> None:
    """After the import of robosuite: let its simulations take their models from one :class:`SceneCompiler`.

    Each model then also says where its bodies stood before anything was placed: ``compiled_poses``.
    """
    simulation = importlib.import_module("robosuite.utils.binding_utils").MjSim
    compiler = SceneCompiler()

    def from_xml_string(cls: Any, xml: str) -> Any:  # noqa: ANN401  an untyped package's class
        model = compiler(xml)
        made = cls(model)
        made.model.get_xml = partial(_saved, xml, made.model)
        made.model.compiled_poses = FixturePoses(model.body_pos.copy(), model.body_quat.copy())
        return made

    simulation.from_xml_string = classmethod(from_xml_string)


def _saved(xml: str, wrapper: Any) -> str:  # noqa: ANN401  as above
    """The MJCF of a model as it is now; MuJoCo saves what it loaded last, so that it is loaded again."""
    mujoco.MjModel.from_xml_string(xml)
    text: str = type(wrapper).get_xml(wrapper)
    return text


def _key(xml: str) -> Key | None:
    """What the model depends on; None if a file is not there, of which MuJoCo says more."""
    try:
        found = [os.stat(name) for name in dict.fromkeys(_FILES.findall(xml))]  # noqa: PTH116  half the time of Path's
    except OSError:
        return None
    return xml, tuple((status.st_size, status.st_mtime_ns) for status in found)
