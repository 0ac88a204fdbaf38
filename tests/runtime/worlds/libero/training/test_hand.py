"""What the model reads of the hand."""

import numpy as np
import pytest

from runtime.worlds.libero.training.hand import HIDDEN, SIZE, sensed
from runtime.worlds.libero.training.heads import sensed_still


def test_the_axes_are_those_of_the_turn_and_do_not_jump_where_the_vector_does():
    turn = np.array([[0.0, 0.0, np.pi / 2], [np.pi - 1e-6, 0.0, 0.0], [-np.pi + 1e-6, 0.0, 0.0], [0.0, 0.0, 0.0]])
    found = sensed(np.zeros((4, 3)), turn, np.zeros((4, 2)))
    assert found[0, 3:9] == pytest.approx([0, 1, 0, -1, 0, 0], abs=1e-6)
    assert found[1, 3:9] == pytest.approx(found[2, 3:9], abs=1e-5)
    assert found[3, 3:9] == pytest.approx([1, 0, 0, 0, 1, 0])


def test_speeds_are_of_the_step_before_in_units_a_second():
    position = np.array([[0.0, 0, 0], [0.01, 0, 0], [0.01, 0.02, 0]])
    fingers = np.array([[0.04, -0.04], [0.03, -0.03], [0.03, -0.03]])
    found = sensed(position, np.zeros((3, 3)), fingers)
    assert found.shape == (3, SIZE)
    assert found[0, -HIDDEN:].tolist() == [0.0] * HIDDEN
    assert found[1, -HIDDEN:] == pytest.approx([0.2, 0, 0, -0.2, 0.2])
    assert found[2, -HIDDEN:] == pytest.approx([0, 0.4, 0, 0, 0], abs=1e-9)


def test_without_a_sense_of_speed_the_rest_is_left():
    assert sensed_still(SIZE).tolist() == [True] * (SIZE - HIDDEN) + [False] * HIDDEN
