"""Other actions from the middle of a demonstration."""

import numpy as np

from runtime.worlds.libero.training.altered import KINDS, LENGTH, altered


def demonstration():
    actions = np.random.default_rng(5).uniform(-1, 1, size=(110, 7))
    actions[:, 6] = -1.0
    actions[40:90, 6] = 1.0
    return actions


def many():
    actions = demonstration()
    return actions, [altered(actions, np.random.default_rng([7, number])) for number in range(200)]


def test_a_demonstration_is_left_at_a_mark_before_its_end_and_its_own_rest_is_not_what_follows():
    actions, found = many()
    assert {kind for _, kind, _ in found} == set(KINDS)
    for left, _, future in found:
        assert left % 5 == 0
        assert 0 <= left < len(actions)
        assert future.shape == (LENGTH, 7)
        assert np.abs(future).max() <= 1.0
    same = [np.array_equal(future[: len(actions) - left], actions[left : left + LENGTH]) for left, _, future in found]
    assert np.mean(same) < 0.1  # fingers that open where they were open anyway


def test_half_of_them_are_left_shortly_before_the_fingers_move():
    _, found = many()
    near = [any(0 <= move - left < 45 for move in (40, 90)) for left, _, _ in found]
    assert np.mean(near) > 0.6


def test_the_same_seed_gives_the_same_actions():
    actions = demonstration()
    one, other = (altered(actions, np.random.default_rng(3)) for _ in range(2))
    assert one[:2] == other[:2]
    assert np.array_equal(one[2], other[2])


def test_a_short_demonstration_can_be_left_too():
    left, _, future = altered(np.ones((4, 7)), np.random.default_rng(0))
    assert left == 0
    assert future.shape == (LENGTH, 7)
