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
TOO_MANY: Final = "BDDL014"
UNDECLARED_TARGET: Final = "BDDL015"
FOREIGN_DOMAIN: Final = "BDDL016"
SPLIT_CATEGORY: Final = "BDDL017"
EMPTY_GOAL: Final = "BDDL018"
NO_GROUNDING: Final = "BDDL019"
NO_BINDING: Final = "BDDL020"
EMPTY_QUANTIFIER: Final = "BDDL021"
UNBOUND_VARIABLE: Final = "BDDL022"
OPEN_CATEGORY: Final = "BDDL023"
CONTRADICTION: Final = "BDDL024"
TWO_SUPPORTS: Final = "BDDL025"
ITSELF: Final = "BDDL026"
OPPOSITES: Final = "BDDL027"
ALREADY_TRUE: Final = "BDDL028"
STRANGE_LANGUAGE: Final = "BDDL029"
NEVER_PLACED: Final = "BDDL030"
DUPLICATE_ATOM: Final = "BDDL031"
PASSED_OVER: Final = "BDDL032"
TOO_LARGE: Final = "BDDL033"
IGNORED_ROTATION: Final = "BDDL034"

ALL_CODES: Final = tuple(f"BDDL{number:03d}" for number in range(1, 35))
"""Every code above, in order."""
