"""From Lark's tree to a :class:`~onto_compiler.bddl.ast.TaskSpec`; what the grammar leaves open is checked here.

Checked: every needed section is there, none is there twice, no two things share a name, numbers are numbers, and there
are as many as the attribute takes. All problems of a file are collected.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from math import isfinite

from lark import Token, Tree

from onto_compiler.bddl import codes
from onto_compiler.bddl.ast import (
    NOWHERE,
    And,
    Atom,
    Declaration,
    Domain,
    Formula,
    Imply,
    Not,
    Or,
    Quantified,
    Region,
    Symbol,
    TaskSpec,
    Variable,
)
from onto_compiler.bddl.dialects import LIBERO, Dialect, dialect_of
from onto_compiler.bddl.groups import Group
from onto_compiler.bddl.sections import KEYWORDS, QUANTIFIERS
from onto_compiler.problems import Problem, Span

__all__ = ["build", "build_domain"]

Node = Tree[Token]

NUMERAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
COUNT = re.compile(r"\d+")
MAX_COUNT = 10_000
NO_TARGET = Symbol("")
DOMAIN_PARTS = {
    "domain_name": "domain",
    "requirements": ":requirements",
    "types": ":types",
    "predicates": ":predicates",
}


def build(tree: Node, file: str, holes: Sequence[Group] = ()) -> tuple[TaskSpec | None, tuple[Problem, ...]]:
    """The task in ``tree``, or None with the problems that were found.

    ``holes`` are groups that the caller found broken, and took out: what they held is not missing.
    """
    builder = _Builder(file, tuple(holes))
    task = builder.task(tree)
    return (None if builder.problems else task), tuple(builder.problems)


def build_domain(tree: Node, file: str) -> tuple[Domain | None, tuple[Problem, ...]]:
    """The domain in ``tree``, or None with the problems that were found."""
    builder = _Builder(file, ())
    domain = builder.domain(tree)
    return (None if builder.problems else domain), tuple(builder.problems)


@dataclass
class _Builder:
    """One file's worth of building: what every step needs to know, and the problems so far."""

    file: str
    holes: tuple[Group, ...]
    problems: list[Problem] = field(default_factory=list)
    passed_over: list[Problem] = field(default_factory=list)
    dialect: Dialect = LIBERO

    def slip(self, span: Span, code: str, message: str, hint: str) -> None:
        """A problem, or a warning if the dialect's own reader accepts it."""
        if not self.dialect.tolerant:
            self.problem(span, code, message, hint)
            return
        text = f"{message}; readers pass over it"
        self.passed_over.append(Problem.at(span, codes.PASSED_OVER, text, hint, "warning"))

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
        found = self.once((node for node in _nodes(tree) if node.data != "stray"), "section", KEYWORDS)
        self.dialect = dialect_of(_tokens(found["domain"])[0] if "domain" in found else "")
        for node in _nodes(tree):
            if node.data == "stray":
                self.slip(self.span(node), codes.SYNTAX, "a backslash stands between two sections", "remove it")
        needed = self.dialect.needed
        for name in needed:
            if name not in found and name not in spoilt:
                self.problem(whole, codes.MISSING_PART, f"the task has no `({KEYWORDS[name]} ...)` section")
        empty = Tree[Token]("empty", [])
        part = {name: found.get(name, empty) for name in KEYWORDS}
        regions = tuple(self.region(node) for node in _nodes(part["regions"]))
        fixtures = tuple(self.declarations(part["fixtures"], "fixture"))
        objects = tuple(self.declarations(part["objects"], "object"))
        self.unique(fixtures, objects, regions)
        if self.dialect.tolerant:
            fixtures, objects = _once(fixtures), _once(objects)
        init = tuple(self.atom(node) for node in _nodes(part["init"]) if node.data == "atom")
        absent = tuple(self.atom(_nodes(node)[0]) for node in _nodes(part["init"]) if node.data == "absent")
        goal = [self.formula(node) for node in _nodes(part["goal"])]
        for extra in goal[1:]:
            message = "expected `)`, found `(`: a goal is one formula"
            self.slip(extra.span, codes.SYNTAX, message, "a goal is one formula: join several with (And ...)")
        if self.problems or not goal or not found.keys() >= set(needed):
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
            absent=absent,
            file=self.file,
            span=whole,
            domain_span=self.span(domain),
            language_span=self.words(part["language"]) if "language" in found else whole,
            passed_over=tuple(self.passed_over),
        )

    def domain(self, tree: Node) -> Domain | None:
        found = self.once(_nodes(tree), "section", DOMAIN_PARTS)
        for name in ("domain_name", "predicates"):
            if name not in found:
                message = f"the domain has no `({DOMAIN_PARTS[name]} ...)` section"
                self.problem(self.span(tree), codes.MISSING_PART, message)
        if self.problems:
            return None
        predicates = [_tokens(node) for node in _nodes(found["predicates"])]
        empty = Tree[Token]("empty", [])
        return Domain(
            name=_tokens(found["domain_name"])[0].lower(),
            predicates=tuple((name.lower(), _count_arguments(arguments)) for name, *arguments in predicates),
            requirements=tuple(token.lower() for token in _tokens(found.get("requirements", empty))),
            types=tuple(token.lower() for token in _tokens(found.get("types", empty))),
            file=self.file,
        )

    def words(self, section: Node) -> Span:
        """The place of everything that a section says."""
        tokens = _tokens(section)
        if not tokens:
            return self.span(section)
        first, last = self.span(tokens[0]), self.span(tokens[-1])
        return Span(self.file, first.line, first.column, last.end_line, last.end_column)

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
        """No two declarations may share a name, since atoms would be ambiguous."""
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
            # Of one category the second says what the first said.
            same = isinstance(item, Declaration) and isinstance(other, Declaration) and item == other
            (self.slip if same else self.problem)(later.span, codes.DUPLICATE_DECLARATION, message, hint)

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
            yaw_span=self.span(found["yaw_rotation"]) if yaws else NOWHERE,
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
        if NUMERAL.fullmatch(token) and isfinite(value := float(token)):
            return value
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
            case "implication":
                antecedent, consequent = map(self.formula, _nodes(node))
                return Imply(antecedent, consequent, self.span(node))
            case kind if kind in QUANTIFIERS:
                return self.quantified(node)
            case kind:
                parts = tuple(self.formula(part) for part in _nodes(node))
                return (And if kind == "conjunction" else Or)(parts, self.span(node))

    def quantified(self, node: Node) -> Quantified:
        *binders, body = _nodes(node)
        numbers = [self.count(_tokens(each)[0]) for each in binders if each.data == "count"]
        variables = []
        for each in binders:
            if each.data == "variable":
                name, category = (token for token in _tokens(each) if token.type == "SYMBOL")
                variables.append(Variable(name.lower(), category.lower(), self.span(name)))
        return Quantified(
            node.data, tuple(variables), self.formula(body), numbers[0] if numbers else None, self.span(node)
        )

    def count(self, token: Token) -> int:
        if COUNT.fullmatch(token) and len(token) < 6 and int(token) <= MAX_COUNT:
            return int(token)
        hint = f"write a whole number up to {MAX_COUNT:,}"
        self.problem(self.span(token), codes.NOT_A_NUMBER, f"`{token}` is not a number of instances", hint)
        return 0

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


def _once(declarations: tuple[Declaration, ...]) -> tuple[Declaration, ...]:
    """The first declaration of each name."""
    first: dict[str, Declaration] = {}
    for each in declarations:
        first.setdefault(each.name, each)
    return tuple(first.values())


def _count_arguments(tokens: Sequence[Token]) -> int:
    """How many names there are, without the categories that follow a dash."""
    return len(tokens) - 2 * [str(token) for token in tokens].count("-")


def _property(node: Node) -> tuple[str, str]:
    key, value = _tokens(node)
    return key.lower(), value.lower()
