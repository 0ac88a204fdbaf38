"""Text to syntax tree. Every problem of a file is collected: broken parts are skipped, and the rest is parsed."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from importlib import resources
from pathlib import Path

from lark import Lark, Token, Tree, UnexpectedToken

from onto_compiler.bddl import codes
from onto_compiler.bddl.ast import Domain, TaskSpec
from onto_compiler.bddl.build import build, build_domain
from onto_compiler.bddl.expected import syntax_problem
from onto_compiler.bddl.groups import MAX_DEPTH, Group, groups, swallowed, too_deep, unbalanced
from onto_compiler.problems import OntoError, Problem, Span, near

__all__ = ["decode", "parse", "parse_domain", "parse_file", "read_bytes", "read_text"]

# Tasks that people write have up to 12,000 characters, and words of up to 80.
MAX_SIZE = 65_536
MAX_WORD = 1_024
LONG_WORD = re.compile(rf"[^\s();]{{{MAX_WORD + 1},}}")
MAX_AGAIN = 2 * MAX_SIZE  # characters that are read again to look for further syntax errors


def parse_file(path: str | Path) -> TaskSpec:
    """Read the task file at ``path`` (UTF-8).

    Raises:
        OntoError: the file cannot be read, or is not a well-formed task.

    """
    return parse(read_text(Path(path)), str(path))


def read_text(path: Path) -> str:
    """The text of the file at ``path``; raises BDDL004 where it cannot be read or is not UTF-8."""
    return decode(read_bytes(path), str(path))


def read_bytes(path: Path) -> bytes:
    """The content of the file at ``path``; raises BDDL004 where it cannot be read."""
    try:
        return path.read_bytes()
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        hint = _hint(path)
        raise OntoError.of(codes.UNREADABLE, f"the task file cannot be read: {reason}", hint, str(path)) from None


def decode(data: bytes, file: str) -> str:
    """The text that ``data``, the content of ``file``, stands for; raises BDDL004 where it is not UTF-8."""
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8")
        span = _point(file, before + "?", len(before))
        message = f"byte 0x{data[error.start]:02x} is not UTF-8"
        hint = "save the file with the encoding UTF-8"
        raise OntoError(Problem.at(span, codes.UNREADABLE, message, hint)) from None


def parse(text: str, file: str = "<string>") -> TaskSpec:
    """Read the task in ``text``; ``file`` is the name that problems are reported under.

    Raises:
        OntoError: ``text`` is not a well-formed task; the error holds every problem found.

    """
    text = _sound(text, file)
    tree, problems, holes = _read(text, file, "task")
    if tree is not None:
        spec, found = build(tree, file, holes)
        if spec is not None and not problems:
            return spec
        problems += found
    raise OntoError(*problems)


def parse_domain(path: str | Path) -> Domain:
    """Read the domain file at ``path`` (UTF-8): which predicates the tasks of a domain may use.

    Raises:
        OntoError: the file cannot be read, or is not a well-formed domain.

    """
    text = _sound(read_text(Path(path)), str(path))
    tree, problems, _ = _read(text, str(path), "domain_file")
    if tree is not None and not problems:
        domain, found = build_domain(tree, str(path))
        if domain is not None:
            return domain
        problems += found
    raise OntoError(*problems)


def _sound(text: str, file: str) -> str:
    """``text`` with line ends as they are here; raises where its parentheses do not match."""
    if text.startswith("\ufeff"):
        message, hint = "the file starts with a byte-order mark", "save it as UTF-8 without one; LIBERO cannot read it"
        raise OntoError(Problem(file, 1, 1, codes.UNREADABLE, "error", message, hint))
    if len(text) > MAX_SIZE:
        message = f"the file holds {len(text):,} characters; at most {MAX_SIZE:,} are read"
        raise OntoError(Problem(file, 1, 1, codes.TOO_LARGE, "error", message, "write several tasks instead of one"))
    if (long := LONG_WORD.search(text)) is not None:
        message = f"a word of {len(long.group()):,} characters; at most {MAX_WORD:,} are read"
        raise OntoError(Problem.at(_point(file, text, long.start()), codes.TOO_LARGE, message, "shorten it"))
    if "\r" in text:
        text = text.replace("\r\n", "\n").replace("\r", "\n")
    if (slip := unbalanced(text)) is not None:
        raise OntoError(_unbalanced_problem(text, file, *slip))
    if (deep := too_deep(text)) is not None:
        message = f"parentheses are nested more than {MAX_DEPTH} deep"
        raise OntoError(Problem.at(_point(file, text, deep), codes.SYNTAX, message))
    return text


@cache
def _lark() -> Lark:
    grammar = resources.files("onto_compiler.bddl").joinpath("grammar.lark").read_text("utf-8")
    return Lark(grammar, start=["task", "domain_file"], parser="lalr", propagate_positions=True)


def _read(text: str, file: str, start: str) -> tuple[Tree[Token] | None, list[Problem], tuple[Group, ...]]:
    """Parse ``text``; at a syntax error, blank the group that it is in and try again.

    Returns the tree of what is left (None if nothing is, or where too much had to be read again), the problems, and
    the groups that were blanked.
    """
    problems: list[Problem] = []
    blanked: list[Group] = []
    parts: tuple[Group, ...] | None = None
    again = 0
    while True:
        try:
            return _lark().parse(text, start=start), problems, tuple(blanked)
        except UnexpectedToken as error:
            parts = groups(text) if parts is None else parts
            position = len(text) if error.token.type == "$END" else error.token.start_pos or 0
            group = next((part for part in parts if part.start <= position < part.end), None)
            # A group that already lost a part is incomplete for that reason: its fault has been reported.
            if group is None or not any(group.start <= part.start < group.end for part in blanked):
                problems.append(syntax_problem(error, _lark(), _point(file, text, position), group))
            again += position
            if group is None or group.parent is None or again > MAX_AGAIN:
                return None, problems, tuple(blanked)
            if group.parent.kind == "atom" or group.kind in {"variable", "count"}:
                group = group.parent  # an atom holds no groups, and a quantifier is nothing without its variable
            blanked.append(group)
            text = _blank(text, group)


def _blank(text: str, group: Group) -> str:
    hole = "".join("\n" if character == "\n" else " " for character in text[group.start : group.end])
    return text[: group.start] + hole + text[group.end :]


def _unbalanced_problem(text: str, file: str, position: int, which: str) -> Problem:
    span = _point(file, text, position)
    if which == "(":
        word = text[position + 1 :].split(maxsplit=1)
        name = f"({word[0].strip('()')}" if word and word[0].strip("()") else "("
        message, hint = f"the parenthesis of `{name}` is never closed", "add the missing `)`"
    else:
        rest = text[position + 1 :].strip(" \n\t)")
        message = "this `)` closes the task, but the file goes on" if rest else "this `)` closes nothing"
        hint = "remove it, or add the `(` that it should close"
    lost = swallowed(text, position, which)
    if lost is not None:
        place = _point(file, text, lost)
        message += f": the `{text[lost]}` at {place.line}:{place.column} stands in a comment"
        hint = f"write the `{text[lost]}` before the `;`, or begin the comment on a line of its own"
    return Problem.at(span, codes.UNBALANCED, message, hint)


def _point(file: str, text: str, position: int) -> Span:
    """The place of one character."""
    line = text.count("\n", 0, position) + 1
    column = position - text.rfind("\n", 0, position)
    return Span(file, line, column, line, column + 1)


def _hint(path: Path) -> str:
    """The hint for a file that cannot be read."""
    if path.is_symlink() and not path.exists():
        return f"`{path.name}` is a link that leads to no file: correct the link, or give the file itself"
    if not path.exists():
        return near(path.name, _neighbours(path)) or "give the path of an existing task file (*.bddl)"
    if path.is_dir():
        return "give a task file (*.bddl); `onto check` and `onto compile` take folders too"
    return "give a file that you may read"


def _neighbours(path: Path) -> Sequence[str]:
    try:
        return [each.name for each in path.parent.iterdir()]
    except OSError:
        return ()
