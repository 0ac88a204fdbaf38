"""From a task file to its required ABox."""

from __future__ import annotations

from onto_compiler.bddl.conditions import with_preconditions
from onto_compiler.bddl.lift import required_abox
from onto_compiler.bddl.parse import parse, parse_file
from onto_compiler.knowledge import Knowledge
from onto_compiler.required import RequiredABox
from runtime.worlds.world import TaskRef

__all__ = ["required_of"]


def required_of(ref: TaskRef, knowledge: Knowledge, *, ordered: bool = False) -> RequiredABox:
    """Compile a task's file to its required ABox, with the preconditions of its facts where it is to be ``ordered``.

    A suite's file is named ``SUITE/TASK.bddl`` in the record, so that the same run makes the same trace everywhere.
    """
    spec = parse(ref.bddl.read_text(encoding="utf-8"), f"{ref.suite}/{ref.bddl.name}") if ref.suite else None
    spec = spec or parse_file(ref.bddl)
    required = required_abox(spec, knowledge.schema, ref.name)
    return with_preconditions(required, spec, knowledge.schema) if ordered else required
