"""The fault that ends a run early."""

from __future__ import annotations

__all__ = ["RunFault"]


class RunFault(Exception):  # noqa: N818 - the ontology's own name for it
    """A run that ended early: a number that is not finite, or a crash. It says nothing about the task.

    ``snapshot`` is the last good state, if there is one.
    """

    def __init__(self, message: str, snapshot: object = None) -> None:
        super().__init__(message)
        self.snapshot = snapshot
