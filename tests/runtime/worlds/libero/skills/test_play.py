"""Episodes on the compiled simulation: in order, within the horizon, the next way after a fault, and repeatable."""

from __future__ import annotations

import numpy as np
import pytest

from runtime.loop.faults import RunFault
from tests.runtime.worlds.libero.skills.stages import staged

pytestmark = pytest.mark.sim

BOWL = "akita_black_bowl_1"


def outcomes(played):
    return [each.outcome for each in played.tries]


def test_a_bowl_is_picked_and_placed():
    stage = staged("libero_goal", 8)
    played = stage.player.reactive(stage.sim, 300)
    assert played.holds
    assert outcomes(played) == ["held"]
    assert played.tries[0].route == "pick_and_place"
    assert sum(each.steps for each in played.tries) == len(played.actions)
    assert np.abs(played.actions).max() <= 1.0
    assert played.rehearsed == 0


def test_a_plate_is_slid_with_open_fingers():
    stage = staged("libero_goal", 5, 1)
    played = stage.player.reactive(stage.sim, 300)
    assert played.holds
    assert played.tries[0].note.startswith("push")
    assert (played.actions[:, 6] == -1.0).all()


def test_a_drawer_is_opened_first_and_the_bowl_pulled_out_from_under_it(monkeypatch):
    from runtime.worlds.libero.simulator.simulation import Simulation
    from runtime.worlds.libero.skills import pick

    ways = []
    way_out = pick.way_out

    def seen(cloud, around):
        ways.append(way_out(cloud, around))
        return ways[-1]

    class Followed(Simulation):
        """Keeps where the bowl was."""

        def __init__(self, scene):
            self.path = []
            super().__init__(scene)

        def step(self, action, before_last_substep=None):
            super().step(action, before_last_substep)
            self.path.append(self.data.xpos[self.scene.index.root_body(BOWL)].copy())

    monkeypatch.setattr(pick, "way_out", seen)
    stage = staged("libero_goal", 3, kind=Followed)
    assert len(stage.player.required.facts) == 1  # the goal does not name the drawer
    played = stage.player.reactive(stage.sim, 300)
    assert played.holds
    assert [each.route for each in played.tries] == ["move_joint", "pick_and_place"]
    assert outcomes(played) == ["held", "held"]
    assert "wooden_cabinet_open" in played.tries[0].fact
    assert np.linalg.norm(ways[-1]) >= 0.02
    away = np.array(stage.sim.path) - stage.sim.path[0]
    risen = np.argmax(away[:, 2] > 0.03)
    assert risen > 0
    assert np.linalg.norm(away[risen, :2]) > 0.8 * np.linalg.norm(ways[-1])


def test_a_drawer_is_filled_and_what_leans_in_it_pressed_down_before_it_is_shut(monkeypatch):
    from runtime.worlds.libero.skills import transfer

    lies_flat = []
    press = transfer.press

    def seen(*arguments):
        lies_flat.append((yield from press(*arguments)))
        return lies_flat[-1]

    monkeypatch.setattr(transfer, "press", seen)
    stage = staged("libero_10", 3, 12)
    played = stage.player.reactive(stage.sim, 520)
    assert played.holds
    assert lies_flat == [True]
    facts = [each.fact.split("(")[0] for each in played.tries]
    assert facts[0] == "inside"
    assert facts[-1] == "joint_state"
    assert outcomes(played)[-1] == "held"


def test_the_same_episode_is_the_same_actions_bit_for_bit():
    runs = []
    for _ in range(2):
        stage = staged("libero_goal", 8, 2)
        runs.append(stage.player.reactive(stage.sim, 300))
    assert len(runs[0].actions) > 50
    assert np.array_equal(runs[0].actions, runs[1].actions)
    assert runs[0].tries == runs[1].tries


def test_looking_ahead_leaves_the_real_simulation_alone_until_it_acts():
    from runtime.worlds.libero.simulator.simulation import Simulation

    class Watched(Simulation):
        """Keeps the state after each step, and what it was at the next."""

        def __init__(self, scene):
            self.left, self.met = [], []
            super().__init__(scene)

        def step(self, action, before_last_substep=None):
            self.met.append(self.snapshot().integration)
            super().step(action, before_last_substep)
            self.left.append(self.snapshot().integration)

    stage = staged("libero_goal", 3, kind=Watched)
    start = stage.sim.left[-1]
    stage.sim.met.clear()
    stage.sim.left.clear()
    played = stage.player.lookahead(stage.sim, 300, 2)
    assert played.holds
    assert played.rehearsed > len(played.actions) > 0
    assert len(stage.sim.met) == len(played.actions)
    assert np.array_equal(stage.sim.met, [start, *stage.sim.left[:-1]])


@pytest.mark.parametrize("horizon", [1, 45])
@pytest.mark.parametrize("play", ["reactive", "lookahead"])
def test_the_horizon_is_never_exceeded(play, horizon):
    stage = staged("libero_goal", 8)
    before = stage.sim.steps
    played = getattr(stage.player, play)(stage.sim, horizon)
    assert len(played.actions) == stage.sim.steps - before == horizon
    assert outcomes(played) == ["horizon"]
    assert played.tries[0].steps == horizon
    assert played.left == ()
    assert not played.holds


class Breaking:
    """The house's skill, whose first plan gives up after some steps, having done ``harm`` to the simulation."""

    name = "breaking"

    def __init__(self, skill, harm=lambda world: None, *, fault=None):
        self.skill, self.harm, self.requests, self.plans = skill, harm, [], []
        self.fault = fault

    def candidates(self, request):
        self.requests.append(request)
        first = len(self.requests) == 1
        for plan in self.skill.candidates(request):
            self.plans.append(plan)
            yield Broken(plan, self) if first else plan


class Broken:
    def __init__(self, plan, by):
        self.poses, self.note, self._by = plan.poses, "gives up", by

    def run(self, world, reach):
        from runtime.worlds.libero.skills.fault import SkillFault

        for _ in range(4):
            yield np.array([0.0, 0.0, 0.2, 0.0, 0.0, 0.0, -1.0])
        self._by.harm(world)
        raise self._by.fault or SkillFault("lost", "on purpose")


def broken(monkeypatch, stage, **options):
    skills = stage.player.skills
    skill = Breaking(skills["pick_and_place"], **options)
    monkeypatch.setitem(skills, "pick_and_place", skill)
    return skill


def far_away(world):
    """The bowl has rolled off, where no arm reaches."""
    where = world.index.qpos_slice(world.index.free_joint(BOWL))
    world.data.qpos[where][:2] = (2.0, 2.0)
    world.sim.settle(1)


def test_after_a_fault_another_grasp_is_tried(monkeypatch):
    from runtime.worlds.libero.skills.pick import alike

    stage = staged("libero_goal", 8)
    skill = broken(monkeypatch, stage)
    played = stage.player.reactive(stage.sim, 300)
    assert played.holds
    assert outcomes(played) == ["lost", "held"]
    assert [each.reason for each in played.tries] == ["on purpose", ""]
    assert [each.candidate for each in played.tries] == [1, 2]
    assert list(skill.requests[1].tried) == list(skill.plans[0].poses)
    assert not alike(skill.plans[0].poses[0], skill.plans[1].poses[0])


def test_an_object_out_of_reach_ends_the_episode_with_its_tries_recorded(monkeypatch):
    stage = staged("libero_goal", 8)
    skill = broken(monkeypatch, stage, harm=far_away)
    played = stage.player.reactive(stage.sim, 300)
    assert outcomes(played) == ["lost"]
    assert len(skill.requests) == 3  # what was tried counts no more before it gives up
    assert 0 < len(played.actions) < 60
    assert not played.holds


def test_an_object_that_was_never_in_reach_ends_it_without_an_action():
    stage = staged("libero_goal", 8)
    far_away(stage.world)
    played = stage.player.reactive(stage.sim, 300)
    assert played.tries == ()
    assert [str(step) for step in played.left] == [f"On({BOWL}, plate_1)"]
    assert played.actions.shape == (0, 7)
    assert not played.holds


def test_a_state_that_diverges_ends_the_episode_with_its_record(monkeypatch):
    stage = staged("libero_goal", 8)
    broken(monkeypatch, stage, fault=RunFault("on purpose", None))
    played = stage.player.reactive(stage.sim, 300)
    assert len(played.tries) == 1
    assert len(played.actions) == 4
    assert not played.holds
