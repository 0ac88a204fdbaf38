"""A training that is stopped on the way, as by a person or a lost machine."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from runtime.training import fit

__all__ = ["interrupted"]


class _StoppedError(Exception):
    pass


@contextmanager
def interrupted(saves: int) -> Iterator[None]:
    """In here each step of a training is kept, and it stops once ``saves`` are; fails where it does not stop."""
    save, count = fit.save, 0

    def stop(*arguments: object) -> None:
        nonlocal count
        save(*arguments)
        count += 1
        if count == saves:
            raise _StoppedError

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fit, "_SAVE_EVERY", 0.0)
        patch.setattr(fit, "save", stop)
        with pytest.raises(_StoppedError):
            yield
