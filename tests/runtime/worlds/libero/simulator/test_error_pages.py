from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[5]
FOLDERS = ("docs/errors", "onto_compiler/errors")


def test_every_fault_of_the_simulator_has_a_page_and_every_page_a_fault():
    sources = [path for package in ("grounding", "runtime") for path in (ROOT / package).rglob("*.py")]
    raised = {code for path in sources for code in re.findall(r'"(SIM\d{3})"', path.read_text(encoding="utf-8"))}
    pages = {path.stem: path for folder in FOLDERS for path in (ROOT / folder).glob("SIM*.md")}
    assert raised == set(pages)
    assert len(raised) >= 14
    for code, path in pages.items():
        text = path.read_text(encoding="utf-8")
        assert text.startswith(f"# {code}: ")
        assert [h for h in text.splitlines() if h.startswith("## ")] == [
            "## What it means",
            "## Why it matters",
            "## Example",
            "## Use instead",
        ]
