"""Figures of plans say what their numbers say."""

from __future__ import annotations

import re

import numpy as np
import pytest

from runtime.report.horizon import margin_chart
from runtime.report.reliability import reliability, reliability_diagram


def test_predictions_that_hold_as_often_as_they_say_have_no_error():
    score = np.repeat([0.25, 0.75], 4)
    held = np.array([1, 0, 0, 0, 1, 1, 1, 0], dtype=bool)
    found = reliability(score, held)
    assert found.error == pytest.approx(0.0)
    assert found.count.tolist() == [4, 4]
    assert found.share.tolist() == [0.25, 0.75]


def test_the_error_is_the_mean_gap_weighted_by_count():
    found = reliability(np.array([0.95, 0.95, 0.95, 0.05]), np.array([False, False, True, False]))
    assert found.error == pytest.approx((3 * abs(0.95 - 1 / 3) + 0.05) / 4)


def test_a_score_of_one_is_in_the_last_bin_and_nothing_has_no_error():
    assert reliability(np.array([1.0]), np.array([True])).score.tolist() == [1.0]
    assert np.isnan(reliability(np.empty(0), np.empty(0, bool)).error)


def test_a_diagram_has_a_disc_for_each_bin():
    found = reliability(np.array([0.05, 0.5, 0.51, 0.9]), np.array([False, True, False, True]))
    assert reliability_diagram(found, "told").count('class="bin"') == len(found.count) == 3


def test_a_chart_shows_every_predicted_margin_at_its_step_and_height():
    true = np.linspace(-1, 1, 11)
    chart = margin_chart(true, [(np.array([5, 10]), np.array([0.0, 1.0]))], "m", "told")
    points = [tuple(map(float, pair)) for pair in re.findall(r'class="guess" cx="([\d.]+)" cy="([\d.]+)"', chart)]
    line = re.search(r'class="executed" points="([^"]+)"', chart)[1].split()
    way = [tuple(map(float, point.split(","))) for point in line]
    assert points == [way[5], way[10]]
    assert 'aria-label="told"' in chart


@pytest.mark.sim
def test_a_maze_shows_the_ways_with_y_upwards():
    from runtime.worlds.pointmaze.drawing import Way, maze_drawing
    from runtime.worlds.pointmaze.maze import maze_named

    maze = maze_named("u_maze")
    start, goal = np.array([0.8, 0.8, 0.0, 0.0]), np.array([2.8, 0.8, 1.0, 0.0])
    ways = [Way(np.stack([start, goal]), np.stack([[start, goal]] * 3))]
    drawn = maze_drawing(maze, start, goal, ways, "told")
    assert drawn.count('class="wall"') == len(maze.wall_boxes)
    assert drawn.count('class="imagined"') == 3
    low, higher = (
        float(re.search(r'class="begin" cx="[\d.]+" cy="([\d.]+)"', maze_drawing(maze, state, goal, (), "told"))[1])
        for state in (start, np.add(start, [0, 1, 0, 0]))
    )
    assert higher < low
