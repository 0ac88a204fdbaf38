"""Fewer features: the principal components of those of the training pictures, fitted once and then frozen."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from grounding.world_model.checkpoint import Card, load, save
from grounding.world_model.encoder import Encoder, Features, Pictures, checked_features, encoder, require_encoder
from onto_compiler.problems import OntoError

__all__ = ["ARCHITECTURE", "Projected", "Projection", "fit", "load_projected", "save_projection"]

ARCHITECTURE = "projection"
_ROUGH = 1e-6  # of the largest variance: a component below it is rounding error, and is not scaled up


@dataclass(frozen=True, slots=True, eq=False)
class Projection:
    """``(features - mean) @ axes``: (N, D) to (N, K).

    ``axes`` (D, K) are orthogonal, by falling variance; of unit length, or, where ``whitened``, as long as makes each
    component's variance one on the features that it was fitted to. ``share`` is how much of their variance is kept.
    """

    mean: NDArray[np.float32]  # (D,)
    axes: NDArray[np.float32]  # (D, K)
    whitened: bool
    share: float

    def __call__(self, features: Features) -> Features:
        """Components (N, K) of ``features`` (N, D).

        Raises:
            OntoError: ``WM010`` if the features are not D numbers each, or are not finite.
        """
        found = (checked_features(features, len(self.mean)) - self.mean) @ self.axes
        return found.astype(np.float32, copy=False)


def fit(features: Features, components: int, *, whitened: bool = False) -> Projection:
    """The first ``components`` principal components of ``features`` (N, D), which must be training data alone.

    Each axis points to where its largest entry is positive, so that the same data give the same axes. Components whose
    variance is nothing but rounding error keep unit length when ``whitened``.

    Raises:
        OntoError: ``WM010`` if there are fewer features, or fewer rows, than ``components`` asks for, or where one
            is not finite.
    """
    rows, width = features.shape
    checked_features(features, width)
    if not 0 < components <= min(rows - 1, width):
        message = f"{components} components cannot be had from {rows} rows of {width} features"
        raise OntoError.of("WM010", message, "there are at most as many as features, and one fewer than rows")
    mean = features.mean(axis=0, dtype=np.float64)
    variances, vectors = _axes(features, mean) if rows >= width else _axes_of_few(features, mean, components)
    kept, axes = variances[:components], vectors[:, :components]
    axes = axes * np.sign(axes[np.abs(axes).argmax(axis=0), np.arange(components)])
    if whitened:
        axes = axes / np.where(kept > _ROUGH * variances[0], np.sqrt(kept), 1.0)
    share = float(kept.sum() / max(variances.sum(), np.finfo(np.float64).tiny))
    return Projection(mean.astype(np.float32), np.ascontiguousarray(axes, dtype=np.float32), whitened, share)


def _axes(features: Features, mean: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """All variances, falling, and the axes (D, D) that they are along."""
    rows, width = features.shape
    # Sums of products in float64 need no second copy of the data: 80,000 rows of 1,280 are 400 MB as they are.
    total = np.zeros((width, width))
    for start in range(0, rows, 4096):
        part = features[start : start + 4096].astype(np.float64) - mean
        total += part.T @ part
    variances, vectors = np.linalg.eigh(total / (rows - 1))
    return np.maximum(variances[::-1], 0), vectors[:, ::-1]


def _axes_of_few(
    features: Features, mean: NDArray[np.float64], components: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The same where there are fewer rows N than features: N variances, the first axes (D, K), by products of rows."""
    centred = features - mean.astype(np.float32)
    rows = len(centred)
    total = np.zeros((rows, rows))
    for start in range(0, features.shape[1], 4096):
        part = centred[:, start : start + 4096].astype(np.float64)
        total += part @ part.T
    variances, weights = np.linalg.eigh(total / (rows - 1))
    long = centred.T.astype(np.float64) @ weights[:, ::-1][:, :components]
    # They are orthogonal but for rounding, which is all that those without variance are made of.
    return np.maximum(variances[::-1], 0), np.linalg.qr(long)[0]


@dataclass(frozen=True, slots=True, eq=False)
class Projected:
    """An encoder and a projection of its features, which is again an encoder."""

    encoder: Encoder
    projection: Projection

    @property
    def name(self) -> str:
        """The encoder's, with the number of components."""
        return f"{self.encoder.name}>{self.shape[0]}"

    @property
    def size(self) -> int:
        """The encoder's."""
        return self.encoder.size

    @property
    def shape(self) -> tuple[int]:
        """The number of components."""
        return (self.projection.axes.shape[1],)

    @property
    def identity(self) -> str:
        """Changes with the encoder and with the projection."""
        total = hashlib.sha256(self.encoder.identity.encode())
        total.update(self.projection.mean.tobytes())
        total.update(self.projection.axes.tobytes())
        return total.hexdigest()

    def encode(self, pictures: Pictures) -> Features:
        """Components (N, K) of ``pictures`` (N, S, S, 3), a slice at a time; raises ``WM009`` for another form."""
        found = np.empty((len(pictures), *self.shape), dtype=np.float32)
        for start in range(0, len(pictures), 1024):
            found[start : start + 1024] = self.projection(self.encoder.encode(pictures[start : start + 1024]))
        return found


def save_projection(path: Path, projected: Projected, card: Card) -> None:
    """Write the projection to ``path``; what ``card`` says of architecture, parameters and encoder is filled in here.

    Raises:
        OntoError: as :func:`grounding.world_model.checkpoint.save`.
    """
    projection = projected.projection
    tensors = {"mean": torch.from_numpy(projection.mean), "axes": torch.from_numpy(projection.axes)}
    about = {"encoder": projected.encoder.name, "whitened": projection.whitened, "share": projection.share}
    save(path, tensors, replace(card, architecture=ARCHITECTURE, parameters=about, encoder=projected.encoder.identity))


def load_projected(path: Path, device: str = "cpu") -> Projected:
    """The encoder and the projection that :func:`save_projection` wrote to ``path``.

    Raises:
        OntoError: as :func:`grounding.world_model.checkpoint.load` and :func:`grounding.world_model.encoder.encoder`;
            ``WM004`` if the arrays do not belong together, ``WM011`` if the encoder has other weights here.
    """
    found = load(path, ARCHITECTURE)
    about, tensors = found.card.parameters, found.tensors
    if set(tensors) != {"mean", "axes"} or tensors["mean"].shape != tensors["axes"].shape[:1]:
        raise OntoError.of("WM004", "a projection holds `mean` (D,) and `axes` (D, K)", "", str(path))
    mean, axes = (tensors[name].to(torch.float32).numpy() for name in ("mean", "axes"))
    base = encoder(str(about.get("encoder", "")), device)
    require_encoder(base, found.card.encoder, path)
    return Projected(base, Projection(mean, axes, bool(about.get("whitened")), float(about.get("share", 0.0))))
