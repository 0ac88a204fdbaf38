"""For code scanning: SARIF 2.1.0, with each code's page as the help of its rule.

Source: OASIS, Static Analysis Results Interchange Format (SARIF) Version 2.1.0.
"""

from __future__ import annotations

import json
import re
from pathlib import PurePath
from typing import Any
from urllib.parse import quote

from onto_compiler.check.formats.checked import Checked
from onto_compiler.check.pages import page
from onto_compiler.problems import Problem

__all__ = ["SCHEMA", "render"]

SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
_LEVELS = ("note", "warning", "error")
_ROOT = "%SRCROOT%"  # what code scanning resolves to the root of the checkout


def render(checked: Checked) -> str:
    """One log with one run."""
    codes = sorted({problem.code for problem in checked.problems})
    levels: dict[str, str] = {}
    for problem in checked.problems:
        level = _level(problem)
        levels[problem.code] = max(level, levels.get(problem.code, level), key=_LEVELS.index)  # the gravest
    run = {
        "tool": {"driver": {"name": "onto", "rules": [_rule(code, levels[code]) for code in codes]}},
        "columnKind": "unicodeCodePoints",
        "artifacts": [{"location": _artifact(file)} for file in checked.files],
        "results": [_result(problem, codes.index(problem.code)) for problem in checked.problems],
    }
    log = {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}
    return json.dumps(log, indent=2, ensure_ascii=False) + "\n"


def _level(problem: Problem) -> str:
    return "note" if problem.severity == "info" else problem.severity


def _rule(code: str, level: str) -> dict[str, Any]:
    text = (page(code) or f"# {code}: {code}\n").strip()
    title, _, body = text.partition("\n")
    why = re.search(r"(?s)## Why it matters\n+(.*?)(?:\n\n|$)", body)
    return {
        "id": code,
        "shortDescription": {"text": title.removeprefix(f"# {code}: ")},
        "fullDescription": {"text": why[1].replace("\n", " ") if why else title.removeprefix("# ")},
        "help": {"text": body.strip() or title, "markdown": body.strip() or title},
        "defaultConfiguration": {"level": level},
    }


def _result(problem: Problem, index: int) -> dict[str, Any]:
    message = f"{problem.message}\n{problem.hint}" if problem.hint else problem.message
    result: dict[str, Any] = {
        "ruleId": problem.code,
        "ruleIndex": index,
        "level": _level(problem),
        "message": {"text": message},
    }
    if problem.file:
        place: dict[str, Any] = {"artifactLocation": _artifact(problem.file)}
        if problem.line:
            place["region"] = _region(problem)
        result["locations"] = [{"physicalLocation": place}]
    return result


def _region(problem: Problem) -> dict[str, int]:
    """Where the problem starts and, where that is known, ends; the end is exclusive, as SARIF has it."""
    start = (problem.line, max(problem.column, 1))
    end = (problem.end_line, problem.end_column)
    region = {"startLine": start[0], "startColumn": start[1]}
    return region | {"endLine": end[0], "endColumn": end[1]} if end >= start else region


def _artifact(file: str) -> dict[str, str]:
    path = PurePath(file)
    if path.is_absolute():
        return {"uri": path.as_uri()}
    return {"uri": quote(path.as_posix()), "uriBaseId": _ROOT}
