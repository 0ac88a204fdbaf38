"""The search: it finds, it keeps what it knows, and its noise has the colour that is asked for."""

from __future__ import annotations

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from runtime.planning.cem import Budget, Candidate, Judge, Sampling, SamplingDistribution, coloured, search

WANTED = torch.linspace(-0.8, 0.8, 20).reshape(10, 2)


def bowl(actions: torch.Tensor) -> torch.Tensor:
    return (actions - WANTED).square().sum(dim=(1, 2))


def seeded(seed: int = 0) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


def test_it_finds_the_bottom_of_a_bowl():
    start = SamplingDistribution.everywhere(10, 2, Sampling())
    few = search(bowl, start, Budget(iterations=3), Sampling(), seeded())
    many = search(bowl, start, Budget(iterations=30), Sampling(), seeded())
    assert many.cost < 0.05 < few.cost
    assert many.cost == pytest.approx(float(bowl(many.actions[None])[0]))
    assert (few.evaluations, many.evaluations) == (900, 9000)


@pytest.mark.parametrize("kept", [0, 5])
def test_more_iterations_are_never_worse(kept: int):
    sampling = Sampling(kept=kept)
    costs = [
        search(bowl, SamplingDistribution.everywhere(10, 2, sampling), Budget(50, 10, n), sampling, seeded()).cost
        for n in (1, 2, 4, 8)
    ]
    assert costs == sorted(costs, reverse=True)


def test_what_is_known_is_not_lost():
    known = Candidate(WANTED, 0.0, 1, SamplingDistribution.everywhere(10, 2, Sampling()))
    found = search(
        bowl, SamplingDistribution.everywhere(10, 2, Sampling()), Budget(20, 5, 1), Sampling(), seeded(), known
    )
    assert torch.equal(found.actions, WANTED)


def test_a_judge_has_the_last_iteration_and_the_last_word():
    asked: list[torch.Tensor] = []

    def second(actions: torch.Tensor) -> torch.Tensor:
        asked.append(actions)
        return -bowl(actions)

    start, budget = SamplingDistribution.everywhere(10, 2, Sampling()), Budget(50, 10, 4)
    found = search(bowl, start, budget, Sampling(), seeded(), judge=Judge(second, 16))
    short = search(bowl, start, Budget(50, 10, 3), Sampling(), seeded())
    (finalists,) = asked
    assert found.evaluations == 3 * 50 + 16 * len(finalists) <= budget.evaluations
    assert torch.equal(finalists[0], short.actions)
    assert torch.equal(finalists[-1], short.region.mean)
    assert found.cost == pytest.approx(float(-bowl(finalists).max()))
    assert torch.equal(found.actions, finalists[bowl(finalists).argmax()])


def test_what_is_known_comes_before_the_judge():
    start, known = (
        SamplingDistribution.everywhere(10, 2, Sampling()),
        Candidate(WANTED, 0.0, 1, SamplingDistribution.everywhere(10, 2, Sampling())),
    )
    found = search(bowl, start, Budget(20, 5, 2), Sampling(), seeded(), known, Judge(bowl, 16))
    assert torch.equal(found.actions, WANTED)


def test_a_judge_needs_an_iteration_of_its_own():
    with pytest.raises(ValueError, match="one more where there is a judge"):
        search(
            bowl,
            SamplingDistribution.everywhere(10, 2, Sampling()),
            Budget(20, 5, 1),
            Sampling(),
            seeded(),
            None,
            Judge(bowl, 1),
        )


def test_the_same_seed_finds_the_same_plan():
    start = SamplingDistribution.everywhere(10, 2, Sampling())
    one, other = (search(bowl, start, Budget(50, 10, 3), Sampling(), seeded(7)) for _ in range(2))
    assert torch.equal(one.actions, other.actions)


def test_every_candidate_is_an_action():
    seen: list[torch.Tensor] = []

    def cost(actions: torch.Tensor) -> torch.Tensor:
        seen.append(actions)
        return bowl(actions)

    search(
        cost, SamplingDistribution(torch.full((10, 2), 0.9), torch.ones(10, 2)), Budget(50, 10, 3), Sampling(), seeded()
    )
    assert len(seen) == 3
    assert all(bool((actions.abs() <= 1).all()) for actions in seen)


@settings(max_examples=20, deadline=None)
@given(steps=st.integers(1, 40), colour=st.sampled_from([0.0, 0.5, 1.0, 2.0]))
def test_noise_of_any_colour_has_unit_variance(steps: int, colour: float):
    noise = coloured((2000, steps, 2), colour, seeded())
    assert noise.shape == (2000, steps, 2)
    assert float(noise.square().mean()) == pytest.approx(1.0, rel=0.1)


def test_colour_is_a_slope_of_the_spectrum():
    for colour in (0.0, 1.0, 2.0):
        power = torch.fft.rfft(coloured((4000, 64, 1), colour, seeded()), dim=1).abs().square().mean(dim=(0, 2))
        ratio = float(power[2] / power[16])
        assert ratio == pytest.approx(8**colour, rel=0.15)
