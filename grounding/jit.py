"""Numba's compiler as this project uses it: kept on disk where that is possible, compiled again where it is not."""

from __future__ import annotations

import logging
import pickle
from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit
from numba.core.caching import FunctionCache

__all__ = ["compiled"]

F = TypeVar("F", bound=Callable[..., Any])
_LOG = logging.getLogger("onto_evwm.numba")


_FunctionCache: Any = FunctionCache  # numba's own classes are untyped


class _Cache(_FunctionCache):  # type: ignore[misc]  # as above
    """Numba's cache of one function, for which a damaged file is none and a full disk no reason to stop."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:  # noqa: ANN401  as declared by numba
        try:
            return super().load_overload(sig, target_context)
        except (pickle.UnpicklingError, EOFError, ValueError, TypeError, AttributeError, ImportError) as error:
            _LOG.warning("the compiled code of %s is damaged and will be compiled again: %s", self._name, error)
            self.flush()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:  # noqa: ANN401  as declared by numba
        try:
            super().save_overload(sig, data)
        except OSError as error:
            _LOG.warning("the compiled code of %s cannot be kept: %s", self._name, error)


def compiled(function: F) -> F:
    """``function`` compiled at its first call; a division by zero gives what IEEE 754 says, as in numpy.

    Whoever divides looks at the result: an exception would cost a branch in each loop.

    What was compiled is kept where ``NUMBA_CACHE_DIR`` says, beside the source, or in the user's cache folder. Where
    none of them can be written every process compiles for itself, which takes some ten seconds.
    """
    made: Any = njit(error_model="numpy")(function)
    try:
        made._cache = _Cache(function)  # noqa: SLF001  what `cache=True` does, with numba's own class
    except RuntimeError as error:  # numba found no folder for its cache
        _LOG.warning("compiled code cannot be kept, and each process compiles it anew: %s", error)
    return cast("F", made)
