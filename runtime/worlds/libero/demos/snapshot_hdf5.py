"""Whole states in HDF5 groups: the window record (a :class:`Snapshot`), and the hidden state of every step.

LIBERO's flat state leaves out the warm start, the fixtures' poses, the gripper's current action and the controller.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from runtime.worlds.libero.demos.hdf5 import PACKED
from runtime.worlds.libero.demos.hidden import HiddenStates
from runtime.worlds.snapshot import Snapshot

__all__ = ["read_hidden", "read_start", "write_hidden", "write_start"]

_ARRAYS = ("integration", "body_pos", "body_quat", "gripper_action")
_STACKED = ("integration", "gripper_action")
_CONTROLLER = "controller"


def write_start(group: Any, start: Snapshot) -> None:  # noqa: ANN401  h5py is untyped
    """Write ``start`` into ``group``."""
    for name in _ARRAYS:
        group.create_dataset(name, data=getattr(start, name))
    arrays = {name: value for name, value in start.controller.items() if isinstance(value, np.ndarray)}
    inner = group.create_group(_CONTROLLER)
    for name, value in sorted(arrays.items()):
        inner.create_dataset(name, data=value)
    rest = {name: _plain(value) for name, value in start.controller.items() if name not in arrays}
    inner.attrs["values"] = json.dumps(rest, sort_keys=True)  # JSON keeps what is None, and floats to the last bit
    group.attrs["clock"] = json.dumps([_plain(value) for value in start.clock])
    group.attrs["scene"] = start.scene


def read_start(group: Any) -> Snapshot:  # noqa: ANN401  h5py is untyped
    """What :func:`write_start` wrote; raises ``KeyError`` and ``ValueError`` for what it did not."""
    inner = group[_CONTROLLER]
    controller: dict[str, Any] = {name: inner[name][()] for name in inner}
    controller |= json.loads(inner.attrs["values"])
    steps, seconds, done = json.loads(group.attrs["clock"])
    arrays = {name: group[name][()] for name in _ARRAYS}
    return Snapshot(**arrays, controller=controller, clock=(steps, seconds, done), scene=str(group.attrs["scene"]))


def write_hidden(group: Any, hidden: HiddenStates) -> None:  # noqa: ANN401  h5py is untyped
    """Write ``hidden`` into ``group``."""
    for name in _STACKED:
        group.create_dataset(name, data=getattr(hidden, name), **PACKED)
    inner = group.create_group(_CONTROLLER)
    for name, values in sorted(hidden.controller.items()):
        inner.create_dataset(name, data=values, **PACKED)


def read_hidden(group: Any) -> HiddenStates:  # noqa: ANN401  h5py is untyped
    """What :func:`write_hidden` wrote; raises ``KeyError`` and ``ValueError`` for what it did not."""
    inner = group[_CONTROLLER]
    arrays = {name: group[name][()] for name in _STACKED}
    return HiddenStates(**arrays, controller={name: inner[name][()] for name in inner})


def _plain(value: Any) -> Any:  # noqa: ANN401  a number, a truth value or None
    return value.item() if isinstance(value, np.generic) else value
