"""LIBERO's task files: text to syntax tree and back, and from the tree to the typed facts that a task requires."""

from onto_compiler.bddl.ast import TaskSpec
from onto_compiler.bddl.lift import lift, required_abox
from onto_compiler.bddl.parse import parse, parse_file
from onto_compiler.bddl.printer import format_task

__all__ = ["TaskSpec", "format_task", "lift", "parse", "parse_file", "required_abox"]
