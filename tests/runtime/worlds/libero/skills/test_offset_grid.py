from __future__ import annotations

import numpy as np
import pytest

pytestmark = pytest.mark.sim


@pytest.mark.parametrize(("side", "along"), [((0.1, 0.6), (0, 1)), ((-0.5, 0.2), (-1, 0)), ((0.0, -1.0), (0, -1))])
def test_the_grid_lies_on_the_side_of_the_landmark_that_is_asked_for(side, along):
    from runtime.worlds.libero.skills.offset_grid import ASIDE, AWAY, offsets

    grid = list(offsets(np.array(side)))
    assert len(grid) == len(AWAY) * len(ASIDE) == 9
    for (away, aside), offset in grid:
        assert offset[2] == 0.0
        assert offset[:2] @ along == pytest.approx(away)
        assert np.linalg.norm(offset) == pytest.approx(np.hypot(away, aside))


def test_it_goes_straight_first_and_from_far_to_near():
    from runtime.worlds.libero.skills.offset_grid import offsets

    names = [name for name, _ in offsets(np.array([0.0, 1.0]))]
    assert names[:3] == [(0.4, 0.0), (0.3, 0.0), (0.2, 0.0)]
