from __future__ import annotations

import pytest

pytestmark = pytest.mark.sim

TASKS = [
    ("libero_goal", "open_the_middle_drawer_of_the_cabinet", 2),
    ("libero_goal", "turn_on_the_stove", 1),
    ("libero_90", "KITCHEN_SCENE10_close_the_top_drawer_of_the_cabinet", 1),
    ("libero_90", "KITCHEN_SCENE1_open_the_bottom_drawer_of_the_cabinet", 0),
    ("libero_90", "KITCHEN_SCENE7_open_the_microwave", 0),
    ("libero_90", "KITCHEN_SCENE8_turn_off_the_stove", 0),
]


@pytest.fixture(scope="module")
def knowledge():
    from onto_compiler.knowledge import load_knowledge

    return load_knowledge()


def opened(suite, task, state):
    from runtime.worlds.libero.simulator.assets import find_task, initial_states
    from runtime.worlds.libero.simulator.compiled import compile_scene
    from runtime.worlds.libero.simulator.simulation import Simulation

    ref = find_task(suite, task)
    sim = Simulation(compile_scene(ref.bddl))
    sim.reset_to(initial_states(ref)[state])
    sim.settle()
    return ref, sim


@pytest.mark.parametrize(("suite", "task", "state"), TASKS)
def test_a_joint_skill_makes_its_fact_true_and_leaves_it_so(suite, task, state, knowledge):
    from grounding.sim import SimGrounder
    from runtime.loop.diagnosis import unmet
    from runtime.worlds.libero.skills.articulate import joint_skills
    from runtime.worlds.libero.skills.reach import Reach
    from runtime.worlds.libero.skills.world import SkillWorld
    from runtime.worlds.required import required_of

    ref, sim = opened(suite, task, state)
    required = required_of(ref, knowledge)
    grounder = SimGrounder(sim.scene.index, required.facts, knowledge.schema)
    assert unmet(required, grounder.observe(sim.data)) == (0,)
    world = SkillWorld(sim)
    reach = Reach(world)
    skill = next(joint_skills(world, reach, knowledge.schema, required.facts[0]))
    before = sim.steps
    for action in skill.run(world, reach):
        sim.step(action)
    assert sim.steps - before < 130
    sim.settle(20)
    assert not unmet(required, grounder.observe(sim.data))
    assert not list(joint_skills(world, reach, knowledge.schema, required.facts[0]))


def test_a_fact_about_an_object_has_no_joint_skill(knowledge):
    from runtime.worlds.libero.skills.articulate import joint_skills
    from runtime.worlds.libero.skills.reach import Reach
    from runtime.worlds.libero.skills.world import SkillWorld
    from runtime.worlds.required import required_of

    ref, sim = opened("libero_goal", "put_the_bowl_on_the_stove", 0)
    world = SkillWorld(sim)
    fact = required_of(ref, knowledge).facts[0]
    assert not list(joint_skills(world, Reach(world), knowledge.schema, fact))


def test_a_drawer_is_opened_as_far_as_it_goes_for_what_is_put_in(knowledge):
    from runtime.worlds.libero.skills.articulate import widening_skills
    from runtime.worlds.libero.skills.reach import Reach
    from runtime.worlds.libero.skills.world import SkillWorld
    from runtime.worlds.required import required_of

    ref, sim = opened("libero_goal", "open_the_top_drawer_and_put_the_bowl_inside", 1)
    world = SkillWorld(sim)
    reach = Reach(world)
    fact = required_of(ref, knowledge).facts[0]
    assert fact.native.predicate == "In"
    first, *_ = candidates = list(widening_skills(world, reach, knowledge.schema, fact))
    drawer = sim.scene.model.joint("wooden_cabinet_1_top_level").qposadr[0]
    assert sim.data.qpos[drawer] == pytest.approx(0.0, abs=1e-3)
    others = list(widening_skills(world, reach, knowledge.schema, fact, [first.contact.pose]))
    assert 0 < len(others) < len(candidates)
    for action in first.run(world, reach):
        sim.step(action)
    assert sim.data.qpos[drawer] < -0.14
    assert not list(widening_skills(world, reach, knowledge.schema, fact))
