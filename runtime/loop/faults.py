"""What a run can break off with."""

from __future__ import annotations

__all__ = ["RunFault"]


class RunFault(Exception):  # noqa: N818 - the ontology's own name for it
    """A run that broke off: a number that is not finite, or a crash. Never a statement about the task.

    ``snapshot`` is the last good state where one is known.
    """

    def __init__(self, message: str, snapshot: object = None) -> None:
        super().__init__(message)
        self.snapshot = snapshot
