"""Records as nested tuples under which equality is exact: dtypes, NaN and the sign of zero count."""

from __future__ import annotations

import dataclasses

import numpy as np


def plain(value):
    """A comparable form of a record, an array or a number."""
    if dataclasses.is_dataclass(value):
        pairs = ((field.name, plain(getattr(value, field.name))) for field in dataclasses.fields(value))
        return (type(value).__name__, *pairs)
    if isinstance(value, np.ndarray):
        return ("array", str(value.dtype), value.shape, repr(value.tolist()))
    if isinstance(value, (tuple, list)):
        return tuple(plain(item) for item in value)
    return (type(value).__name__, repr(value))
