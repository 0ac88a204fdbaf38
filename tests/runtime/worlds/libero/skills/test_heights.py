"""What is lowered from above comes to rest where brute force says that it does."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.worlds.libero.skills.heights import CELL, relief_of, underside

cells = st.lists(st.tuples(st.integers(-6, 6), st.integers(-6, 6), st.floats(-0.2, 0.2)), min_size=1, max_size=40).map(
    lambda rows: np.array([((i + 0.5) * CELL, (j + 0.5) * CELL, z) for i, j, z in rows])
)


def columns(points, shift=(0, 0)):
    """Every point as (cell, z), the cells shifted."""
    where = np.floor(points[:, :2] / CELL + 1e-6).astype(int) + shift
    return [(tuple(cell), z) for cell, z in zip(where.tolist(), points[:, 2], strict=True)]


@given(cells, cells, st.integers(-5, 5), st.integers(-5, 5))
def test_the_drop_is_the_first_touch_of_any_two_points_in_one_column(below, above, i, j):
    touches = [b - a for c, b in columns(below) for d, a in columns(above, (i, j)) if c == d]
    under, corner = underside(above)
    relief = relief_of(below, np.zeros(3), 0.12)
    assert relief.drop(under, corner + CELL * np.array([i, j])) == pytest.approx(max(touches, default=-np.inf))


@given(st.floats(0.02, 0.06), st.floats(0.01, 0.05), st.floats(0.0, 0.3))
def test_a_box_comes_to_rest_on_another_at_the_sum_of_their_half_heights(half, upper, level):
    side = np.arange(-half, half + 1e-9, 0.5 * CELL)
    x, y = (axis.ravel() for axis in np.meshgrid(side, side))
    top = np.column_stack([x, y, np.full(x.size, level)])
    bottom = np.column_stack([0.5 * x, 0.5 * y, np.full(x.size, -upper)])
    under, corner = underside(bottom)
    assert relief_of(top, np.zeros(3), 0.12).drop(under, corner) == pytest.approx(level + upper)


@given(st.floats(0.02, 0.06))
def test_a_shape_over_nothing_comes_to_rest_nowhere(gap):
    below = np.array([[0.0, 0.0, 0.1]])
    above = np.array([[0.0, 0.0, 0.0]])
    under, corner = underside(above)
    relief = relief_of(below, np.zeros(3), 0.10)
    assert relief.drop(under, corner + gap) == -np.inf
    assert relief.drop(under, corner + 5.0) == -np.inf
    assert relief.drop(under, corner) == pytest.approx(0.1)
