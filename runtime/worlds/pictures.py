"""Pictures of a state without a display: OpenGL through EGL or OSMesa, if the machine has one of them."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from functools import cache

import numpy as np

from onto_compiler.closing import Closing
from onto_compiler.problems import OntoError

__all__ = ["ADVICE", "Camera", "Cameras", "backend", "cannot_render", "enable"]

ADVICE = "for pictures: apt-get install libegl-mesa0 libgl1 (or libosmesa6)"
_BACKENDS = ("egl", "osmesa")
_PROBE = "import mujoco; mujoco.GLContext(8, 8).make_current()"
_PROBE_SECONDS = 20
_SIZE = (288, 384)  # pixels, height and width
_QUALITY = 88
_NOT_COMPARED = ("_", "body_pos", "body_quat", "site_", "tex_data", "mesh_")  # sites are never shown


def enable() -> bool:
    """Choose MuJoCo's rendering backend; False if none works. To be called before MuJoCo is imported.

    A broken driver can end a process, so another process tries each backend first. A ``MUJOCO_GL`` that is set is kept.
    """
    if "MUJOCO_GL" in os.environ or "mujoco" in sys.modules:
        return os.environ.get("MUJOCO_GL", "disabled").lower() in {*_BACKENDS, "glfw"}
    found = backend()
    if found is not None:
        os.environ.update(_choice(found))
    return found is not None


@cache
def backend() -> str | None:
    """``egl`` or ``osmesa``, the first that works here, or the one that ``MUJOCO_GL`` names; None if neither works.

    It works whether or not MuJoCo was already imported, also with rendering disabled.
    """
    named = os.environ.get("MUJOCO_GL", "").lower()
    if named in _BACKENDS:
        return named
    return next((name for name in _BACKENDS if _works({**os.environ, **_choice(name)})), None)


def cannot_render() -> OntoError:
    """``SIM031``, for where :func:`backend` finds none."""
    return OntoError.of("SIM031", "this machine cannot render pictures, neither by EGL nor by OSMesa", ADVICE)


def _choice(name: str) -> dict[str, str]:
    return {"MUJOCO_GL": name, "PYOPENGL_PLATFORM": name}


def _works(environment: dict[str, str]) -> bool:
    command = [sys.executable, "-c", _PROBE]
    try:
        done = subprocess.run(  # noqa: S603 - our own program
            command, env=environment, capture_output=True, check=False, timeout=_PROBE_SECONDS
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


class Camera(Closing):
    """Renders states of one model from a camera of its scene, without shadows and collision geometry."""

    def __init__(self, model: object, name: str = "agentview") -> None:
        """Set up drawing for ``model``, a ``mujoco.MjModel``; takes about a second, for the textures."""
        import mujoco  # noqa: PLC0415 - only once its backend was chosen

        self._model = model
        self._renderer = mujoco.Renderer(model, *_SIZE)
        self._name = name
        self._options = mujoco.MjvOption()
        self._options.geomgroup[0] = 0
        self._options.sitegroup[:] = 0
        self._off = (mujoco.mjtRndFlag.mjRND_SHADOW, mujoco.mjtRndFlag.mjRND_REFLECTION)

    def shoot(self, data: object) -> bytes:
        """A JPEG of ``data``, a ``mujoco.MjData`` of the same model."""
        from PIL import Image  # noqa: PLC0415 - comes with the simulator

        self._renderer.update_scene(data, camera=self._name, scene_option=self._options)
        for flag in self._off:
            self._renderer.scene.flags[flag] = 0
        buffer = io.BytesIO()
        Image.fromarray(np.asarray(self._renderer.render())).save(buffer, "JPEG", quality=_QUALITY)
        return buffer.getvalue()

    def draws(self, model: object) -> bool:
        """Whether this camera can also render states of ``model``: it differs at most in its body poses.

        A state sets every body pose, so those of the model are not used. Of meshes and textures, which are hundreds of
        megabytes, only file names and sizes are compared.
        """
        return all(_same(getattr(self._model, name), getattr(model, name)) for name in _drawn(self._model))

    def close(self) -> None:
        """Free what drawing takes; allowed more than once."""
        self._renderer.close()


def _drawn(model: object) -> list[str]:
    """Names of the members of ``model`` that decide how it looks."""
    return [name for name in dir(model) if not name.startswith(_NOT_COMPARED)]


def _same(first: object, second: object) -> bool:
    """Whether two members of models are equal; True for what is neither array, bytes nor number."""
    if isinstance(first, np.ndarray) and isinstance(second, np.ndarray):
        return np.array_equal(first, second, equal_nan=first.dtype.kind == "f")
    return first == second if isinstance(first, bytes | int) else True


class Cameras(Closing):
    """A camera for successive scenes, reused if it can render the next scene too."""

    def __init__(self) -> None:
        self._last: Camera | None = None

    def of(self, model: object) -> Camera:
        """A camera for states of ``model``, open until the next call."""
        if self._last is None or not self._last.draws(model):
            self.close()
            self._last = Camera(model)
        return self._last

    def close(self) -> None:
        """Free what drawing takes; allowed more than once."""
        if self._last is not None:
            self._last.close()
            self._last = None
