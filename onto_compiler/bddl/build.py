"""From Lark's tree to a :class:`~onto_compiler.bddl.ast.TaskSpec`; what the grammar leaves open is checked here.

Checked: every needed section is there, none is there twice, no two things share a name, numbers are numbers, and there
are as many as the attribute takes. All problems of a file are collected.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from lark import Token, Tree

from onto_compiler.bddl import codes
from onto_compiler.bddl.ast import And, Atom, Declaration, Formula, Not, Or, Region, Symbol, TaskSpec
from onto_compiler.bddl.groups import Group
from onto_compiler.bddl.sections import KEYWORDS, NEEDED
from onto_compiler.problems import Problem, Span

__all__ = ["build"]

Node = Tree[Token]

NUMERAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
NO_TARGET = Symbol("")


def build(tree: Node, file: str, holes: Sequence[Group] = ()) -> tuple[TaskSpec | None, tuple[Problem, ...]]:
    """The task in ``tree``, or None with the problems that were found.

    ``holes`` are groups that the caller found broken, and took out: what they held is not missing.
    """
    builder = _Builder(file, tuple(holes))
    task = builder.task(tree)
    return (None if builder.problems else task), tuple(builder.problems)


@dataclass
class _Builder:
    """One file's worth of building: what every step needs to know, and the problems so far."""

    file: str
    holes: tuple[Group, ...]
    problems: list[Problem] = field(default_factory=list)

    def problem(self, span: Span, code: str, message: str, hint: str = "") -> None:
        self.problems.append(Problem.at(span, code, message, hint))

    def span(self, node: Node | Token) -> Span:
        if isinstance(node, Token):
            at: tuple[int | None, ...] = (node.line, node.column, node.end_line, node.end_column)
        else:
            at = (node.meta.line, node.meta.column, node.meta.end_line, node.meta.end_column)
        return Span(self.file, *(number or 0 for number in at))

    def symbol(self, token: Token) -> Symbol:
        return Symbol(token.lower(), self.span(token))

    # Sections

    def task(self, tree: Node) -> TaskSpec | None:
        whole = self.span(tree)
        spoilt = {name for name in KEYWORDS if any(_begins(hole, KEYWORDS[name]) for hole in self.holes)}
        found = self.once(_nodes(tree), "section", KEYWORDS)
        for name in NEEDED:
            if name not in found and name not in spoilt:
                self.problem(whole, codes.MISSING_PART, f"the task has no `({KEYWORDS[name]} ...)` section")
        empty = Tree[Token]("empty", [])
        part = {name: found.get(name, empty) for name in KEYWORDS}
        regions = tuple(self.region(node) for node in _nodes(part["regions"]))
        fixtures = tuple(self.declarations(part["fixtures"], "fixture"))
        objects = tuple(self.declarations(part["objects"], "object"))
        self.unique(fixtures, objects, regions)
        init = tuple(self.atom(node) for node in _nodes(part["init"]))
        goal = [self.formula(node) for node in _nodes(part["goal"])]
        if self.problems or not goal or not found.keys() >= set(NEEDED):
            return None
        domain = _tokens(part["domain"])[0]
        return TaskSpec(
            problem=str(_tokens(part["problem"])[0]),
            domain=domain.lower(),
            language=" ".join(_tokens(part["language"])),
            regions=regions,
            fixtures=fixtures,
            objects=objects,
            interest=tuple(self.symbol(token) for token in _tokens(part["interest"])),
            init=init,
            goal=goal[0],
            requirements=tuple(token.lower() for token in _tokens(part["requirements"])),
            scene=tuple(_property(node) for node in _nodes(part["scene"])),
            file=self.file,
            span=whole,
            domain_span=self.span(domain),
        )

    def once(self, nodes: Iterable[Node], what: str, names: dict[str, str]) -> dict[str, Node]:
        """The first node of each kind; a second one is a problem."""
        found: dict[str, Node] = {}
        for node in nodes:
            first = found.setdefault(node.data, node)
            if first is not node:
                self.problem(
                    self.span(node),
                    codes.REPEATED_PART,
                    f"a second `({names[node.data]} ...)` {what}; the first is on line {first.meta.line}",
                    "join the two into one" if what == "section" else "keep one",
                )
        return found

    # Declarations

    def declarations(self, section: Node, default: str) -> Iterable[Declaration]:
        """Names with their category; names that no category follows get ``default``, as LIBERO's reader has it."""
        for group in _nodes(section):
            names, *category = group.children
            kind = str(category[0]).lower() if category else default
            for token in _tokens(names) if isinstance(names, Tree) else ():
                yield Declaration(token.lower(), kind, self.span(token))

    def unique(self, *groups: Sequence[Declaration | Region]) -> None:
        """No two declarations may share a name, since an atom would not say which it means."""
        first: dict[str, Declaration | Region] = {}
        for item in (item for group in groups for item in group):
            if isinstance(item, Region) and item.target is NO_TARGET:
                continue
            name = item.site if isinstance(item, Region) else item.name
            other = first.setdefault(name, item)
            if other is item:
                continue
            earlier, later = sorted((other, item), key=lambda each: each.span)
            message = f"`{name}` is declared twice; it is first declared on line {earlier.span.line}"
            hint = "number the instances: `plate_1`, `plate_2`" if isinstance(item, Declaration) else ""
            self.problem(later.span, codes.DUPLICATE_DECLARATION, message, hint)

    def region(self, node: Node) -> Region:
        name, parts = node.children[0], _nodes(node)
        found = self.once(parts, "attribute of this region", {part.data: f":{part.data}" for part in parts})
        span = self.span(name)
        if "target" in found:
            target = self.symbol(_tokens(found["target"])[0])
        else:
            target = NO_TARGET
            if not any(node.meta.start_pos <= hole.start < node.meta.end_pos for hole in self.holes):
                message = f"region `{name}` has no `(:target ...)`"
                hint = "name the fixture or object that the region is part of"
                self.problem(span, codes.MISSING_PART, message, hint)
        rectangles = self.rows(found.get("ranges"), 4, "a rectangle", "x0 y0 x1 y1")
        yaws = self.rows(found.get("yaw_rotation"), 2, "a yaw rotation", "min max")
        colours = self.rows(found.get("rgba"), 4, "a colour", "red green blue alpha")
        if len(yaws) > 1:
            message = f"region `{name}` has {len(yaws)} yaw rotations, and takes one"
            self.problem(self.span(found["yaw_rotation"]), codes.NUMBER_COUNT, message, "keep one pair of bounds")
        return Region(
            name=str(name).lower(),
            target=target,
            ranges=tuple((row[0], row[1], row[2], row[3]) for row in rectangles),
            yaw=(yaws[0][0], yaws[0][1]) if yaws else None,
            rgba=(colours[0][0], colours[0][1], colours[0][2], colours[0][3]) if colours else None,
            span=span,
        )

    # Numbers

    def rows(self, attribute: Node | None, count: int, what: str, shape: str) -> list[list[float]]:
        """Every list of numbers in ``attribute`` that has ``count`` of them; the others are problems."""
        rows = []
        for node in _nodes(attribute) if attribute is not None else ():
            tokens = _tokens(node)
            if len(tokens) != count:
                message = f"{what} takes {count} numbers, found {len(tokens)}"
                self.problem(self.span(node), codes.NUMBER_COUNT, message, f"write ({shape})")
            values = [self.number(token) for token in tokens]
            if len(tokens) == count:
                rows.append(values)
        return rows

    def number(self, token: Token) -> float:
        if NUMERAL.fullmatch(token):
            return float(token)
        hint = "write a decimal number such as `0.05`"
        if "," in token and NUMERAL.fullmatch(token.replace(",", ".", 1)):
            hint = f"write `{token.replace(',', '.', 1)}`, with a point"
        elif "pi" in token.lower():
            hint = "write the value in radians, such as `3.141592653589793`"
        self.problem(self.span(token), codes.NOT_A_NUMBER, f"`{token}` is not a number", hint)
        return 0.0

    # Formulas

    def formula(self, node: Node) -> Formula:
        match node.data:
            case "atom":
                return self.atom(node)
            case "negation":
                return Not(self.formula(_nodes(node)[0]), self.span(node))
            case kind:
                parts = tuple(self.formula(part) for part in _nodes(node))
                return (And if kind == "conjunction" else Or)(parts, self.span(node))

    def atom(self, node: Node) -> Atom:
        name, *arguments = _tokens(node)
        return Atom(str(name), tuple(map(self.symbol, arguments)), self.span(node), self.span(name))


def _nodes(tree: Node) -> list[Node]:
    return [child for child in tree.children if isinstance(child, Tree)]


def _tokens(tree: Node) -> list[Token]:
    return [child for child in tree.children if isinstance(child, Token)]


def _begins(hole: Group, keyword: str) -> bool:
    """Whether a section that was taken out began with ``keyword``, or was meant to."""
    in_task = hole.parent is not None and hole.parent.parent is None
    return in_task and difflib.SequenceMatcher(None, hole.head, keyword).ratio() > 0.7


def _property(node: Node) -> tuple[str, str]:
    key, value = _tokens(node)
    return key.lower(), value.lower()
