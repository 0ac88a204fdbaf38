"""One training loop: it learns, it resumes to the bit, and it says when it diverges."""

from __future__ import annotations

from pathlib import Path

import torch

from runtime.training.fit import Schedule, fit
from tests.interruption import interrupted


def network() -> torch.nn.Module:
    torch.manual_seed(0)
    return torch.nn.Sequential(torch.nn.Linear(2, 16), torch.nn.SiLU(), torch.nn.Linear(16, 1))


def loss_of(module: torch.nn.Module):
    def loss(random: torch.Generator) -> torch.Tensor:
        rows = torch.rand((64, 2), generator=random)
        return (module(rows)[:, 0] - rows.prod(dim=1)).square().mean()

    return loss


def test_the_loss_falls(tmp_path: Path):
    said: list[float] = []
    module = network()
    fit(module, loss_of(module), Schedule(400), 3, tmp_path / "kept", lambda _step, loss: said.append(loss))
    assert len(said) == 4
    assert said[-1] < 0.3 * float(loss_of(network())(torch.Generator().manual_seed(0)).detach())


def test_an_interrupted_run_ends_as_one_that_was_not(tmp_path: Path):
    whole = network()
    fit(whole, loss_of(whole), Schedule(60), 3, tmp_path / "whole")
    kept = tmp_path / "kept"
    first = network()
    with interrupted(saves=30):
        fit(first, loss_of(first), Schedule(60), 3, kept)
    assert kept.exists()
    second = network()
    fit(second, loss_of(second), Schedule(60), 3, kept)
    third, steps = network(), list[int]()
    fit(third, loss_of(third), Schedule(60), 3, kept, lambda step, _loss: steps.append(step))
    assert steps == []  # what is done is not done again
    assert torch.equal(next(third.parameters()), next(second.parameters()))
    for one, other in zip(whole.parameters(), second.parameters(), strict=True):
        assert torch.equal(one, other)


def test_what_was_fitted_to_other_data_is_fitted_again(tmp_path: Path):
    kept, steps = tmp_path / "kept", list[int]()
    for source in ("one", "one", "other"):
        module = network()
        fit(module, loss_of(module), Schedule(100), 3, kept, lambda step, _loss: steps.append(step), source)
    assert steps == [100, 100]


def test_what_another_seed_kept_is_not_gone_on_with(tmp_path: Path):
    kept, module = tmp_path / "kept", network()
    with interrupted(saves=9):
        fit(module, loss_of(module), Schedule(20), 3, kept)
    steps: list[int] = []
    other, straight = network(), network()
    fit(other, loss_of(other), Schedule(20), 4, kept, lambda step, _loss: steps.append(step))
    fit(straight, loss_of(straight), Schedule(20), 4, tmp_path / "straight")
    assert torch.equal(next(other.parameters()), next(straight.parameters()))
