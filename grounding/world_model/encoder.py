"""Pictures to features by a frozen encoder, which is looked up by name.

A name is that of a registered family and, where it takes some, options after colons: ``lite0``, ``lite0:block4``,
``lite0:block7:96``. Any installed package can register a family: an entry point in group ``onto_evwm.encoders`` that
loads a :data:`Factory`. It need not use torch.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from onto_compiler.problems import OntoError, clipped, near

__all__ = [
    "DEFAULT",
    "GROUP",
    "Encoder",
    "Factory",
    "Features",
    "Pictures",
    "checked",
    "checked_features",
    "encoder",
    "registered",
    "require_encoder",
]

GROUP = "onto_evwm.encoders"
DEFAULT = "lite0"

Pictures = NDArray[np.uint8]  # (N, S, S, 3): rows from the top, RGB
Features = NDArray[np.float32]  # (N, D)


class Encoder(Protocol):
    """A function of a picture alone: no state, no gradient, the same features for the same picture."""

    @property
    def name(self) -> str:
        """The full name, with all options."""

    @property
    def size(self) -> int:
        """S: how many pixels wide and high a picture is."""

    @property
    def shape(self) -> tuple[int, ...]:
        """The form of one picture's features before they are laid out flat; its product is D."""

    @property
    def identity(self) -> str:
        """Changes when the features may: a digest of the name and of the weights."""

    def encode(self, pictures: Pictures) -> Features:
        """Features (N, D), finite, of ``pictures`` (N, S, S, 3); N may be zero.

        Raises:
            OntoError: ``WM009`` if the pictures have another form (:func:`checked`).
        """


Factory = Callable[[Sequence[str], str], Encoder]
"""Options and device (``cpu``, ``cuda``, ``auto``) to an encoder; raises ``WM007`` for an option it does not know."""


@cache
def registered() -> dict[str, EntryPoint]:
    """The registered families by name, none of them imported yet."""
    return {point.name: point for point in sorted(entry_points(group=GROUP), key=lambda point: point.name)}


def encoder(name: str = DEFAULT, device: str = "cpu") -> Encoder:
    """The encoder called ``name``, with its weights on ``device``.

    Raises:
        OntoError: ``WM007`` for an unknown name or option, ``WM008`` if its weights cannot be had, ``WM012`` if
            there is no such device.
    """
    family, *options = name.split(":")
    point = registered().get(family)
    if point is None:
        known = ", ".join(f"`{each}`" for each in registered())
        message = f"`{clipped(family)}` is not an encoder; there are {known}"
        raise OntoError.of("WM007", message, near(family, registered()))
    make: Factory = point.load()
    return make(options, device)


def checked(pictures: NDArray[Any], size: int, name: str) -> Pictures:
    """``pictures``, if they are uint8 (N, ``size``, ``size``, 3); raises ``WM009`` if they are not."""
    if pictures.dtype != np.uint8 or pictures.ndim != 4 or pictures.shape[1:] != (size, size, 3):
        given = f"{pictures.dtype} {pictures.shape}"
        message = f"`{name}` reads pictures uint8 (N, {size}, {size}, 3), and was given {given}"
        raise OntoError.of("WM009", message, "pictures are RGB bytes of the encoder's `size`, along the first axis")
    return pictures


def checked_features(features: NDArray[Any], width: int) -> Features:
    """``features``, if they are ``width`` finite numbers a row; raises ``WM010`` if they are not."""
    if features.ndim != 2 or features.shape[1] != width:
        message = f"features of the form (N, {width}) are expected, and {features.shape} were given"
        raise OntoError.of("WM010", message, "they must come from the encoder that the network was trained with")
    finite = np.isfinite(features).all(axis=1)
    if not finite.all():
        bad = np.flatnonzero(~finite)
        message = f"{len(bad)} of {len(finite)} rows of features are not finite, the first of them row {bad[0]}"
        raise OntoError.of("WM010", message, "an encoder must give finite features for every picture")
    return features


def require_encoder(found: Encoder, identity: str, file: Path) -> None:
    """Make sure that ``found`` is the encoder with whose features the checkpoint ``file`` was trained.

    Raises:
        OntoError: ``WM011`` if it is another one, or has other weights.
    """
    if found.identity != identity:
        message = f"it reads features {identity[:12]}, and `{found.name}` gives features {found.identity[:12]}"
        hint = "train it with this encoder, or install the weights of the encoder that it was trained with"
        raise OntoError.of("WM011", message, hint, str(file))
