"""MuJoCo's own C functions, callable from numba without Python in between.

``libmujoco`` is already in the process when the ``mujoco`` package is imported; here its symbols are made known to
LLVM. They stay symbols in the compiled code, so that numba's cache on disk is valid in the next process. Model and data
are passed as addresses (``MjModel._address``, ``MjData._address``).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import llvmlite.binding
import mujoco
from numba.core import types

from onto_compiler.problems import OntoError

__all__ = ["mj_jac_site", "mj_step1", "mj_step2"]


def _load() -> None:
    folder = Path(mujoco.__file__).parent
    found = sorted(p for p in folder.iterdir() if p.name.startswith(("libmujoco", "mujoco.dll")))
    if not found:
        raise OntoError.of("SIM010", f"no MuJoCo library beside {mujoco.__name__}", "reinstall mujoco", str(folder))
    llvmlite.binding.load_library_permanently(str(found[0]))


_load()
_POINTER = types.uint64
mj_step1: Any = types.ExternalFunction("mj_step1", types.void(_POINTER, _POINTER))
mj_step2: Any = types.ExternalFunction("mj_step2", types.void(_POINTER, _POINTER))
mj_jac_site: Any = types.ExternalFunction("mj_jacSite", types.void(_POINTER, _POINTER, _POINTER, _POINTER, types.int32))
