"""Symbols, references, renaming and colours of task files."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from onto_compiler.lsp.answers import Change, Colour, Place, RefusedError, Symbol
from onto_compiler.lsp.task_tree import CONNECTIVES, QUANTIFIERS, Group, Use, pairs, sections, uses

__all__ = ["colours", "references", "renamable", "rename", "symbols", "use_at"]

_TITLES = {
    ":regions": "Regions",
    ":fixtures": "Fixtures",
    ":objects": "Objects",
    ":init": "Initial facts",
    ":goal": "Goal",
}
_COLOURS = {
    "object": "variable",
    "fixture": "variable",
    "region": "property",
    "variable": "parameter",
    "category": "class",
    "predicate": "function",
}
_OTHER = re.compile(r";[^\n\r]*|[()]|[^\s();]+")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_NAME = re.compile(r"[\w.-]+")
_LOCAL = frozenset(("object", "fixture", "region", "variable"))


def use_at(text: str, offset: int) -> Use | None:
    """The name at ``offset``; between the two parts of a region's site, the region."""
    found = [use for use in uses(text) if use.start <= offset <= use.end]
    return found[-1] if found else None


def symbols(text: str) -> tuple[Symbol, ...]:
    """The sections of a task with what they declare or state."""
    return tuple(
        Symbol(
            title, "section", "", group.start, group.end, group.start + 1, group.start + 1 + len(head), children=inner
        )
        for group in sorted(sections(text), key=lambda group: group.start)
        if (title := _TITLES.get(head := group.head)) and (inner := tuple(_members(text, group)))
    )


def references(use: Use, texts: Mapping[Path, str], *, declarations: bool = True) -> Iterator[Place]:
    """Where the name of ``use`` is written: what a task declares in its own text, anything else in all of ``texts``."""
    for path, text in texts.items():
        for other in uses(text):
            if _same(use, other) and (declarations or not other.declares):
                yield Place(path, other.start, other.end)


def renamable(text: str, offset: int) -> tuple[Use, str]:
    """The name at ``offset``, and how it is written there.

    Raises:
        RefusedError: there is none, or the ontology gives it.

    """
    use = use_at(text, offset)
    if use is None:
        raise RefusedError("There is no name here that can be renamed.")
    written = text[use.start : use.end]
    if use.kind not in _LOCAL:
        raise RefusedError(f"The {use.kind} `{written}` has its name from the ontology, not from this task.")
    return use, written


def rename(use: Use, new: str, path: Path, text: str) -> tuple[Change, ...]:
    """The changes that give what a task declares the name ``new``; the sites of an object's regions follow.

    Raises:
        RefusedError: ``new`` is no name, or is taken.

    """
    mark = "?" if use.kind == "variable" else ""
    name = new if new.startswith(mark) else mark + new
    if not _NAME.fullmatch(name.removeprefix(mark)) or name.startswith("-"):
        raise RefusedError(f"`{new}` is no name: use letters, digits, `_`, `-` and dots.")
    changes = tuple(Change(path, each.start, each.end, name) for each in uses(text) if _same(use, each))
    before, after = _declared(text), _declared(_applied(text, changes))
    bound = {each.name for each in uses(text) if each.kind == "variable"} - {use.name}
    if len(after) < len(before) or name.casefold() in bound:
        raise RefusedError(f"`{name}` is declared already in this task.")
    return changes


def colours(text: str) -> Iterator[Colour]:
    """What each part of a task is, in order."""
    found = {use.start: use for use in uses(text)}
    spoken = [(group.start, group.end) for group in sections(text) if group.head == ":language"]
    for match in _OTHER.finditer(text):
        token, start, end = match[0], match.start(), match.end()
        use = found.get(start)
        while use is not None:
            yield Colour(use.start, use.end, _COLOURS[use.kind], use.declares)
            use = found.get(use.end + 1) if use.end < end else None
        if start in found or token in {"(", ")", "-"}:
            continue
        if token[0] == ";":
            yield Colour(start, end, "comment")
        elif token[0] != ":" and any(begin < start < close for begin, close in spoken):
            yield Colour(start, end, "string")
        elif _NUMBER.fullmatch(token):
            yield Colour(start, end, "number")
        elif token[0] == ":" or token.casefold() in CONNECTIVES | QUANTIFIERS | {"define", "problem"}:
            yield Colour(start, end, "keyword")


def _same(use: Use, other: Use) -> bool:
    return (use.kind, use.name, use.scope) == (other.kind, other.name, other.scope)


def _declared(text: str) -> set[str]:
    return {use.name for use in uses(text) if use.declares}


def _applied(text: str, changes: tuple[Change, ...]) -> str:
    for change in sorted(changes, reverse=True):
        text = text[: change.start] + change.text + text[change.end :]
    return text


def _members(text: str, group: Group) -> Iterator[Symbol]:
    if group.head in {":objects", ":fixtures"}:
        for word, category in pairs(group.words[1:]):
            yield Symbol(word.text, "object", category, word.start, word.end, word.start, word.end)
    elif group.head == ":regions":
        for use in uses(text):
            if use.kind == "region" and use.declares:
                inside = next(one for one in group.groups if one.start <= use.start < one.end)
                yield Symbol(use.name, "region", "", inside.start, inside.end, use.start, use.end)
    else:
        for atom in _atoms(group):
            word = atom.words[0]
            written = " ".join(text[atom.start : atom.end].split())
            yield Symbol(written, "fact", "", atom.start, atom.end, word.start, word.end)


def _atoms(group: Group) -> Iterator[Group]:
    """The atoms of a formula, in order."""
    for part in group.groups:
        if part.head and part.head not in CONNECTIVES | QUANTIFIERS and part.head[0] not in "?:":
            yield part
        else:
            yield from _atoms(part)
