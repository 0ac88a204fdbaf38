"""The pictures of an environment: which cameras, how large, and which row comes first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, TypeAlias

import mujoco
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from onto_compiler.problems import OntoError
from runtime.worlds.libero.simulator.offscreen import Offscreen

__all__ = ["CAMERAS", "Convention", "Views"]

CAMERAS = ("agentview", "robot0_eye_in_hand")
Convention: TypeAlias = Literal["opengl", "opencv"]  # robosuite's names for which row comes first


class Views:
    """Pictures ``CAMERA_image`` of one model, as uint8 (height, width, 3).

    OpenGL is set up at the first picture, since it does not survive a fork: a vector environment makes one environment
    in its own process, to learn its spaces, and forks the others.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        cameras: Sequence[str],
        size: tuple[int, int],
        convention: Convention,
        *,
        fast: bool,
    ) -> None:
        """Choose; raises ``SIM030`` for a size or convention that makes no sense."""
        if convention not in {"opengl", "opencv"}:
            raise OntoError.of("SIM030", f"there is no image convention `{convention}`", "it is opengl or opencv")
        if len(size) != 2 or min(size) < 1:
            raise OntoError.of("SIM030", f"the image size is {size}", "it is a height and a width in pixels")
        self._model, self._size, self._fast = model, size, fast
        self._row = 1 if convention == "opengl" else -1
        self._cameras = tuple(cameras)
        self._screen: Offscreen | None = None
        self.spaces: dict[str, spaces.Space[NDArray[Any]]] = {
            f"{name}_image": spaces.Box(0, 255, (*size, 3), np.uint8) for name in self._cameras
        }

    def look(self, data: mujoco.MjData) -> dict[str, NDArray[Any]]:
        """A picture of every camera."""
        return {f"{name}_image": np.ascontiguousarray(self.draw(data, name)[:: self._row]) for name in self._cameras}

    def draw(self, data: mujoco.MjData, camera: str) -> NDArray[np.uint8]:
        """One picture, lowest row first; raises ``SIM030`` for an unknown camera, ``SIM031`` and ``SIM032``."""
        if self._screen is None:
            self._screen = Offscreen(self._model, *self._size, fast=self._fast)
        return self._screen.draw(data, self._screen.camera(camera))

    def close(self) -> None:
        """Free the renderer; the next picture creates it again."""
        if self._screen is not None:
            self._screen.close()
        self._screen = None
