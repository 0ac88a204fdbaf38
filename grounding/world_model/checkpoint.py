"""A checkpoint: the weights of one network and its model card, in one safetensors file.

The card says what the network is and how it was made: enough to build it again, and to repeat its training. It lies in
the file's header, with a checksum over both: neither comes without the other, or altered unnoticed. Nothing here
reads a pickle.
"""

from __future__ import annotations

import hashlib
import json
import math
import struct
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any, TypeVar

import torch
from safetensors import SafetensorError
from safetensors.torch import load as tensors_of
from safetensors.torch import save as bytes_of

from onto_compiler.atomic import replacing
from onto_compiler.problems import OntoError, Problem

__all__ = ["Card", "Checkpoint", "checksum", "fill", "load", "read_card", "restore", "save"]

Module = TypeVar("Module", bound=torch.nn.Module)

_KEY = "onto-evwm"  # the one entry of the header: a map of several would be written in any order
_SHOWN = 5  # tensors that differ; a network of another width differs in all of them
_LENGTH = struct.Struct("<Q")  # safetensors: the header's length comes first


@dataclass(frozen=True, slots=True)
class Card:
    """The model card of a network. ``parameters`` are the keyword arguments that build it.

    Values are JSON, or numbers of numpy, which become JSON when they are saved; a metric that is not finite, such as a
    recall of what never occurred, becomes None.
    """

    architecture: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    encoder: str = ""  # identity of the encoder whose features it reads; empty if it reads none
    facts: tuple[str, ...] = ()  # the predicates that a head was trained for
    data: Mapping[str, Any] = field(default_factory=dict)
    sees: str = ""  # what its training saw: pixels, proprioception, privileged-state
    seed: int | None = None
    command: str = ""
    commit: str = ""
    metrics: Mapping[str, float | None] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Checkpoint:
    """The weights of a file by name, their card, and ``identity``: the SHA-256 over the weights."""

    path: Path
    card: Card
    tensors: Mapping[str, torch.Tensor]
    identity: str

    def fill(self, module: Module) -> Module:
        """Copy the weights into ``module``; raises ``WM004`` where names, shapes or types differ."""
        return fill(module, self.tensors, self.path)


def fill(module: Module, tensors: Mapping[str, torch.Tensor], path: Path) -> Module:
    """Copy ``tensors``, which were read from ``path``, into ``module``: all of them, and all that it has.

    Raises:
        OntoError: ``WM004``, with a problem for each weight whose name, shape or type differs.
    """
    problems = _differences(tensors, module.state_dict(), str(path))
    if problems:
        raise OntoError(*problems)
    module.load_state_dict(dict(tensors))
    return module


def save(path: Path, tensors: Mapping[str, torch.Tensor], card: Card) -> None:
    """Write ``tensors`` (as of ``module.state_dict()``) and ``card``, whole or not at all.

    The same weights and the same card make the same bytes.

    Raises:
        OntoError: ``WM005`` if a weight is not finite, ``WM006`` if the file cannot be written.
    """
    # Copies: safetensors refuses tensors that share memory, as tied weights do.
    ready = {
        name: tensor.detach().cpu().clone(memory_format=torch.contiguous_format) for name, tensor in tensors.items()
    }
    _require_finite(ready, path)
    values = _plain(card)
    about = json.dumps({"card": values, "sha256": _seal(values, checksum(ready))}, sort_keys=True)
    try:
        with replacing(path) as partial:
            partial.write_bytes(bytes_of(ready, {_KEY: about}))
    except OSError as error:
        raise OntoError.of("WM006", f"the checkpoint cannot be written: {error.strerror}", "", str(path)) from error


def load(path: Path, architecture: str, device: str = "cpu") -> Checkpoint:
    """The checkpoint at ``path``, whose network must be an ``architecture``.

    Raises:
        OntoError: ``WM001`` if there is no file, ``WM002`` if it is damaged or is no checkpoint, ``WM003`` if
            it holds another architecture, ``WM005`` if a weight is not finite.
    """
    data = _bytes(path)
    values, promised = _about(data, path)
    card = _card(values, path)
    if card.architecture != architecture:
        message = f"the checkpoint holds a `{card.architecture}`, where a `{architecture}` is expected"
        raise OntoError.of("WM003", message, _maker(card), str(path))
    try:
        tensors = tensors_of(data)
    except (SafetensorError, KeyError) as error:  # a KeyError: a type of numbers that torch has not
        raise _damaged(path, f"the weights cannot be read: {error}") from error
    identity = checksum(tensors)
    found = _seal(values, identity)
    if found != promised:
        message = f"card and weights have the checksum {found[:12]}, and the header says {promised[:12]}"
        raise _damaged(path, message)
    _require_finite(tensors, path)
    return Checkpoint(path, card, {name: tensor.to(device) for name, tensor in tensors.items()}, identity)


def restore(
    path: Path, architecture: str, build: Callable[..., Module], device: str = "cpu"
) -> tuple[Module, Checkpoint]:
    """The network at ``path``, built by ``build(**card.parameters)`` and filled; frozen, in evaluation mode.

    Raises:
        OntoError: as :func:`load`; ``WM003`` if ``build`` refuses the parameters, ``WM004`` if the weights are
            those of another network.
    """
    checkpoint = load(path, architecture, device)
    try:
        module = build(**checkpoint.card.parameters)
    except (TypeError, ValueError) as error:
        message = f"a `{architecture}` cannot be built with the parameters of the card: {error}"
        raise OntoError.of("WM003", message, _maker(checkpoint.card), str(path)) from error
    return checkpoint.fill(module.to(device)).eval().requires_grad_(requires_grad=False), checkpoint


def read_card(path: Path) -> Card:
    """The card of the checkpoint at ``path``, without its weights; raises ``WM001`` and ``WM002`` as :func:`load`."""
    return _card(_about(_bytes(path), path)[0], path)


def checksum(tensors: Mapping[str, torch.Tensor]) -> str:
    """A SHA-256 over names, types, shapes and values, in the order of the names."""
    total = hashlib.sha256()
    for name in sorted(tensors):
        tensor = tensors[name].detach().cpu().contiguous()
        total.update(f"{name} {tensor.dtype} {tuple(tensor.shape)}\n".encode())
        total.update(tensor.reshape(-1).view(torch.uint8).numpy())
    return total.hexdigest()


def _plain(card: Card) -> Any:  # noqa: ANN401 - whatever JSON holds
    """The card as JSON holds it."""
    metrics = {name: None if value is None else float(value) for name, value in card.metrics.items()}
    finite = {name: value if value is not None and math.isfinite(value) else None for name, value in metrics.items()}
    text = json.dumps({**asdict(card), "metrics": finite}, allow_nan=False, default=lambda value: value.item())
    return json.loads(text)


def _seal(card: Any, weights: str) -> str:  # noqa: ANN401 - whatever JSON holds
    """A SHA-256 over the values of the card and the checksum of the weights."""
    return hashlib.sha256(f"{json.dumps(card, sort_keys=True)}\n{weights}".encode()).hexdigest()


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError as error:
        raise OntoError.of("WM001", "there is no checkpoint here", "", str(path)) from error
    except OSError as error:
        raise OntoError.of("WM001", f"the checkpoint cannot be read: {error.strerror}", "", str(path)) from error


def _about(data: bytes, path: Path) -> tuple[Any, str]:
    """The values of the card and the checksum in the header of a safetensors file."""
    if len(data) < _LENGTH.size:
        raise _damaged(path, f"a file of {len(data)} bytes is no safetensors file")
    (length,) = _LENGTH.unpack_from(data)
    if length > len(data) - _LENGTH.size:
        raise _damaged(path, "the file is no safetensors file, or was cut off within its header")
    try:
        header = json.loads(data[_LENGTH.size : _LENGTH.size + length])
        about = json.loads(header["__metadata__"][_KEY])
        card, promised = about["card"], str(about["sha256"])
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise _damaged(path, "the file has no model card of this project in its header") from error
    return card, promised


def _card(values: Any, path: Path) -> Card:  # noqa: ANN401 - whatever JSON holds
    kinds: dict[str, tuple[type, ...]] = {
        **dict.fromkeys(("architecture", "encoder", "sees", "command", "commit"), (str,)),
        **dict.fromkeys(("parameters", "data", "metrics"), (dict,)),
        "facts": (list,),
        "seed": (int, type(None)),
    }
    names = {entry.name for entry in fields(Card)}
    if not isinstance(values, dict) or set(values) != names:
        raise _damaged(path, f"a model card has the entries {', '.join(sorted(names))}")
    wrong = [name for name, kind in kinds.items() if not isinstance(values[name], kind)]
    if wrong:
        raise _damaged(path, f"entries of the model card have another type: {', '.join(wrong)}")
    return Card(**{**values, "facts": tuple(map(str, values["facts"]))})


def _differences(
    found: Mapping[str, torch.Tensor], expected: Mapping[str, torch.Tensor], file: str
) -> tuple[Problem, ...]:
    """What keeps the weights ``found`` from being those of a network with the weights ``expected``."""
    faults = [f"`{name}` is missing, {_form(expected[name])} expected" for name in expected if name not in found]
    faults += [f"`{name}` {_form(found[name])} is not part of the network" for name in found if name not in expected]
    faults += [
        f"`{name}` is {_form(found[name])}, {_form(expected[name])} expected"
        for name in expected
        if name in found and _form(found[name]) != _form(expected[name])
    ]
    if len(faults) > _SHOWN:
        faults[_SHOWN:] = [f"{len(faults) - _SHOWN} more weights differ"]
    hint = "the network was built with other parameters than the one that was saved"
    return tuple(Problem(file, 0, 0, "WM004", "error", sentence, hint) for sentence in faults)


def _form(tensor: torch.Tensor) -> str:
    return f"{str(tensor.dtype).removeprefix('torch.')} {tuple(tensor.shape)}"


def _require_finite(tensors: Mapping[str, torch.Tensor], path: Path) -> None:
    bad = [name for name, tensor in tensors.items() if not bool(torch.isfinite(tensor).all())]
    if bad:
        message = f"`{bad[0]}` holds values that are not finite" + (f", and {len(bad) - 1} more" if bad[1:] else "")
        raise OntoError.of("WM005", message, "the training diverged: lower its learning rate", str(path))


def _maker(card: Card) -> str:
    return f"it was made by `{card.command}`" if card.command else ""


def _damaged(path: Path, message: str) -> OntoError:
    return OntoError.of("WM002", message, "copy the file again, or repeat the training that made it", str(path))
