"""Heads of a scene: what they read, and how a task's facts are asked of them."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch

from grounding.world_model.dynamics import Imagined
from grounding.world_model.pred import ScenePredGrounder
from grounding.world_model.scene import SceneEventHead, SceneFactHead
from onto_compiler.problems import OntoError
from onto_compiler.required import Entity, Fact, NativeAtom

CENTRE, SCALE, WIDTH = [0.0, 1.0, 0.0], [1.0, 2.0, 3.0], 6
ALL, STILL = torch.tensor([True] * 3), torch.tensor([True, True, False])
FACTS = tuple(
    Fact(f"https://w3id.org/onto-evwm/manipulation#{name}", (Entity("bowl", "Object"),), NativeAtom(name, ()), name)
    for name in ("on", "inside")
)


def head() -> SceneFactHead:
    torch.manual_seed(0)
    return SceneFactHead([str(fact) for fact in FACTS], [0.1, 2.0], CENTRE, SCALE, WIDTH, 2.0, width=16).eval()


def imagined() -> Imagined:
    generator = torch.Generator().manual_seed(1)
    proprio = torch.rand(2, 7, 5, 3, generator=generator)
    return Imagined(torch.rand(2, 7, 5, WIDTH, generator=generator), proprio, torch.zeros(2, 7, 26, 3))


def test_facts_come_in_the_order_that_they_are_asked_in_whatever_their_polarity():
    network, given = head(), imagined()
    forth = ScenePredGrounder(network, FACTS).ground(given, ALL)
    back = ScenePredGrounder(network, [replace(FACTS[1], polarity=False), FACTS[0]]).ground(given, ALL)
    assert torch.equal(forth.margin, back.margin.flip(-1))
    assert torch.equal(forth.score, back.score.flip(-1))
    assert forth.margin.shape == (7, 2)
    every = ScenePredGrounder(network, FACTS).ground(given, ALL, every=True)
    assert torch.allclose(every.score[:, -1], forth.score, atol=1e-6)
    seen = forth.observation(2, step=25)
    assert (seen.source, seen.step) == ("pred", 25)
    assert seen.truth.tolist() == (forth.score[2] > 0.5).tolist()


def test_every_fact_that_the_head_does_not_know_is_told():
    strange = [replace(FACTS[0], arguments=(Entity("plate", "Object"),)), replace(FACTS[0], predicate="x#opened")]
    with pytest.raises(OntoError) as caught:
        ScenePredGrounder(head(), [FACTS[0], *strange])
    assert [problem.code for problem in caught.value.problems] == ["WM013", "WM013"]
    assert "on(plate)" in caught.value.problems[0].message


def test_what_is_not_sensed_is_not_read():
    network, given = head(), imagined()
    other = given.proprio.clone()
    other[..., 2] = 99.0
    doubt = torch.zeros(2, 7, 5)
    assert torch.equal(
        network(given.features, given.proprio, doubt, STILL)[0], network(given.features, other, doubt, STILL)[0]
    )
    assert not torch.equal(
        network(given.features, given.proprio, doubt, ALL)[0], network(given.features, other, doubt, ALL)[0]
    )


def test_a_higher_temperature_brings_scores_nearer_to_a_half_and_keeps_their_sides():
    network, given = head(), imagined()
    doubt = torch.zeros(2, 7, 5)
    margin, sharp = network(given.features, given.proprio, doubt, ALL)
    network.temperature.copy_(torch.tensor([4.0, 1.0]))
    same, soft = network(given.features, given.proprio, doubt, ALL)
    assert torch.allclose(soft[..., 0] * 4, sharp[..., 0])
    assert torch.equal(soft[..., 1], sharp[..., 1])
    assert torch.equal(margin, same)


def test_events_depend_on_what_the_task_requires():
    torch.manual_seed(0)
    network, given = SceneEventHead(2, CENTRE, SCALE, WIDTH, 2.0, width=16).eval(), imagined()
    doubt = torch.zeros(2, 7, 5)
    one = network(given.features, given.proprio, doubt, ALL, torch.tensor([1.0, 0.0]))
    other = network(given.features, given.proprio, doubt, ALL, torch.tensor([0.0, 1.0]))
    assert one.success.shape == (2, 7, 5)
    assert not torch.equal(one.success, other.success)
    assert bool((one.remaining > 0).all())
    assert bool((one.uncertainty > 0).all())
