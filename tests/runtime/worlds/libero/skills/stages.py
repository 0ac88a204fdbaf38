"""Scenes for the tests of skills: a task in an official initial state, settled, with its player."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any


@dataclass(frozen=True)
class Stage:
    """A task's player, and the simulation that it plays in."""

    player: Any
    sim: Any

    @property
    def world(self):
        from runtime.worlds.libero.skills.world import SkillWorld

        return SkillWorld(self.sim, self.player.shapes)

    def place(self, index=0):
        """The place that fact ``index`` of the goal asks for."""
        from runtime.worlds.libero.scene.targets import place_of

        return place_of(self.player.scene.index, self.player.required.facts[index])

    def holds(self, index=0):
        """Whether fact ``index`` would be true with its object at a pose."""
        from runtime.worlds.libero.skills.order import GoalStep

        step = GoalStep(self.player.required.facts[index], index, precondition=False)
        return self.player._holds(self.world, step)


@cache
def player_of(suite, index):
    from onto_compiler.knowledge import load_knowledge
    from runtime.worlds.libero.simulator.assets import tasks
    from runtime.worlds.libero.simulator.compiled import compile_scene
    from runtime.worlds.libero.skills.play import Player
    from runtime.worlds.required import required_of

    ref, knowledge = tasks(suite)[index], load_knowledge()
    return ref, Player(compile_scene(ref.bddl), required_of(ref, knowledge, ordered=True), knowledge)


def staged(suite, index, state=0, kind=None):
    """A stage of its own; only scene and player are shared. ``kind`` is the class of the simulation."""
    from runtime.worlds.libero.simulator.assets import initial_states
    from runtime.worlds.libero.simulator.simulation import Simulation

    ref, player = player_of(suite, index)
    sim = (kind or Simulation)(player.scene)
    sim.reset_to(initial_states(ref)[state])
    sim.settle()
    return Stage(player, sim)
