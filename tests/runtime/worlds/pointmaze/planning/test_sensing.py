"""What a planner knows of the maze, and of which facts that is any evidence."""

from __future__ import annotations

import pytest

from grounding.world_model.encoder import encoder
from onto_compiler.knowledge import load_knowledge
from onto_compiler.schema import local_name
from runtime.worlds.pointmaze.grounded import required_facts
from runtime.worlds.pointmaze.maze import maze_named
from runtime.worlds.pointmaze.planning.sensing import FULL, POSITION, Sensor

pytestmark = pytest.mark.sim


@pytest.mark.parametrize(
    ("sensed", "unseen"),
    [
        (FULL, set()),
        (POSITION, {"velocity_matches"}),
        ((False, False, True, True), set()),  # pictures show places
        ((True, True, True, False), {"velocity_matches"}),
    ],
)
def test_of_a_velocity_that_is_not_sensed_there_is_no_evidence(sensed, unseen):
    knowledge = load_knowledge()
    facts = required_facts(knowledge).facts
    sensor = Sensor(maze_named("u_maze"), encoder("pixels:4"), sensed, 3)
    observed = sensor.observes(facts, knowledge.schema)
    names = [local_name(fact.predicate) for fact in facts]
    assert {name for name, seen in zip(names, observed, strict=True) if not seen} == unseen
    assert "velocity_matches" in names
