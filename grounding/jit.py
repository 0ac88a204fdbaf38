"""Numba's compiler as this project uses it: kept on disk where that is possible, compiled anew where it is not."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit

__all__ = ["compiled"]

F = TypeVar("F", bound=Callable[..., Any])
_LOG = logging.getLogger("onto_evwm.numba")


def compiled(function: F) -> F:
    """``function`` compiled at its first call; a division by zero gives what IEEE 754 says, as in numpy.

    Whoever divides looks at the result: an exception would cost a branch in each loop.

    What was compiled is kept where ``NUMBA_CACHE_DIR`` says, beside the source, or in the user's cache folder. Where
    none of them can be written every process compiles for itself, which takes some ten seconds.
    """
    try:
        return cast("F", njit(cache=True, error_model="numpy")(function))
    except RuntimeError as error:  # numba found no folder for its cache
        _LOG.warning("compiled code cannot be kept, and each process compiles it anew: %s", error)
        return cast("F", njit(error_model="numpy")(function))
