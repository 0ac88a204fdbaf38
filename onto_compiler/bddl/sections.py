"""The sections of a task file: the grammar's name of each, and the keyword that it begins with."""

from __future__ import annotations

from typing import Final

__all__ = ["KEYWORDS", "NEEDED"]

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
NEEDED: Final = ("problem", "domain", "language", "init", "goal")
