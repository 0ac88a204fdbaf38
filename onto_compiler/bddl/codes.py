"""The code of each fault that a task file can have; each has a page in ``docs/errors``."""

from __future__ import annotations

from typing import Final

__all__ = ["ALL_CODES"]

SYNTAX: Final = "BDDL001"
UNBALANCED: Final = "BDDL002"
UNKNOWN_PREDICATE: Final = "BDDL003"
UNREADABLE: Final = "BDDL004"
MISSING_PART: Final = "BDDL005"
REPEATED_PART: Final = "BDDL006"
DUPLICATE_DECLARATION: Final = "BDDL007"
NOT_A_NUMBER: Final = "BDDL008"
NUMBER_COUNT: Final = "BDDL009"
UNKNOWN_NAME: Final = "BDDL010"
ARGUMENT_COUNT: Final = "BDDL011"
ARGUMENT_TYPE: Final = "BDDL012"
NO_THRESHOLD: Final = "BDDL013"
DISJUNCTION: Final = "BDDL014"
UNDECLARED_TARGET: Final = "BDDL015"
FOREIGN_DOMAIN: Final = "BDDL016"
SPLIT_CATEGORY: Final = "BDDL017"
EMPTY_GOAL: Final = "BDDL018"
NO_GROUNDING: Final = "BDDL019"

ALL_CODES: Final = tuple(f"BDDL{number:03d}" for number in range(1, 20))
"""Every code above, in order."""
