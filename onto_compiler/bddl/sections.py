"""The sections of a task file: the grammar's name of each, the keyword it begins with; and what binds variables."""

from __future__ import annotations

from typing import Final

__all__ = ["KEYWORDS", "QUANTIFIERS"]

KEYWORDS: Final = {
    "problem": "problem",
    "domain": ":domain",
    "requirements": ":requirements",
    "language": ":language",
    "regions": ":regions",
    "fixtures": ":fixtures",
    "objects": ":objects",
    "interest": ":obj_of_interest",
    "scene": ":scene_properties",
    "init": ":init",
    "goal": ":goal",
}
QUANTIFIERS: Final = frozenset({"exists", "forall", "forn", "fornpairs", "forpairs"})
