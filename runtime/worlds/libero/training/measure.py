"""Metrics of the parts at the ends of windows from films that they were not trained on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from grounding.world_model.dynamics import Dynamics, Imagined, spread
from grounding.world_model.pred import ScenePredGrounder
from grounding.world_model.scene import SceneEventHead, SceneFactHead
from onto_compiler.required import Fact
from runtime.training.measures import auroc, calibration_error
from runtime.worlds.libero.training.heads import sensed_all
from runtime.worlds.libero.training.scene import SceneFacts
from runtime.worlds.libero.training.windows import Windows

__all__ = [
    "ENOUGH",
    "WindowPredictions",
    "event_metrics",
    "fact_metrics",
    "imagining_metrics",
    "predict_events",
    "predict_facts",
]

ENOUGH = 30
"""The number of positives from which a fact's AUROC is reported."""
_AT_ONCE = 512
_SPOTS, _FINGERS = slice(0, 3), slice(9, 11)


@dataclass(frozen=True, slots=True, eq=False)
class WindowPredictions:
    """Scores and margins (W, F) of the ends of W windows."""

    score: NDArray[np.float64]
    margin: NDArray[np.float64]


@torch.no_grad()  # type: ignore[untyped-decorator]
def predict_facts(
    dynamics: Dynamics, head: SceneFactHead, facts: Sequence[Fact], data: Windows
) -> tuple[WindowPredictions, WindowPredictions]:
    """Predictions of ``head`` for each window's end, from the predicted and from the true final state."""
    grounder = ScenePredGrounder(head, facts)
    sensed = sensed_all(data.frames.states.shape[-1]).to(data.frames.device)
    parts: tuple[list[NDArray[np.float64]], ...] = ([], [], [], [])
    for start in range(0, len(data), _AT_ONCE):
        which = np.arange(start, min(start + _AT_ONCE, len(data)))
        piece = data.frames.piece(which, np.zeros_like(which))
        imagined = dynamics.imagine(piece.features[:, 0], piece.states[:, 0], piece.actions)
        seen = Imagined(piece.features[None, :, 1:], piece.states[None, :, 1:], piece.states[None])
        for place, each in enumerate((imagined, seen)):
            found = grounder.ground(each, sensed)
            parts[2 * place].append(found.score.cpu().numpy().astype(np.float64))
            parts[2 * place + 1].append(found.margin.cpu().numpy().astype(np.float64))
    score, margin, seen_score, seen_margin = (np.concatenate(part) for part in parts)
    return WindowPredictions(score, margin), WindowPredictions(seen_score, seen_margin)


def imagining_metrics(network: Dynamics, data: Windows) -> dict[str, float]:
    """Errors at the ends of all windows over all members; for features also the error of persistence."""
    which = np.arange(len(data))
    piece = data.frames.piece(which, np.zeros_like(which))
    found = network.imagine(piece.features[:, 0], piece.states[:, 0], piece.actions)
    gap = found.proprio[:, :, -1] - piece.states[:, -1]
    hand = gap[..., _SPOTS].norm(dim=-1)

    def error(looks: torch.Tensor) -> float:
        return float(((looks - piece.features[:, -1]) / network.feature_scale).square().mean())

    return {
        "hand_median_m": float(hand.median()),
        "hand_mean_m": float(hand.mean()),
        "fingers_mean_m": float(gap[..., _FINGERS].abs().mean()),
        "feature_error": error(found.features[:, :, -1]),
        "feature_error_if_still": error(piece.features[:, 0]),
    }


def fact_metrics(dynamics: Dynamics, head: SceneFactHead, facts: Sequence[Fact], data: Windows) -> dict[str, float]:
    """AUROC, margin error and calibration of each fact with :data:`ENOUGH` positives, and the worst AUROC of them."""
    predicted, _ = predict_facts(dynamics, head, facts, data)
    truth, margin = data.truth[:, -1], data.margin[:, -1]
    found: dict[str, float] = {}
    for place, name in enumerate(head.facts):
        if truth[:, place].sum() < ENOUGH:
            continue
        found[f"{name}.auroc"] = auroc(predicted.score[:, place], truth[:, place])
        found[f"{name}.margin_mae"] = float(np.abs(predicted.margin[:, place] - margin[:, place]).mean())
        found[f"{name}.ece"] = calibration_error(predicted.score[:, place], truth[:, place])
    ranked = [value for name, value in found.items() if name.endswith(".auroc")]
    return {**({"auroc_min": min(ranked)} if ranked else {}), **found}


@torch.no_grad()  # type: ignore[untyped-decorator]
def predict_events(
    dynamics: Dynamics, head: SceneEventHead, asked: SceneFacts, data: Windows
) -> dict[str, NDArray[np.float64]]:
    """Of each window's imagined end, for its own task, means over the members; and, beside each event, what is true.

    ``success`` and ``succeeds``, ``remaining`` and ``left`` (seconds; infinite if it is not known), ``feasibility``
    and ``clear``, ``uncertainty`` and ``error``; all (W,).
    """
    goal = np.zeros((len(data), len(asked.names)), dtype=np.bool_)
    for row, task in enumerate(data.task):
        goal[row, list(asked.goals[int(task)])] = True
    predicted: list[dict[str, torch.Tensor]] = []
    for start in range(0, len(data), _AT_ONCE):
        which = np.arange(start, min(start + _AT_ONCE, len(data)))
        piece = data.frames.piece(which, np.zeros_like(which))
        imagined = dynamics.imagine(piece.features[:, 0], piece.states[:, 0], piece.actions)
        features, proprio = imagined.features[:, :, -1], imagined.proprio[:, :, -1]
        doubt = spread(proprio, dynamics.motion.scale)
        sensed = sensed_all(proprio.shape[-1]).to(proprio.device)
        found = head(features, proprio, doubt, sensed, data.frames.tensor(goal[which]))
        gap = ((proprio - piece.states[:, -1]) / dynamics.motion.scale).square().mean(dim=-1).sqrt()
        several = {
            "success": found.success.sigmoid(), "remaining": found.remaining,
            "feasibility": found.feasibility.sigmoid(), "uncertainty": found.uncertainty, "error": gap,
        }  # fmt: skip
        predicted.append({name: values.mean(dim=0) for name, values in several.items()})
    every = {
        name: torch.cat([part[name] for part in predicted]).cpu().numpy().astype(np.float64) for name in predicted[0]
    }
    return every | {
        "succeeds": (data.truth[:, -1] | ~goal).all(axis=1).astype(np.float64),
        "left": data.remaining[:, -1].astype(np.float64),
        "clear": data.clear[:, -1].astype(np.float64),
    }


def event_metrics(dynamics: Dynamics, head: SceneEventHead, asked: SceneFacts, data: Windows) -> dict[str, float]:
    """Metrics of :func:`predict_events`."""
    predicted = predict_events(dynamics, head, asked, data)
    there = np.isfinite(predicted["left"])
    return {
        "remaining_mae_s": float(np.abs(predicted["remaining"] - predicted["left"])[there].mean()),
        "success_auroc": auroc(predicted["success"], predicted["succeeds"] > 0),
        "feasibility_auroc": auroc(predicted["feasibility"], predicted["clear"] > 0),
        "uncertainty_mae": float(np.abs(predicted["uncertainty"] - predicted["error"]).mean()),
    }
