"""The files that fuzzing starts from, each cut into the pieces that its mutations move about."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import ontology
from onto_compiler.turtle.tokens import tokens
from runtime.worlds.libero.simulator.assets import tasks

__all__ = ["BDDL", "SUITES", "TURTLE", "Part", "Seed", "parts", "seeds", "split"]

BDDL, TURTLE = "bddl", "ttl"
SUITES = {"libero_spatial": 10, "libero_object": 10, "libero_goal": 10, "libero_10": 10, "libero_90": 90}
_ROOT = Path(__file__).resolve().parent.parent
_EXAMPLES = _ROOT / "docs" / "examples"
_TESTS = _ROOT / "tests" / "onto_compiler"
_BDDL_PIECE = re.compile(r";[^\n]*|[()]|[^\s();]+|\s+")
_OPENING = {"(": ")", "[": "]"}

Part = tuple[int, int]  # pieces from the first up to the second, which is exclusive


@dataclass(frozen=True, slots=True)
class Seed:
    """A file that a person wrote: ``pieces`` are its tokens and what stands between them, and join to its text."""

    name: str
    language: str
    pieces: tuple[str, ...]


@cache
def seeds(language: str) -> tuple[Seed, ...]:
    """Every seed of a language, in a fixed order: LIBERO's tasks or our ontology, then examples and tests' files.

    Raises:
        OntoError: SIM010 if LIBERO is not installed.
    """
    if language == BDDL:
        files = [task.bddl for suite in SUITES for task in tasks(suite)]
        folders = [_EXAMPLES, _TESTS / "bddl", _TESTS / "bddl" / "broken"]
    else:
        files = list(ontology.turtle_files())
        folders = [_EXAMPLES, _TESTS / "check" / "good", _TESTS / "check" / "broken"]
    files += [file for folder in folders for file in sorted(folder.glob(f"*.{language}"))]
    found = []
    for file in files:
        # What is not UTF-8 among the broken files stays apart: a mutation breaks the encoding of others.
        text = file.read_bytes().decode("utf-8", errors="replace")
        found.append(Seed(file.name, language, split(text, language)))
    return tuple(found)


def split(text: str, language: str) -> tuple[str, ...]:
    """``text`` as pieces that join to it again."""
    if language == BDDL:
        return tuple(_BDDL_PIECE.findall(text))
    pieces, end = [], 0
    for token in tokens(text):
        if token.start > end:
            pieces.append(text[end : token.start])
        pieces.append(token.text)
        end = token.end
    if end < len(text):
        pieces.append(text[end:])
    return tuple(pieces)


def parts(pieces: list[str], language: str) -> list[Part]:
    """What belongs together: each bracket with its contents and, in Turtle, each statement and each of its clauses."""
    found: list[Part] = []
    stack: list[tuple[str, int, int]] = []  # the closing bracket, where it opened, where its present clause began
    statement = clause = 0
    for place, piece in enumerate(pieces):
        if piece in _OPENING:
            stack.append((_OPENING[piece], place, clause))
            clause = place + 1
        elif stack and piece == stack[-1][0]:
            _, opened, clause = stack.pop()
            found.append((opened, place + 1))
        elif language == TURTLE and piece in {";", "."}:
            found.append((clause, place + 1))
            clause = place + 1
            if piece == "." and not stack:
                found.append((statement, clause))
                statement = clause
    return found
