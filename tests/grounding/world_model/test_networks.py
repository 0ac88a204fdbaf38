"""The networks of a world model: what they are given, what comes back, and what must not leak."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch

from grounding.world_model.dynamics import Dynamics, History, spread
from grounding.world_model.events import EventHead
from grounding.world_model.facts import FactHead
from grounding.world_model.motion import Motion
from grounding.world_model.pred import ObservedGoal, PredGrounder
from onto_compiler.problems import OntoError
from onto_compiler.required import Entity, Fact, NativeAtom

CENTRE, SCALE, BOUND = [1.8, 1.8, 0.0, 0.0], [1.4, 1.4, 5.0, 5.0], [1e6, 1e6, 5.0, 5.0]
SENSED, BLIND = torch.tensor([True] * 4), torch.tensor([True, True, False, False])
FEATURES = 8


def dynamics(members: int = 2) -> Dynamics:
    torch.manual_seed(0)
    motion = {"centre": CENTRE, "scale": SCALE, "bound": BOUND, "actions": 2, "members": members, "width": 16}
    network = Dynamics(motion, FEATURES, 2.0, width=16)
    for weight in network.parameters():  # the last layers begin at zero: a fresh network says nothing
        torch.nn.init.normal_(weight, std=0.2)
    return network.eval().requires_grad_(requires_grad=False)


def fact(name: str) -> Fact:
    ball = Entity("ball", "Ball")
    return Fact(f"https://w3id.org/onto-evwm/navigation#{name}", (ball, ball), NativeAtom(name, ("ball",)), name)


def head(facts: tuple[str, ...] = ("at_target", "velocity_matches", "free_of")) -> FactHead:
    torch.manual_seed(1)
    network = FactHead(facts, CENTRE, SCALE, FEATURES, 2.0)
    for weight in network.parameters():
        torch.nn.init.normal_(weight, std=0.3)
    return network.eval().requires_grad_(requires_grad=False)


def test_members_of_an_ensemble_do_not_mix():
    motion = dynamics(members=3).motion
    begin, action = torch.rand(3, 5, 4), torch.rand(3, 5, 2)
    whole = motion(begin, action)
    for member in range(3):
        others = begin.clone()
        others[[other for other in range(3) if other != member]] += 1.0
        assert torch.equal(motion(others, action)[member], whole[member])


def test_motion_clips_velocities_as_the_environment_does():
    motion = dynamics().motion
    fast, limit = torch.tensor([2.0, 2.0, 9.0, -7.0]), torch.tensor([2.0, 2.0, 5.0, -5.0])
    action = torch.zeros(2, 1, 2)
    assert torch.equal(motion(fast.expand(2, 1, 4), action), motion(limit.expand(2, 1, 4), action))


def test_a_fresh_motion_stands_still():
    motion = Motion(CENTRE, SCALE, BOUND, 2)
    begin = torch.rand(3, 4, 4)
    assert torch.equal(motion(begin, torch.rand(3, 4, 2)), begin)


@pytest.mark.parametrize("members", [1, 2, 3, 4])
def test_members_begin_apart_in_pairs_around_the_first(members):
    network, begin = dynamics(members=members), torch.rand(5, 4)
    found = network.apart(begin, torch.Generator().manual_seed(0))
    assert found.shape == (members, 5, 4)
    assert torch.equal(found[0], begin)
    off = (found[1:] - begin) / network.motion.scale
    assert bool((off.abs() < 0.06).all())
    assert bool((off.abs() > 0).all())
    if members == 3:
        assert torch.allclose(found.mean(dim=0), begin, atol=1e-6)


def test_imagining_in_two_parts_is_imagining_in_one():
    network = dynamics(members=1)
    actions = torch.rand(3, 4, 5, 2) * 2 - 1
    features, begin = torch.rand(FEATURES), torch.rand(4)
    whole = network.imagine(features, begin, actions)
    first = network.imagine(features, begin, actions[:, :2])
    second = network.imagine(first.features[0, :, -1], first.proprio[0, :, -1], actions[:, 2:])
    assert torch.allclose(second.features[0], whole.features[0, :, 2:], atol=1e-6)
    assert torch.allclose(second.path[0], whole.path[0, :, 10:], atol=1e-6)
    assert whole.features.shape == (1, 3, 4, FEATURES)
    assert whole.path.shape == (1, 3, 21, 4)


def test_what_is_not_sensed_is_not_read():
    network = dynamics()
    proprio, actions = torch.rand(3, 4), torch.rand(2, 5, 2)
    other = proprio.clone()
    other[:, 2:] = 99.0
    features = torch.rand(FEATURES)
    first = network.begin(History(features, proprio, actions, BLIND))
    assert torch.equal(first, network.begin(History(features, other, actions, BLIND)))
    assert torch.equal(first[:2], proprio[-1, :2])
    assert torch.equal(network.begin(History(features, other, actions, SENSED)), other[-1])


def test_a_young_history_is_estimated_from_what_there_is():
    network = dynamics()
    proprio, actions = torch.rand(3, 4), torch.rand(2, 5, 2)
    proprio[:2], actions[:] = math.nan, math.nan
    found = network.begin(History(torch.rand(FEATURES), proprio, actions, BLIND))
    assert bool(found.isfinite().all())


@pytest.mark.parametrize("sensed", [SENSED, BLIND], ids=["all sensed", "velocity not sensed"])
def test_heads_read_no_coordinate_that_is_not_sensed(sensed: torch.Tensor):
    facts, events = head(), EventHead(CENTRE, SCALE, FEATURES, 2.0)
    features, proprio, goal = torch.rand(2, 6, FEATURES), torch.rand(2, 6, 4), torch.rand(4)
    hidden = torch.where(sensed, proprio, 99.0), torch.where(sensed, goal, -99.0)
    doubt, look = torch.rand(6), torch.rand(FEATURES)
    for network in (lambda *given: facts(*given)[0], lambda *given: events(*given).remaining):
        found = network(features, proprio, look, goal, doubt, sensed)
        assert torch.equal(found, network(features, hidden[0], look, hidden[1], doubt, sensed))
        assert found.shape[:2] == (2, 6)


def test_margin_and_score_of_a_fact_agree_in_sign():
    margin, logit = head()(
        torch.rand(50, FEATURES), torch.rand(50, 4), torch.rand(50, FEATURES), torch.rand(50, 4), torch.rand(50), SENSED
    )
    assert torch.equal(margin > 0, logit > 0)
    assert bool((margin > 0).any())
    assert bool((margin < 0).any())


def test_predicted_facts_come_in_the_order_of_the_task():
    network, model = head(), dynamics()
    goal = ObservedGoal(torch.rand(FEATURES), torch.rand(4), SENSED)
    imagined = model.imagine(torch.rand(FEATURES), torch.rand(4), torch.rand(7, 3, 5, 2))
    forth = PredGrounder(network, [fact("at_target"), fact("free_of")]).ground(imagined, goal)
    back = PredGrounder(network, [fact("free_of"), fact("at_target")]).ground(imagined, goal)
    assert torch.equal(forth.margin, back.margin.flip(-1))
    assert forth.margin.shape == (7, 2)
    every = PredGrounder(network, [fact("at_target"), fact("free_of")]).ground(imagined, goal, every=True)
    assert torch.allclose(every.margin[:, -1], forth.margin, atol=1e-6)
    seen = forth.observation(3, step=25)
    assert (seen.source, seen.step, len(seen)) == ("pred", 25, 2)
    assert seen.truth.tolist() == (forth.score[3] > 0.5).tolist()


def test_a_fact_without_evidence_is_predicted_neither_way():
    imagined = dynamics().imagine(torch.rand(FEATURES), torch.rand(4), torch.rand(7, 3, 5, 2))
    facts = [fact("at_target"), fact("free_of")]
    found = PredGrounder(head(), facts, observed=[False, True]).ground(
        imagined, ObservedGoal(torch.rand(FEATURES), torch.rand(4), BLIND)
    )
    seen = found.observation(0, step=15)
    assert seen.observed.tolist() == [False, True]
    assert not seen.truth[0]
    assert np.isnan([seen.margin[0], seen.score[0]]).all()
    assert seen.margin[1] == pytest.approx(float(found.margin[0, 1]))


def test_a_fact_that_the_head_was_not_trained_for_is_refused():
    with pytest.raises(OntoError) as caught:
        PredGrounder(head(("at_target",)), [fact("at_target"), fact("free_of"), fact("velocity_matches")])
    assert [problem.code for problem in caught.value.problems] == ["WM013", "WM013"]
    assert "free_of" in caught.value.problems[0].message


def test_spread_is_zero_where_members_agree_and_grows_with_what_parts_them():
    same = torch.rand(1, 4, 4).expand(3, 4, 4)
    assert torch.allclose(spread(same, torch.ones(4)), torch.zeros(4), atol=1e-6)
    apart = torch.stack([torch.zeros(2, 4), torch.full((2, 4), 2.0)])
    assert torch.allclose(spread(apart, torch.full((4,), 2.0)), torch.full((2,), 0.5))
