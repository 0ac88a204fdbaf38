"""An object that must not be where it is comes to stand at a free place, out of the way of what the goal speaks of."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from runtime.worlds.libero.skills.aside import free_spots
from tests.runtime.worlds.libero.skills.stages import staged

pytestmark = pytest.mark.sim

BOWL, PLATE = "akita_black_bowl_1", "plate_1"


def anywhere(_):
    return True


def test_a_free_spot_is_on_the_table_with_room_on_all_sides():
    world = staged("libero_goal", 8).world
    spots = free_spots(world, BOWL, anywhere)
    body = world.pose(BOWL)
    radius = np.linalg.norm((world.cloud(BOWL) - body.position)[:, :2], axis=1).max()
    others = np.concatenate([world.cloud(name) for name in world.index.entities if name != BOWL])
    assert len(spots) > 10
    for spot in spots:
        assert abs(spot.pose.position[2] - body.position[2]) < 0.01
        assert np.linalg.norm(others[:, :2] - spot.pose.position[:2], axis=1).min() > radius + 0.02
    assert [spot.cost for spot in spots] == sorted(spot.cost for spot in spots)


def test_the_ways_of_other_objects_are_kept_free_and_where_the_fact_is_false_no_spot_is():
    world = staged("libero_goal", 5).world
    start, end = world.pose(PLATE).position[:2], world.site_pose("main_table_stove_front_region").position[:2]

    def on_the_way(spots):
        line = start + np.linspace(0.0, 1.0, 50)[:, None] * (end - start)
        away = [np.linalg.norm(line - spot.pose.position[:2], axis=1).min() for spot in spots]
        return [distance for distance in away if distance < 0.11]

    assert on_the_way(free_spots(world, BOWL, anywhere))
    kept = free_spots(world, BOWL, anywhere, [(start, end)])
    assert kept
    assert not on_the_way(kept)
    assert free_spots(world, BOWL, lambda pose: pose.position[0] > 9.0) == []


def test_a_bowl_is_put_on_a_plate_and_taken_off_again():
    from runtime.worlds.libero.skills.play import Player

    stage = staged("libero_goal", 8)
    assert stage.player.reactive(stage.sim, 300).holds
    fact = stage.player.required.facts[0]
    off = replace(stage.player.required, facts=(replace(fact, polarity=False),))
    played = Player(stage.player.scene, off, stage.player.knowledge).reactive(stage.sim, 300)
    assert played.holds
    assert [(each.route, each.outcome) for each in played.tries] == [("pick_and_place", "held")]
    assert "set aside" in played.tries[0].note
    across = stage.world.pose(BOWL).position - stage.world.pose(PLATE).position
    assert np.linalg.norm(across[:2]) > 0.1


def test_a_grasp_is_not_tried_again_in_an_unchanged_scene(monkeypatch):
    from runtime.worlds.libero.skills.fault import SkillFault

    stage = staged("libero_goal", 8)
    skill = stage.player.skills["pick_and_place"]
    first = []

    class GivesUp:
        """Only the first plan of the skill, which does nothing and fails."""

        name = "gives_up"

        def candidates(self, request):
            for plan in skill.candidates(request):
                first.append(plan)
                yield Nothing(plan.poses)
                return

    class Nothing:
        note = "nothing"

        def __init__(self, poses):
            self.poses = poses

        def run(self, world, reach):
            raise SkillFault("lost", "on purpose")
            yield

    monkeypatch.setitem(stage.player.skills, "pick_and_place", GivesUp())
    played = stage.player.reactive(stage.sim, 80)
    poses = [pose.position for plan in first for pose in plan.poses]
    assert len(played.tries) > 1
    assert len({tuple(np.round(pose, 4)) for pose in poses}) == len(poses)
