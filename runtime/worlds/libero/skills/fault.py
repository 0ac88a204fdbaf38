"""Why a skill gave up."""

from __future__ import annotations

__all__ = ["SkillFault"]


class SkillFault(Exception):  # noqa: N818 - a finding about the attempt, not an error of the program
    """A skill that cannot continue; ``kind`` is one of ``unreachable``, ``lost``, ``missed`` or ``blocked``."""

    def __init__(self, kind: str, message: str) -> None:
        super().__init__(message)
        self.kind = kind
