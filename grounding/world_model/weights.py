"""Published weights in torch files: read as tensors only, and cached as safetensors."""

from __future__ import annotations

import hashlib
import logging
import pickle
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file

from grounding.world_model.checkpoint import Card, load, save
from onto_compiler.cache import cache_folder
from onto_compiler.problems import OntoError

__all__ = ["cached_weights", "read_weights"]

_LOG = logging.getLogger("onto_evwm.weights")


def read_weights(path: Path) -> dict[str, torch.Tensor]:
    """The tensors of a ``.safetensors`` file, or of a torch file that holds a state dict and nothing else.

    Raises:
        OntoError: ``WM008`` if the file is missing, damaged, or holds anything but finite tensors by name.
    """
    found: Any
    try:
        if path.suffix == ".safetensors":
            found = load_file(path)
        else:
            found = torch.load(path, map_location="cpu", weights_only=True)
    except (OSError, EOFError, RuntimeError, ValueError, KeyError, SafetensorError, pickle.UnpicklingError) as error:
        reason = str(error).partition("\n")[0]
        raise _unusable(path, f"the weights cannot be read: {reason}") from error
    if not isinstance(found, Mapping) or not all(isinstance(value, torch.Tensor) for value in found.values()):
        raise _unusable(path, "the file holds something else than tensors by name")
    if not all(bool(torch.isfinite(value).all()) for value in found.values()):
        raise _unusable(path, "weights in the file are not finite")
    return {str(name): value for name, value in found.items()}


def cached_weights(path: Path, folder: Path | None = None) -> Mapping[str, torch.Tensor]:
    """The weights of the torch file ``path``, from its safetensors copy in ``folder`` (the user's cache).

    The copy is named by the hash of the file and carries a checksum. Where it is missing or damaged it is made again;
    where the folder cannot be written there is none, and the log says so.

    Raises:
        OntoError: ``WM008`` if ``path`` itself cannot be read.
    """
    folder = folder or cache_folder()
    try:
        source = hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise _unusable(path, f"the weights cannot be read: {error.strerror}") from error
    architecture = f"torch file {source}"
    copy = None if folder is None else folder / "weights" / f"{path.stem}-{source[:16]}.safetensors"
    if copy is not None and copy.is_file():
        try:
            return load(copy, architecture).tensors
        except OntoError as error:
            _LOG.warning("kept weights %s are damaged and will be converted again: %s", copy.name, error)
    tensors = read_weights(path)
    if copy is not None:
        try:
            save(copy, tensors, Card(architecture, data={"file": path.name, "sha256": source}))
        except OntoError as error:
            _LOG.warning("the weights cannot be kept in %s: %s", copy.parent, error)
    return tensors


def _unusable(path: Path, message: str) -> OntoError:
    return OntoError.of("WM008", message, "fetch the file again; a state dict is expected", str(path))
