"""Generated shapes, data and queries damaged as people and disks damage files, each put through a whole command."""

from __future__ import annotations

import contextlib
import io
import random
from collections.abc import Mapping
from pathlib import Path

from benchmarks.fuzz_inputs import ENCODINGS, MUTATIONS
from benchmarks.fuzz_seeds import TURTLE, split
from benchmarks.wild_queries import CONSTRAINTS
from benchmarks.wild_shapes import PREFIXES, pair
from runtime.cli import main

__all__ = ["damaged", "run_quietly"]

# Those of the fuzzing protocol that take nothing from other files, and stay small.
_OF_TOKENS = (
    *("delete", "duplicate", "swap", "rename", "word", "bracket", "number", "letter", "unicode"),
    *("drop", "repeat", "exchange", "move"),
)
_OF_BYTES = ("flipped byte", "NUL", "lone byte", "cut off")


def damaged(number: int) -> tuple[dict[str, bytes], tuple[str, ...]]:
    """The files by name, one of which is damaged, and the command that reads them; equal numbers give equal files."""
    rng = random.Random(number)  # noqa: S311 - reproducible by design, and no secret
    files = dict(pair(number).files)
    kind = rng.choice(("shapes", "shapes", "data", "query"))
    words: tuple[str, ...]
    if kind == "query":
        query = rng.choice(CONSTRAINTS).replace("$PATH", "ex:p")
        for slot, value in {"p": "ex:p", "q": "ex:q", "c": "ex:A", "v": '"a"', "n": "1"}.items():
            query = query.replace(f"@{slot}@", value)
        files = {"question.rq": f"PREFIX ex: <https://example.org/>\n{query}", "data.ttl": files["data.ttl"]}
        name, words = "question.rq", ("trace", "query", "question.rq", "data.ttl")
    else:
        words = ("check", "data.ttl", "--shapes", "shapes.ttl") if rng.random() < 0.8 else ("check", f"{kind}.ttl")
        name = f"{kind}.ttl"
    written = {one: text.encode() for one, text in files.items()}
    written[name] = _damage(rng, files[name])
    return written, words


def _damage(rng: random.Random, text: str) -> bytes:
    if rng.random() < 0.3:
        return ENCODINGS[rng.choice(_OF_BYTES)](rng, text.encode())
    head = PREFIXES if text.startswith(PREFIXES) else ""
    pieces = list(split(text.removeprefix(head), TURTLE))
    for name in rng.choices(_OF_TOKENS, k=rng.randint(1, 3)):
        pieces = MUTATIONS[name](rng, pieces, TURTLE) if pieces else pieces
    return (head + "".join(pieces)).encode("utf-8", errors="replace")


def run_quietly(files: Mapping[str, bytes], words: tuple[str, ...], folder: Path) -> tuple[int, str]:
    """The exit code of ``onto`` with ``words`` in ``folder``, where ``files`` are written, and what it printed."""
    for name, data in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    printed = io.StringIO()
    with contextlib.chdir(folder), contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        code = main(words)
    return code, printed.getvalue()
