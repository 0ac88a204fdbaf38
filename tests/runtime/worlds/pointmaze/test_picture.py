"""What is drawn of the maze, and that the ball's place can be read from it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from onto_compiler.problems import OntoError
from runtime.worlds.pointmaze.maze import MAZES
from runtime.worlds.pointmaze.picture import draw

pytestmark = pytest.mark.sim

U_MAZE = MAZES["u_maze"]
PLACE = st.floats(0.4, 3.2)


def read(maze, picture):
    """The ball's place in metres, from how far each pixel is from the empty maze."""
    size = len(picture)
    empty = draw(maze, np.array([[50.0, 50.0]]), size)[0]
    weight = np.abs(picture.astype(float) - empty).sum(axis=2)
    # Each pixel's background differs: what counts is the part of it that the ball covers.
    ball = np.array([0.3, 0.6, 0.3]) * 255
    weight /= np.abs(ball - empty).sum(axis=2)
    rows, columns = np.mgrid[:size, :size] + 0.5
    low_x, low_y, high_x, high_y = maze.extent
    scale = max(high_x - low_x, high_y - low_y) / size
    return (
        low_x + (weight * columns).sum() / weight.sum() * scale,
        high_y - (weight * rows).sum() / weight.sum() * scale,
    )


@pytest.mark.parametrize("size", [32, 64, 224])
@settings(deadline=None)  # the first picture compiles
@given(x=PLACE, y=PLACE)
def test_the_balls_place_is_read_to_a_tenth_of_a_pixel(size, x, y):
    found = read(U_MAZE, draw(U_MAZE, np.array([[x, y]]), size)[0])
    assert found == pytest.approx((x, y), abs=0.1 * 5 / size)


def test_colours_are_those_of_the_published_scene():
    picture = draw(U_MAZE, np.array([[0.8, 0.8, 1.0, 1.0]]), 64)[0]
    assert picture.dtype == np.uint8
    assert picture[0, 0].tolist() == [179, 128, 77]  # a wall
    across, down = int((0.8 + 0.7) / 5 * 64), int((4.3 - 0.8) / 5 * 64)
    assert picture[down, across].tolist() == [77, 153, 77]  # the ball
    assert sorted({tuple(colour) for colour in picture.reshape(-1, 3).tolist()})[:1] == [(26, 51, 77)]  # the plane


def test_a_picture_shows_positions_only():
    still, moving = draw(U_MAZE, np.array([[0.8, 0.8, 0, 0], [0.8, 0.8, 5, -5]]))
    assert np.array_equal(still, moving)


def test_x_runs_to_the_right_and_y_upwards():
    x, y = read(U_MAZE, draw(U_MAZE, np.array([[2.9, 0.6]]))[0])
    assert x > 2.5
    assert y < 1
    picture = draw(U_MAZE, np.array([[2.9, 0.6]]))[0].astype(int)
    green = (picture[..., 1] > picture[..., 0] + 40) & (picture[..., 1] > picture[..., 2] + 40)
    rows, columns = np.nonzero(green)
    assert rows.mean() > 32
    assert columns.mean() > 32


def test_a_ball_out_of_the_picture_is_not_drawn():
    far, edge, empty = draw(U_MAZE, np.array([[1e6, 0.0], [-0.7, 4.3], [-5.0, 0.0]]))
    assert np.array_equal(far, empty)
    assert not np.array_equal(edge, empty)


@pytest.mark.parametrize("name", sorted(MAZES))
def test_every_maze_is_drawn_whole(name):
    maze = MAZES[name]
    (low_x, low_y, high_x, high_y), pictures = maze.extent, draw(maze, maze.centres, 96)
    if high_x - low_x == high_y - low_y:
        assert [read(maze, picture) for picture in pictures] == [
            pytest.approx(place, abs=0.01) for place in maze.centres
        ]
    assert len({picture.tobytes() for picture in pictures}) == len(maze.centres)
    colours = {tuple(colour) for colour in draw(maze, maze.centres[:1], 96)[0].reshape(-1, 3).tolist()}
    assert {(179, 128, 77), (77, 153, 77)} <= colours


def test_pictures_of_nothing_are_none():
    assert draw(U_MAZE, np.empty((0, 4))).shape == (0, 64, 64, 3)


@pytest.mark.parametrize(
    ("states", "size", "code"),
    [
        (np.zeros(4), 64, "PMZ003"),
        (np.zeros((2, 1)), 64, "PMZ003"),
        (np.zeros((2, 4)), 0, "PMZ003"),
        (np.array([[np.nan, 0.0]]), 64, "PMZ004"),
    ],
)
def test_what_cannot_be_drawn_is_refused(states, size, code):
    with pytest.raises(OntoError) as caught:
        draw(U_MAZE, states, size)
    assert [problem.code for problem in caught.value.problems] == [code]
