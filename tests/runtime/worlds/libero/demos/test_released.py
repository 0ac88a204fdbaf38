from __future__ import annotations

import numpy as np
import pytest

pytestmark = pytest.mark.sim


def test_an_object_between_the_fingers_is_not_let_go_and_one_on_the_table_is(ref):
    from runtime.worlds.libero.demos.released import Released
    from runtime.worlds.libero.simulator.assets import initial_states
    from runtime.worlds.libero.simulator.compiled import compile_scene
    from runtime.worlds.libero.simulator.simulation import Simulation

    simulation = Simulation(compile_scene(ref.bddl))
    released = Released(simulation.model)
    simulation.reset_to(initial_states(ref)[0])
    simulation.settle()
    assert released(simulation.data)
    state = simulation.flat_state
    index = simulation.scene.index
    joint = index.free_joint("cream_cheese_1")
    place = index.qpos_slice(joint)
    state[1 + place.start : 4 + place.start] = simulation.data.geom("gripper0_finger1_pad_collision").xpos
    simulation.reset_to(state)
    assert not released(simulation.data)
    state[3 + place.start] += 0.5
    simulation.reset_to(np.array(state))
    assert released(simulation.data)
