"""One training loop: AdamW with a linearly falling rate, saved to a checkpoint as it goes.

Every step draws its batch from a generator of its own, seeded by seed and step. The checkpoint holds weights and the
optimiser's moments, so a run that is resumed ends, bit for bit, as one that was never interrupted.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import torch

from grounding.world_model.checkpoint import Card, load, save

__all__ = ["Schedule", "fit"]

_SAVE_EVERY = 20.0
"""Seconds between two writes of the checkpoint."""
_ARCHITECTURE = "training"

Loss = Callable[[torch.Generator], torch.Tensor]


@dataclass(frozen=True, slots=True)
class Schedule:
    """``steps`` of AdamW from ``rate`` down to a hundredth of it, with ``decay`` of the weights."""

    steps: int
    rate: float = 2e-3
    decay: float = 1e-5


def fit(
    module: torch.nn.Module,
    loss: Loss,
    schedule: Schedule,
    seed: int,
    checkpoint: Path,
    log: Callable[[int, float], None] = lambda _step, _loss: None,
    source: str = "",
) -> None:
    """Minimise ``loss`` over the trainable weights of ``module``, in place; save progress to ``checkpoint``.

    ``log(step, loss)`` is called as training goes on. A finished fit is read from ``checkpoint`` and not repeated.
    ``source`` identifies the data of the loss. Checkpoints from another source, seed or schedule are ignored.

    Raises:
        OntoError: ``WM005`` if the loss is no longer finite, ``WM006`` if ``checkpoint`` cannot be written,
            ``WM002`` and ``WM004`` if it is damaged or of another network.
    """
    trained = {name: weight for name, weight in module.named_parameters() if weight.requires_grad}
    optimiser = torch.optim.AdamW(trained.values(), lr=schedule.rate, weight_decay=schedule.decay, fused=True)
    about = Card(_ARCHITECTURE, {**asdict(schedule), "source": source}, seed=seed)
    begin = _resumed(trained, optimiser, checkpoint, about)
    written = time.monotonic()
    for step in range(begin, schedule.steps):
        for group in optimiser.param_groups:
            group["lr"] = schedule.rate * max(1 - step / schedule.steps, 0.01)
        found = loss(torch.Generator().manual_seed(seed * 1_000_003 + step))
        optimiser.zero_grad(set_to_none=True)
        found.backward()
        torch.nn.utils.clip_grad_norm_(trained.values(), 1.0, error_if_nonfinite=False)
        optimiser.step()
        if step % 100 == 99 or step == schedule.steps - 1:
            log(step + 1, float(found.detach()))
        if time.monotonic() - written > _SAVE_EVERY or step == schedule.steps - 1:
            save(checkpoint, _state(trained, optimiser, step + 1), about)
            written = time.monotonic()


def _state(
    trained: dict[str, torch.nn.Parameter], optimiser: torch.optim.Optimizer, step: int
) -> dict[str, torch.Tensor]:
    found: dict[str, torch.Tensor] = {"step": torch.tensor(step)}
    for name, weight in trained.items():
        adam = optimiser.state[weight]
        found[f"weight.{name}"] = weight.detach()
        found |= {f"{moment}.{name}": adam[moment] for moment in ("exp_avg", "exp_avg_sq")}
    return found


def _resumed(
    trained: dict[str, torch.nn.Parameter], optimiser: torch.optim.Optimizer, checkpoint: Path, about: Card
) -> int:
    """The step to resume from: that of ``checkpoint`` if it is of this schedule, seed and source, else 0."""
    if not checkpoint.exists():
        return 0
    found = load(checkpoint, _ARCHITECTURE)
    if (dict(found.card.parameters), found.card.seed) != (dict(about.parameters), about.seed):
        return 0
    step = int(found.tensors["step"])
    with torch.no_grad():
        for name, weight in trained.items():
            weight.copy_(found.tensors[f"weight.{name}"])
            optimiser.state[weight] = {
                "step": torch.tensor(float(step), device=weight.device),
                "exp_avg": found.tensors[f"exp_avg.{name}"].to(weight, copy=True),
                "exp_avg_sq": found.tensors[f"exp_avg_sq.{name}"].to(weight, copy=True),
            }
    return step
