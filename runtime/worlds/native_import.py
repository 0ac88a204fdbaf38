"""Prepares the import of robosuite and packages built on it: no rendering, no warnings, nothing on stdout."""

from __future__ import annotations

import contextlib
import importlib
import logging
import os
import sys
import types
import warnings
from collections.abc import Iterator
from typing import Any

import mujoco

__all__ = ["before_robosuite", "quiet"]

NO_PICTURES = "disabled"
_LOG = logging.getLogger("onto_evwm.mujoco")


def before_robosuite() -> None:
    """Configure logging and rendering before robosuite is imported; ``MUJOCO_GL`` defaults to ``disabled``."""
    os.environ.setdefault("MUJOCO_GL", NO_PICTURES)
    logging.getLogger("robosuite_logs").addFilter(_not_about_macros)
    _spare_opencv()
    mujoco.set_mju_user_warning(_LOG.warning)  # it would write MUJOCO_LOG.TXT into the working folder


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Send what the native code prints to stderr, and drop its deprecation warnings: stdout belongs to our own data."""
    with contextlib.redirect_stdout(sys.stderr), warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        warnings.simplefilter("ignore", UserWarning)
        yield


def _spare_opencv() -> None:
    """Replace OpenCV if its system library (libGL) is missing: robosuite uses it only for windows, and opens none.

    Calling it for a picture then raises an error that says what to install.
    """
    try:
        importlib.import_module("cv2")
    except ImportError as error:
        reason = f"OpenCV cannot be loaded ({error}); for pictures: apt-get install libgl1 libegl-mesa0"

        def missing(name: str) -> Any:  # noqa: ANN401  whatever the caller wanted
            if name.startswith("__"):
                raise AttributeError(name)
            raise ImportError(reason)

        module = types.ModuleType("cv2", "Stands in for OpenCV, which cannot be loaded here.")
        module.__getattr__ = missing  # type: ignore[method-assign]
        sys.modules["cv2"] = module


def _not_about_macros(record: logging.LogRecord) -> bool:
    """Suppress robosuite's warning about a missing file of personal settings, which is optional."""
    return "macro" not in record.getMessage()
