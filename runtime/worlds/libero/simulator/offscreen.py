"""Pictures of a state as arrays, as LIBERO's offscreen renderer draws them, whatever ``MUJOCO_GL`` was at import.

MuJoCo settles how it draws when it is first imported, often by somebody else and with pictures disabled. Here the
OpenGL context is made directly, through EGL or OSMesa. Source of what is shown: robosuite 1.4.0
``utils/binding_utils.py`` (``MjRenderContext``) and LIBERO's defaults (visual geometry without collision geometry).
"""

from __future__ import annotations

import atexit
import importlib
import os
import weakref
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from onto_compiler.closing import Closing
from onto_compiler.problems import OntoError, near
from runtime.worlds.pictures import backend, cannot_render

__all__ = ["Offscreen"]

_GEOMS = 1000  # robosuite's limit
_OPEN: weakref.WeakSet[Offscreen] = weakref.WeakSet()
_DREW_FIRST: list[int] = []  # the process that did, which a forked one inherits
_FAST_OFF = (mujoco.mjtRndFlag.mjRND_SHADOW, mujoco.mjtRndFlag.mjRND_REFLECTION)


class Offscreen(Closing):
    """Draws states of one model, in an OpenGL context of its own."""

    def __init__(self, model: mujoco.MjModel, height: int, width: int, *, fast: bool = False) -> None:
        """Set up drawing and upload the textures, in a second or less.

        ``fast`` leaves out shadows, reflections and multisampling; it changes ``model.vis``. Raises ``SIM031`` if
        this machine cannot draw, and ``SIM032`` in a process that was forked from one that has drawn.
        """
        self._model, self._rect = model, mujoco.MjrRect(0, 0, width, height)
        size = model.vis.global_
        size.offwidth, size.offheight = max(size.offwidth, width), max(size.offheight, height)
        if fast:
            model.vis.quality.offsamples = 0
        self._gl: Any = _context(width, height)
        _OPEN.add(self)
        self._gl.make_current()
        self._context: Any = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_150)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._scene = mujoco.MjvScene(model, maxgeom=_GEOMS)
        for flag in _FAST_OFF if fast else ():
            self._scene.flags[flag] = 0
        self._options, self._grip = mujoco.MjvOption(), mujoco.MjvPerturb()
        self._options.geomgroup[0], self._options.geomgroup[1] = 0, 1
        self._camera = mujoco.MjvCamera()
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FIXED

    def camera(self, name: str) -> int:
        """The id of camera ``name``; raises ``SIM030`` if there is none."""
        found: int = mujoco.mj_name2id(self._model, mujoco.mjtObj.mjOBJ_CAMERA, name)
        if found < 0:
            names = [self._model.camera(i).name for i in range(self._model.ncam)]
            raise OntoError.of(
                "SIM030", f"the scene has no camera `{name}`", near(name, names) or f"it has {', '.join(names)}"
            )
        return found

    def draw(self, data: mujoco.MjData, camera: int) -> NDArray[np.uint8]:
        """An RGB picture (height, width, 3) with its lowest row first, as OpenGL and LIBERO have it."""
        self._camera.fixedcamid = camera
        self._gl.make_current()
        mujoco.mjv_updateScene(
            self._model, data, self._options, self._grip, self._camera, mujoco.mjtCatBit.mjCAT_ALL, self._scene
        )
        mujoco.mjr_render(self._rect, self._scene, self._context)
        picture = np.empty((self._rect.height, self._rect.width, 3), dtype=np.uint8)
        mujoco.mjr_readPixels(picture, None, self._rect, self._context)
        return picture

    def close(self) -> None:
        """Free the OpenGL context; allowed more than once."""
        _OPEN.discard(self)
        if self._gl is not None:
            self._gl.make_current()
            self._context.free()
            self._gl.free()
        self._gl = self._context = None


def _close_all() -> None:
    for screen in tuple(_OPEN):
        screen.close()


def _context(width: int, height: int) -> Any:  # noqa: ANN401  one class per backend, untyped
    found = backend()
    if found is None:
        raise cannot_render()
    if _DREW_FIRST and _DREW_FIRST[0] != os.getpid():
        message = "OpenGL was in use in the process that this one was forked from, and would hang here"
        raise OntoError.of("SIM032", message, 'start workers with context="spawn", or draw in the workers only')
    made = importlib.import_module(f"mujoco.{found}").GLContext(width, height)
    if not _DREW_FIRST:
        _DREW_FIRST.append(os.getpid())
        atexit.register(_close_all)  # after EGL's own bindings, and so before them at exit: it ends there
    return made
