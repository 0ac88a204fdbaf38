"""For people: each problem with its line and a caret, as a compiler prints it."""

from __future__ import annotations

from onto_compiler.check.formats.checked import Checked
from onto_compiler.problems import render as render_problem

__all__ = ["render"]


def render(checked: Checked) -> str:
    """Every problem, an empty line behind each."""
    return "".join(render_problem(problem, checked.text(problem.file)) + "\n\n" for problem in checked.problems)
