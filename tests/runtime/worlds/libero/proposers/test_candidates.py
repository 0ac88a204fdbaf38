from __future__ import annotations

import pytest

from runtime.worlds.libero.proposers.candidates import StateCandidate, offer, ranked
from tests.runtime.worlds.libero.proposers import conftest as scenes

pytestmark = pytest.mark.sim

FACTS = (scenes.OPEN_DRAWER, scenes.fact("On", "box_1", "tray_1", grounded_by="on_object"))


@pytest.fixture
def request_(world):
    return world.request(*FACTS, qpos=world.slide(0.0))


def opened(world, value, flaws=0, rank=0.0):
    return StateCandidate(world.slide(value), f"{value}", flaws, rank)


def notes(request, batches):
    return [candidate.note for candidate in ranked(request, batches)]


def test_what_does_not_satisfy_the_fact_is_dropped(world, request_):
    assert notes(request_, [[opened(world, 0.1), opened(world, 0.18)]]) == ["0.18"]


def test_the_smaller_rank_comes_first_within_a_batch(world, request_):
    batch = [opened(world, 0.16, rank=2.0), opened(world, 0.17, rank=1.0)]
    assert notes(request_, [batch]) == ["0.17", "0.16"]


def test_a_flawed_candidate_waits_for_all_batches(world, request_):
    batches = [[opened(world, 0.16, flaws=2), opened(world, 0.165, flaws=1)], [opened(world, 0.17)]]
    assert notes(request_, batches) == ["0.17", "0.165", "0.16"]


def test_a_candidate_that_breaks_another_fact_comes_after_flawed_ones(world):
    request = world.request(scenes.OPEN_DRAWER, scenes.CLOSE_DRAWER, qpos=world.slide(0.0))
    breaking = opened(world, 0.16)  # open is not closed
    assert notes(request, [[breaking]]) == ["0.16"]
    kept = world.request(*FACTS, qpos=world.slide(0.0))
    assert notes(kept, [[breaking, opened(world, 0.17, flaws=3)]]) == ["0.16", "0.17"]
    lost = world.request(scenes.OPEN_DRAWER, scenes.fact("On", "crumb_1", "box_1", grounded_by="on_object"))
    pushed = world.slide(0.16)
    pushed[world.scene.qpos_slice(world.scene.free_joint("crumb_1")).start] += 0.3
    batch = [StateCandidate(pushed, "pushed", 0), opened(world, 0.17, flaws=3)]
    assert notes(lost, [batch]) == ["0.17", "pushed"]


def test_equal_states_are_offered_once(world, request_):
    assert notes(request_, [[opened(world, 0.16)], [opened(world, 0.16), opened(world, 0.17)]]) == ["0.16", "0.17"]


def test_batches_are_drawn_only_as_far_as_needed(world, request_):
    drawn = []

    def batches():
        for value in (0.16, 0.17, 0.18):
            drawn.append(value)
            yield [opened(world, value)]

    assert offer(request_, "route", "proposer", ranked(request_, batches())).note == "0.16"
    assert drawn == [0.16]


def test_an_offer_names_what_changed_or_is_none(world, request_):
    proposal = offer(request_, "route", "proposer", iter([opened(world, 0.16)]))
    assert proposal.changed == (int(world.model.joint("chest_1_slide").qposadr[0]),)
    assert (proposal.route, proposal.proposer, proposal.candidate) == ("route", "proposer", 0)
    assert offer(request_, "route", "proposer", iter([])) is None
