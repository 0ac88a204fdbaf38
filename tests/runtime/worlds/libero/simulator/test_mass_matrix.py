"""robosuite's controller computes the same, to the last bit, whichever way its mass matrix lies in memory."""

import numpy as np
import pytest

pytestmark = pytest.mark.sim


def test_the_layout_of_the_mass_matrix_changes_no_bit():
    from runtime.worlds.libero.simulator.native_import import control_env

    control_env()
    from robosuite.controllers import osc
    from robosuite.utils.control_utils import opspace_matrices

    rng = np.random.default_rng(0)
    for _ in range(20):
        half, jacobian = rng.normal(size=(7, 7)), rng.normal(size=(6, 7))
        matrix = half @ half.T + np.eye(7)
        parts = jacobian, jacobian[:3].copy(), jacobian[3:].copy()
        plain = opspace_matrices(np.ascontiguousarray(matrix), *parts)
        for given in (np.ascontiguousarray(matrix), np.asfortranarray(matrix)):
            assert all(map(np.array_equal, osc.opspace_matrices(given, *parts), plain))
