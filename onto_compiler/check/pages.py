"""The page of each code: ``docs/errors/CODE.md``, which the package holds as ``onto_compiler/errors``.

``python -m onto_compiler.check.pages`` prints their index, ``docs/errors/README.md``.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

__all__ = ["FOLDER", "codes", "index", "page", "titles"]

_PACKAGED = Path(__file__).resolve().parent.parent / "errors"
# A checkout without symbolic links has a file there.
FOLDER = _PACKAGED if _PACKAGED.is_dir() else _PACKAGED.parent.parent / "docs" / "errors"


def codes() -> tuple[str, ...]:
    """Every code that has a page."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.md") if re.fullmatch(r"[A-Z]+\d{3}", path.stem)))


def page(code: str) -> str | None:
    """The page of ``code``; None if there is no such code."""
    return (FOLDER / f"{code}.md").read_text(encoding="utf-8") if code in codes() else None


def titles() -> dict[str, str]:
    """What each code means, in a few words."""
    return {code: (page(code) or "").partition("\n")[0].removeprefix(f"# {code}: ") for code in codes()}


def index() -> str:
    """A table of all pages with their titles, as Markdown."""
    rows = [f"| [{code}]({code}.md) | {title} |" for code, title in titles().items()]
    head = ["# Problems", "", "What each code means; `onto explain CODE` prints the same page.", ""]
    return "\n".join([*head, "| Code | Meaning |", "| --- | --- |", *rows, ""])


if __name__ == "__main__":
    sys.stdout.write(index())
