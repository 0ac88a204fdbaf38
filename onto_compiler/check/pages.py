"""The page of each code, ``onto_compiler/errors/CODE.md``; and the index of them all, ``docs/errors/README.md``.

``python -m onto_compiler.check.pages`` prints the index; a test holds the file equal to it.
"""

from __future__ import annotations

import sys
from pathlib import Path

__all__ = ["FOLDER", "codes", "index", "page"]

FOLDER = Path(__file__).resolve().parent.parent / "errors"


def codes() -> tuple[str, ...]:
    """Every code that has a page."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.md")))


def page(code: str) -> str | None:
    """The page of ``code``; None where there is no such code."""
    return (FOLDER / f"{code}.md").read_text(encoding="utf-8") if code in codes() else None


def index() -> str:
    """A table of all codes with the title of their pages, as Markdown."""
    rows = []
    for code in codes():
        title = (FOLDER / f"{code}.md").read_text(encoding="utf-8").partition("\n")[0]
        name = title.removeprefix(f"# {code}: ")
        rows.append(f"| [{code}](../../onto_compiler/errors/{code}.md) | {name} |")
    head = ["# Problems", "", "What each code means; `onto explain CODE` prints the same page.", ""]
    return "\n".join([*head, "| Code | Meaning |", "| --- | --- |", *rows, ""])


if __name__ == "__main__":
    sys.stdout.write(index())
