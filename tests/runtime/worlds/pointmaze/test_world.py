"""PointMaze as a world: trials are initial states, the published success judges, and plans are corrected."""

import json

import pytest

from onto_compiler.command import CLEAN, FINDINGS, MISUSE
from onto_compiler.knowledge import load_knowledge
from runtime.cli import main
from runtime.worlds.pointmaze.trials import trial
from runtime.worlds.pointmaze.verdict import judge
from runtime.worlds.pointmaze.world import WORLD
from runtime.worlds.required import required_of
from runtime.worlds.world import named_task

pytestmark = pytest.mark.sim


@pytest.fixture(scope="module")
def opened():
    world, ref = named_task("pointmaze/u_maze")
    assert world is WORLD
    knowledge = load_knowledge()
    return world.open(ref, required_of(ref, knowledge), knowledge.schema, 0)


def test_each_trial_is_judged_as_published(opened):
    verdicts = set()
    for number in range(WORLD.initial_states(named_task("pointmaze/0")[1])):
        opened.start(number)
        wanted = bool(judge(trial(number).start, trial(number).goal).success)
        assert opened.verify().outcome is wanted
        assert bool(opened.observe().truth[0]) is wanted
        verdicts.add(wanted)
    assert verdicts == {True, False}


def test_the_commands_open_it_and_repair_says_who_corrects_it(capsys):
    assert main(["ground", "pointmaze/u_maze", "--state", "3", "--json"]) == CLEAN
    record = json.loads(capsys.readouterr().out)
    assert [fact["predicate"] for fact in record["facts"]] == ["at_target", "velocity_matches", "free_of"]
    assert main(["diagnose", "pointmaze", "0", "--state", "3", "--json"]) == FINDINGS
    found = json.loads(capsys.readouterr().out)["diagnoses"]
    assert [(row["failure"], row["route"]) for row in found] == [
        ("missing_entity_on_target", "longer_horizon"),
        ("velocity_mismatch", "match_velocity"),
    ]
    assert main(["repair", "pointmaze/0", "--state", "3"]) == MISUSE
    assert "error[RUN004]" in capsys.readouterr().err
    assert main(["ground", "pointmaze/0", "--state", "50"]) == MISUSE
    assert "it has 50 trials, from 0" in capsys.readouterr().err
