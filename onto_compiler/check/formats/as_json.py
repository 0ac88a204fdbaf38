"""For programs: ``{"problems": [...]}`` with the fields of :class:`~onto_compiler.problems.Problem`."""

from __future__ import annotations

import json

from onto_compiler.check.formats.checked import Checked

__all__ = ["render"]


def render(checked: Checked) -> str:
    """One JSON object."""
    record = {"problems": [problem.as_dict() for problem in checked.problems]}
    return json.dumps(record, indent=2, ensure_ascii=False) + "\n"
