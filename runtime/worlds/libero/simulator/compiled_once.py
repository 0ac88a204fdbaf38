"""Let robosuite compile each scene only once: repeated requests get copies of one model.

LIBERO compiles when it makes an environment and again at every reset that builds the scene anew, and the tasks of one
room differ in no word of their MJCF. A copy takes a third of the time, and is equal to the last bit. A scene that is
not drawn is compiled without its textures (:func:`without_textures`): reading them takes most of the time, and they are
up to two thirds of a model.
"""

from __future__ import annotations

import contextlib
import copy
import importlib
import os
import re
from collections.abc import Callable, Iterator
from contextvars import ContextVar
from functools import partial
from typing import Any

import mujoco

from runtime.worlds.fixtures import FixturePoses

__all__ = ["SceneCompiler", "install", "with_textures", "without_textures"]

_FILES = re.compile(r'file="([^"]+)"')
_WRITTEN = ("body_pos", "body_quat", "site_rgba")  # by LIBERO, after a scene was compiled
_BARE: ContextVar[bool] = ContextVar("bare", default=False)
Compiler = Callable[[str], mujoco.MjModel]
Key = tuple[str, bool, tuple[tuple[int, int], ...]]


class SceneCompiler:
    """MJCF to models. The last one is kept as it was compiled, with the size and time of each file that it names."""

    def __init__(self) -> None:
        self._key: Key | None = None
        self._model: mujoco.MjModel | None = None

    def __call__(self, xml: str) -> mujoco.MjModel:
        """A model of the caller's own; raises what ``mujoco.MjModel.from_xml_string`` does."""
        bare = _BARE.get()
        key = _key(xml, bare=bare)
        if key is None:
            return mujoco.MjModel.from_xml_string(xml)
        if key != self._key:
            self._key = self._model = None  # two are never held at once: each may take hundreds of megabytes
            self._model = _without_textures(xml) if bare else mujoco.MjModel.from_xml_string(xml)
            self._key = key
        return copy.copy(self._model)


@contextlib.contextmanager
def without_textures() -> Iterator[None]:
    """Within it scenes are compiled without their textures, which changes nothing that moves."""
    token = _BARE.set(True)
    try:
        yield
    finally:
        _BARE.reset(token)


def with_textures(
    xml: str, model: mujoco.MjModel, compiler: Compiler = mujoco.MjModel.from_xml_string
) -> mujoco.MjModel:
    """Another model of ``xml`` with its textures, and with what LIBERO has written into ``model``."""
    whole = compiler(xml)
    for name in _WRITTEN:
        getattr(whole, name)[:] = getattr(model, name)
    return whole


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
    whole = with_textures(xml, wrapper._model)  # noqa: SLF001  robosuite wraps the model and gives no other access
    text: str = type(wrapper).get_xml(type(wrapper)(whole))
    return text


def _without_textures(xml: str) -> mujoco.MjModel:
    spec = mujoco.MjSpec.from_string(xml)
    for material in spec.materials:
        material.textures = [""] * len(material.textures)
    for texture in list(spec.textures):
        spec.delete(texture)
    return spec.compile()


def _key(xml: str, *, bare: bool) -> Key | None:
    """What the model depends on; None if a file is not there, of which MuJoCo says more."""
    try:
        found = [os.stat(name) for name in dict.fromkeys(_FILES.findall(xml))]  # noqa: PTH116  half the time of Path's
    except OSError:
        return None
    return xml, bare, tuple((status.st_size, status.st_mtime_ns) for status in found)
