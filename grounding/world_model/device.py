"""Where torch computes: ``cpu``, ``cuda``, ``cuda:1``, or ``auto`` for a GPU where there is one."""

from __future__ import annotations

import torch

from onto_compiler.problems import OntoError

__all__ = ["device_named", "use_threads"]


def device_named(name: str = "auto") -> str:
    """The device called ``name``, after something was stored on it.

    Raises:
        OntoError: ``WM012``, where torch has no such device here.
    """
    if name == "auto":
        return "cuda" if torch.cuda.is_available() else "cpu"
    try:
        torch.zeros(1, device=name)
    except (RuntimeError, AssertionError, NotImplementedError) as error:  # each of them for another kind of name
        message = f"torch cannot compute on `{name}`: {str(error).partition(chr(10))[0]}"
        raise OntoError.of(
            "WM012", message, "`cpu` works everywhere; a GPU needs a build of torch with CUDA"
        ) from error
    return name


def use_threads(count: int) -> None:
    """Let torch compute with ``count`` threads of the CPU."""
    torch.set_num_threads(count)
