"""A device that is not there: tensors on it compute on the CPU, and refuse the company of tensors that are not on it.

As on a GPU, an operation takes tensors of one device, whatever has no dimension aside, and numpy reads none of it. So
code that would fail on a GPU, since it forgot to move something there, fails here too, without a GPU.
"""

from __future__ import annotations

from contextlib import ExitStack
from importlib import import_module
from typing import Any, Self
from unittest.mock import patch

import torch
from torch.overrides import TorchFunctionMode
from torch.utils._python_dispatch import TorchDispatchMode, return_and_correct_aliasing
from torch.utils._pytree import tree_any, tree_flatten, tree_map

__all__ = ["DEVICE", "Gpu"]

DEVICE = "meta"
"""Its name: the one device without a memory of its own, to which autograd gives no thread."""
_MOVES = {"aten::_to_copy", "aten::copy_"}
_INDEXED = {torch.Tensor.__getitem__, torch.Tensor.__setitem__}
_INDICES = {"aten::index.Tensor", "aten::index_put", "aten::index_put_", "aten::_index_put_impl_"}


class Afar(torch.Tensor):
    """A tensor on the device; ``held`` is what it really is."""

    held: torch.Tensor

    @staticmethod
    def __new__(cls, held: torch.Tensor) -> Self:
        made = torch.Tensor._make_wrapper_subclass(
            cls, held.shape, strides=held.stride(), storage_offset=held.storage_offset(), dtype=held.dtype,
            device=DEVICE, requires_grad=False,
        )  # fmt: skip
        made.held = held
        return made

    def __repr__(self) -> str:  # the base class's would read values
        return f"Afar({self.held!r})"

    @classmethod
    def __torch_dispatch__(cls, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        return _computed(func, args, kwargs or {})


class _Made(TorchFunctionMode):
    """What is made of Python's numbers, by ``torch.tensor`` or as indices, reaches a device without a dispatch."""

    def __torch_function__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        kwargs = kwargs or {}
        if func is torch.tensor and kwargs.get("device") is not None:
            return func(*args, **{**kwargs, "device": "cpu"}).to(kwargs["device"])
        if func in _INDEXED:
            tensor, index, *rest = args
            parts = index if isinstance(index, tuple) else (index,)
            given = tuple(torch.tensor(part) if isinstance(part, list) else part for part in parts)
            return func(tensor, given, *rest)
        return func(*args, **kwargs)


class Gpu(TorchDispatchMode):
    """While it is entered, ``DEVICE`` is one to compute on; ``operations`` counts what was computed there."""

    def __init__(self) -> None:
        super().__init__()
        self.operations, self._besides = 0, ExitStack()

    def __enter__(self) -> Self:
        optimizer = import_module("torch.optim.optimizer")
        fused = patch.object(optimizer, "_get_fused_kernels_supported_devices", lambda: ["cpu", DEVICE])
        self._besides.enter_context(_Made())
        self._besides.enter_context(fused)
        return super().__enter__()

    def __exit__(self, *about: object) -> None:
        super().__exit__(*about)
        self._besides.close()

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        self.operations += tree_any(_afar, (args, kwargs))
        return _computed(func, args, kwargs or {})


def _afar(value: Any) -> bool:
    return isinstance(value, Afar)


def _computed(func: Any, args: Any, kwargs: dict[str, Any]) -> Any:
    """``func`` on what the tensors really are, and its results back on the device that they belong to."""
    tensors = [value for value in tree_flatten((args, kwargs))[0] if isinstance(value, torch.Tensor)]
    there = any(map(_afar, tensors))
    name = func.name()
    asked = kwargs.get("device")
    if name not in _MOVES:
        alike = tensors[:1] if name in _INDICES else tensors
        lost = [tensor for tensor in alike if not _afar(tensor) and tensor.ndim]
        if there and lost:
            raise RuntimeError(f"{name}: expected all tensors on one device, and {tuple(lost[0].shape)} is on the CPU")
    if any(tensor.device.type == DEVICE and not _afar(tensor) for tensor in tensors):
        raise NotImplementedError(f"{name}: a tensor was made past what pretends to be its device")
    if asked is not None:
        there = torch.device(asked).type == DEVICE
        kwargs = {**kwargs, "device": "cpu"}
    elif name == "aten::copy_":
        there = _afar(args[0])
    result = func(*tree_map(_near, args), **tree_map(_near, kwargs))
    if not there:
        return result
    return return_and_correct_aliasing(func, args, kwargs, tree_map(_sent, result))


def _near(value: Any) -> Any:
    return value.held if _afar(value) else value


def _sent(value: Any) -> Any:
    return Afar(value) if isinstance(value, torch.Tensor) and not _afar(value) else value
