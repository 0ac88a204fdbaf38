"""A Turtle file's tree as lines.

One property to a line; a list of objects and a bracket stay on one line where they were written on one and it fits,
and have one line for each part otherwise.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final, cast

from onto_compiler.turtle.remarks import Remark
from onto_compiler.turtle.tree import (
    CLOSING,
    VERSION,
    Annotated,
    Bracket,
    Directive,
    Item,
    Node,
    Property,
    Triples,
    TurtleDocument,
    Word,
)

__all__ = ["WIDTH", "print_document"]

WIDTH: Final = 120
"""The columns of a line; only what cannot be broken is longer."""
_STEP: Final = 4
_SEPARATOR: Final = 2  # columns of a space and what ends a line


def print_document(document: TurtleDocument) -> list[str]:
    """The lines of a document, without line ends; a string of several lines counts as part of one."""
    lines: list[str] = []
    for item in document.statements:
        _add_above(lines, item, 0, first=not lines)
        lines += _statement(item)
    _add_remarks(lines, document.below, 0, first=not lines)
    return lines


def _statement(item: Item) -> list[str]:
    body = item.body
    if isinstance(body, Directive):
        word = VERSION if body.name == VERSION else f"@prefix {body.name}" if body.name else "@base"
        return _beside([f"{word} {body.iri} ."], item.beside)
    triples = cast("Triples", body)
    lines = _node(triples.subject, 0, 0)
    if not triples.properties:
        lines[-1] += " ."
        return _beside(lines, item.beside)
    alone = bool(triples.beside or triples.properties[0].above)
    if alone:
        lines = _beside(lines, triples.beside)
    for index, each in enumerate(triples.properties):
        property_ = cast("Property", each.body)
        if index == 0 and not alone:
            column = _column(lines[-1]) + 1
            first, *rest = _property(property_, _STEP, column)
            lines[-1] += f" {first}"
            lines += rest
        else:
            _add_above(lines, each, _STEP, first=index == 0)
            _add(lines, _property(property_, _STEP, _STEP), _STEP)
        lines[-1] += " ." if each is triples.properties[-1] else " ;"
        _beside(lines, each.beside)
    return lines


def _property(property_: Property, indent: int, column: int) -> list[str]:
    """A property from ``column`` on; what follows on lines of its own is indented."""
    verb, objects = property_.verb, property_.objects
    inner = indent + _STEP
    if property_.beside or objects[0].above:
        lines = _beside([verb], property_.beside)
        for index, item in enumerate(objects):
            _add_above(lines, item, inner, first=index == 0)
            _add(lines, _node(cast("Node", item.body), inner, inner), inner)
            _end_object(lines, item, last=item is objects[-1])
        return lines
    behind = column + len(verb) + 1
    flat = None if property_.broken else _flat_property(property_)
    if flat is not None and _fits(flat, column):
        return [flat]
    if len(objects) == 1:
        first, *rest = _node(cast("Node", objects[0].body), indent, behind)
        return [f"{verb} {first}", *rest]
    if _hugs(objects, inner, behind):
        lines = [verb]
        for item in objects:
            first, *rest = _open(cast("Bracket", item.body), indent)
            lines[-1] += f" {first}"
            lines += rest
            if item is not objects[-1]:
                lines[-1] += " ,"
        return lines
    first, *rest = _node(cast("Node", objects[0].body), inner, behind)
    lines = [f"{verb} {first}", *rest]
    _end_object(lines, objects[0], last=False)
    for item in objects[1:]:
        _add_above(lines, item, inner, first=False)
        _add(lines, _node(cast("Node", item.body), inner, inner), inner)
        _end_object(lines, item, last=item is objects[-1])
    return lines


def _hugs(objects: Sequence[Item], inner: int, behind: int) -> bool:
    """Whether all objects are open brackets, which then follow each other as ``] , [``."""
    for index, item in enumerate(objects):
        if not isinstance(item.body, Bracket) or item.above or item.beside or (index and item.apart):
            return False
        flat = _flat(item.body)
        if flat is not None and _fits(flat, inner if index else behind):
            return False
    return True


def _end_object(lines: list[str], item: Item, *, last: bool) -> None:
    if not last:
        lines[-1] += " ,"
    _beside(lines, item.beside)


def _node(node: Node, indent: int, column: int) -> list[str]:
    """A node from ``column`` on: on one line, or opened with its closing bracket at ``indent``."""
    if isinstance(node, Word):
        return [node.text]
    flat = _flat(node)
    if flat is not None and _fits(flat, column):
        return [flat]
    if isinstance(node, Bracket):
        return _open(node, indent)
    lines = _node(node.node, indent, column)
    for note in node.notes:
        first, *rest = _node(note, indent, _column(lines[-1]) + 1)
        lines[-1] += f" {first}"
        lines += rest
    return lines


def _open(bracket: Bracket, indent: int) -> list[str]:
    lines = _beside([bracket.opening], bracket.beside)
    inner = indent + _STEP
    for index, item in enumerate(bracket.items):
        _add_above(lines, item, inner, first=index == 0)
        if isinstance(item.body, Property):
            _add(lines, _property(item.body, inner, inner), inner)
            lines[-1] += " ;"
        else:
            _add(lines, _node(cast("Node", item.body), inner, inner), inner)
        _beside(lines, item.beside)
    _add_remarks(lines, bracket.below, inner, first=not bracket.items)
    lines.append(" " * indent + CLOSING[bracket.opening])
    return lines


def _flat(node: Node) -> str | None:
    """A node on one line; None if it has comments, or a line end of its own."""
    if isinstance(node, Word):
        return None if "\n" in node.text or "\r" in node.text else node.text
    if isinstance(node, Annotated):
        return _all(" ", map(_flat, (node.node, *node.notes)))
    closing = CLOSING[node.opening]
    if not node.items and not node.below and not node.beside:
        return node.opening + closing
    if node.broken or node.beside or node.below or any(item.above or item.beside for item in node.items):
        return None
    inside = _all(" ; " if isinstance(node.items[0].body, Property) else " ", map(_flat_part, node.items))
    return f"{node.opening} {inside} {closing}" if inside is not None else None


def _flat_part(item: Item) -> str | None:
    if isinstance(item.body, Property):
        return None if item.body.broken else _flat_property(item.body)
    return _flat(cast("Node", item.body))


def _all(separator: str, parts: Iterable[str | None]) -> str | None:
    """The parts on one line, if each of them is."""
    known = list(parts)
    return None if None in known else separator.join(cast("list[str]", known))


def _flat_property(property_: Property) -> str | None:
    if property_.beside or any(item.above or item.beside for item in property_.objects):
        return None
    objects = _all(" , ", (_flat(cast("Node", item.body)) for item in property_.objects))
    return None if objects is None else f"{property_.verb} {objects}"


def _fits(text: str, column: int) -> bool:
    return column + len(text) + _SEPARATOR <= WIDTH


def _column(line: str) -> int:
    return len(line) - max(line.rfind("\n"), line.rfind("\r")) - 1


def _add(lines: list[str], block: list[str], indent: int) -> None:
    """Add a block whose first line has no indentation yet."""
    lines.append(" " * indent + block[0])
    lines += block[1:]


def _add_above(lines: list[str], item: Item, indent: int, *, first: bool) -> None:
    _add_remarks(lines, item.above, indent, first=first)
    if item.apart and (item.above or not first):
        lines.append("")


def _add_remarks(lines: list[str], remarks: Sequence[Remark], indent: int, *, first: bool) -> None:
    for index, remark in enumerate(remarks):
        if remark.apart and not (first and index == 0):
            lines.append("")
        lines.append(" " * indent + remark.text)


def _beside(lines: list[str], comment: str) -> list[str]:
    if comment:
        lines[-1] += f"  {comment}"
    return lines
