"""The laws of proposals and LIBERO's own verdict, on official initial states of some tasks."""

from __future__ import annotations

import numpy as np
import pytest

from onto_compiler.bddl.lift import required_abox
from onto_compiler.bddl.parse import parse_file
from onto_compiler.compile_schema import load_schema
from onto_compiler.schema import local_name
from runtime.loop.proposer import Request
from runtime.loop.records import Diagnosis
from runtime.loop.registry import load_proposers
from runtime.worlds.libero.loop.environment import NativeEnvironment
from runtime.worlds.libero.simulator.assets import find_task, initial_states
from runtime.worlds.libero.simulator.native import NativeTask
from tests.runtime.worlds.libero.proposers import conftest as scenes

pytestmark = pytest.mark.sim

CASES = {
    "drawer opened and filled": ("libero_goal", 3, ("object_relation_predicate",)),
    "region that the table shares": ("libero_goal", 5, ("source_joint_pose",)),
    "rack": ("libero_goal", 9, ("rack_contact_site",)),
    "two objects on one burner": ("libero_10", 8, ("object_relation_predicate",) * 2),
}


@pytest.fixture(scope="module", params=CASES)
def episode(request):
    """States and proposals of one task, one fact after the other, with the verdicts in between."""
    suite, index, routes = CASES[request.param]
    ref, schema = find_task(suite, index), load_schema()
    required = required_abox(parse_file(ref.bddl), schema, ref.name)
    proposers = load_proposers(schema)
    steps = []
    with NativeTask.open(ref, 0) as task:
        environment = NativeEnvironment(task, required, schema)
        task.reset_to(initial_states(ref)[0])
        task.settle(10)
        for route in routes:
            seen = environment.observe()
            fact = int(np.flatnonzero(~seen.truth)[0])
            diagnosis = Diagnosis(
                required.facts[fact], fact, "f", "s", False, float(seen.margin[fact]), "", "sim", "r", 10
            )
            qpos = environment.qpos

            def ask(candidate, qpos=qpos, diagnosis=diagnosis, route=route):
                rng = np.random.default_rng(0)
                request = Request(
                    environment.scene,
                    qpos,
                    environment.qvel,
                    required,
                    diagnosis,
                    candidate,
                    environment.observe_at,
                    rng,
                )
                return proposers[route].propose(request)

            first, again, second = ask(0), ask(0), ask(1)
            environment.apply(first)
            steps.append((qpos, first, again, second, environment.observe().truth.copy(), fact))
        accepted = task.success()
        task.settle(20)
        yield task.model, steps, accepted, task.success()


def test_four_tasks_of_three_routes_are_covered():
    assert len(CASES) == 4
    assert len({route for *_, routes in CASES.values() for route in routes}) == 3


def test_the_native_predicate_accepts_and_still_does_after_settling(episode):
    _, _, accepted, settled = episode
    assert accepted
    assert settled


def test_each_proposal_satisfies_its_fact_and_keeps_those_before(episode):
    _, steps, _, _ = episode
    met = []
    for *_, truth, fact in steps:
        met.append(fact)
        assert truth[met].all()


def test_proposals_list_what_they_change_and_repeat(episode):
    _, steps, _, _ = episode
    for qpos, first, again, second, _, _ in steps:
        assert np.array_equal(np.flatnonzero(first.qpos != qpos), first.changed)
        assert np.array_equal(first.qpos, again.qpos)
        assert not np.array_equal(first.qpos, second.qpos)


def test_proposals_stay_within_the_limits_of_joints(episode):
    model, steps, _, _ = episode
    hinges = np.flatnonzero(model.jnt_limited)
    for qpos, first, *_ in steps:
        for joint in hinges:
            address = model.jnt_qposadr[joint]
            if first.qpos[address] != qpos[address]:
                low, high = model.jnt_range[joint]
                assert low <= first.qpos[address] <= high


def test_proposals_cause_no_overlap_deeper_than_a_millimetre(episode):
    model, steps, _, _ = episode
    for qpos, first, *_ in steps:
        assert scenes.deepest_new_overlap(model, qpos, first.qpos) < 1e-3


def test_proposals_name_their_route_and_number(episode):
    _, steps, _, _ = episode
    routes = {local_name(iri) for iri in load_schema().routes}
    for _, first, _, second, _, _ in steps:
        assert first.route in routes
        assert (first.candidate, second.candidate) == (0, 1)
