"""For code scanning: SARIF 2.1.0, with each code's page as the help of its rule.

Source: OASIS, Static Analysis Results Interchange Format (SARIF) Version 2.1.0.
"""

from __future__ import annotations

import json
import re
from pathlib import PurePath
from typing import Any
from urllib.parse import quote

from onto_compiler.check.formats.checked import Checked, Repair
from onto_compiler.check.pages import page
from onto_compiler.problems import Problem, Span
from onto_compiler.rdf import BASE
from onto_compiler.versions import version_of

__all__ = ["SCHEMA", "render"]

SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
_LEVELS = ("note", "warning", "error")
_SHAPE = "SHP001"
_ROOT = "%SRCROOT%"  # what code scanning resolves to the root of the checkout


def render(checked: Checked) -> str:
    """One log with one run."""
    levels: dict[str, str] = {}
    first: dict[str, Problem] = {}
    for problem in checked.problems:
        level, name = _level(problem), _rule_id(problem)
        levels[name] = max(level, levels.get(name, level), key=_LEVELS.index)  # the gravest
        first.setdefault(name, problem)
    rules = sorted(levels)
    driver: dict[str, Any] = {"name": "onto", "informationUri": BASE}
    if (known := version_of("onto-evwm")) is not None:
        driver["version"] = known
    run = {
        "tool": {"driver": driver | {"rules": [_rule(name, levels[name], first[name]) for name in rules]}},
        "columnKind": "unicodeCodePoints",
        "artifacts": [{"location": _artifact(file)} for file in checked.files],
        "results": [_result(problem, rules.index(_rule_id(problem)), checked) for problem in checked.problems],
    }
    log = {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}
    return json.dumps(log, indent=2, ensure_ascii=False) + "\n"


def _level(problem: Problem) -> str:
    return "note" if problem.severity == "info" else problem.severity


def _rule_id(problem: Problem) -> str:
    """The code; of a violated shape of the user's own also the shape's name, so that each is a rule of its own."""
    if problem.result is None or problem.code != _SHAPE:
        return problem.code
    return f"{problem.code}/{problem.result['shape']['name']}"


def _rule(name: str, level: str, problem: Problem) -> dict[str, Any]:
    code = problem.code
    text = (page(code) or f"# {code}: {code}\n").strip()
    title, _, body = text.partition("\n")
    why = re.search(r"(?s)## Why it matters\n+(.*?)(?:\n\n|$)", body)
    short = title.removeprefix(f"# {code}: ")
    if problem.result is not None and name != code:
        shape = problem.result["shape"]
        short = f"{short}: {shape['label'] or shape['name']}"
    return {
        "id": name,
        "shortDescription": {"text": short},
        "fullDescription": {"text": why[1].replace("\n", " ") if why else title.removeprefix("# ")},
        "help": {"text": body.strip() or title, "markdown": body.strip() or title},
        "defaultConfiguration": {"level": level},
    }


def _result(problem: Problem, index: int, checked: Checked) -> dict[str, Any]:
    message = f"{problem.message}\n{problem.hint}" if problem.hint else problem.message
    result: dict[str, Any] = {
        "ruleId": _rule_id(problem),
        "ruleIndex": index,
        "level": _level(problem),
        "message": {"text": message},
    }
    if problem.file:
        place: dict[str, Any] = {"artifactLocation": _artifact(problem.file)}
        if problem.line:
            place["region"] = _region(problem)
        result["locations"] = [{"physicalLocation": place}]
    if problem.result is not None:
        result["properties"] = dict(problem.result)
    if problem in checked.repairs:
        result["fixes"] = [_fix(problem.file, checked.repairs[problem])]
    return result


def _fix(file: str, repair: Repair) -> dict[str, Any]:
    replaced = {"deletedRegion": _region(repair.span), "insertedContent": {"text": repair.text}}
    change = {"artifactLocation": _artifact(file), "replacements": [replaced]}
    return {"description": {"text": repair.done}, "artifactChanges": [change]}


def _region(problem: Problem | Span) -> dict[str, int]:
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
