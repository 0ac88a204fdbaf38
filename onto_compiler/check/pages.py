"""The page of each code, ``onto_compiler/errors/CODE.md``; and their index, ``docs/errors/README.md``.

``python -m onto_compiler.check.pages`` prints the index; a test holds the file equal to it.
"""

from __future__ import annotations

import sys
from pathlib import Path

__all__ = ["FOLDER", "codes", "index", "page"]

FOLDER = Path(__file__).resolve().parent.parent / "errors"
_ELSEWHERE = FOLDER.parent.parent / "docs" / "errors"  # pages that only a checkout holds


def codes() -> tuple[str, ...]:
    """Every code that has a page."""
    return tuple(sorted(_pages()))


def page(code: str) -> str | None:
    """The page of ``code``; None where there is no such code."""
    path = _pages().get(code)
    return path.read_text(encoding="utf-8") if path else None


def _pages() -> dict[str, Path]:
    found = [*_ELSEWHERE.glob("[A-Z]*[0-9].md"), *FOLDER.glob("[A-Z]*[0-9].md")]
    return {path.stem: path for path in found}


def index() -> str:
    """A table of the packaged pages, as Markdown."""
    rows = []
    for path in sorted(FOLDER.glob("*.md")):
        title = path.read_text(encoding="utf-8").partition("\n")[0].removeprefix(f"# {path.stem}: ")
        rows.append(f"| [{path.stem}](../../onto_compiler/errors/{path.stem}.md) | {title} |")
    head = ["# Problems", "", "What each code of `onto check` means; `onto explain CODE` prints the same page.", ""]
    return "\n".join([*head, "| Code | Meaning |", "| --- | --- |", *rows, ""])


if __name__ == "__main__":
    sys.stdout.write(index())
