"""A syntax error in people's words: what the grammar would have taken here, and what it found."""

from __future__ import annotations

from lark import Lark, UnexpectedToken
from lark.lexer import PatternStr

from onto_compiler.bddl import codes
from onto_compiler.bddl.groups import Group
from onto_compiler.bddl.sections import QUANTIFIERS
from onto_compiler.problems import Problem, Span, near

__all__ = ["syntax_problem"]

# What an opening parenthesis begins, and what a symbol is, by the kind of the group that it stands in.
OPENS = {
    "": "`(define ...)`",
    "define": "a section such as `(:init ...)`",
    ":regions": "a region such as `(plate_region (:target main_table))`",
    "region": "an attribute such as `(:target main_table)`",
    ":ranges": "a list of rectangles",
    ":yaw_rotation": "a list of bounds",
    ":rgba": "a list of four numbers",
    "rows": "a list of numbers in parentheses",
    ":init": "a fact such as `(On plate_1 main_table_plate_region)`",
    ":goal": "a formula such as `(On plate_1 flat_stove_1_cook_region)`",
    "and": "a formula",
    "or": "a formula",
    "not": "a formula",
    "imply": "a formula",
    ":scene_properties": "a property such as `(:floor wood)`",
}
SYMBOLS = {
    "problem": "the name of the problem",
    ":domain": "the name of the domain",
    ":target": "the name of a fixture or object",
    ":fixtures": "a name",
    ":objects": "a name",
    "numbers": "a number",
    "region": "the region's name",
    "atom": "a name",
    "variable": "a name such as `?plate`",
    "count": "a number",
}
HINTS = {
    ":init": "each fact stands in parentheses of its own",
    ":ranges": "rectangles stand in a list: (:ranges ((x0 y0 x1 y1)))",
    ":yaw_rotation": "the bounds stand in a list: (:yaw_rotation ((min max)))",
    "rows": "each rectangle or pair of bounds has its own parentheses: ((x0 y0 x1 y1))",
}
# Where a group opens that is one too many.
SURPLUS_HINTS = {
    ":language": "the instruction may hold anything but parentheses",
    ":goal": "a goal is one formula: join several with (And ...)",
    "not": "(Not ...) takes one formula",
    "imply": "(imply ...) takes two formulas",
    "forall": "write (forall (?x - category) formula)",
    "exists": "write (exists (?x - category) formula)",
    "forn": "write (forn (n) (?x - category) formula)",
    "forpairs": "write (forpairs (?x - category) (?y - category) formula)",
    "fornpairs": "write (fornpairs (n) (?x - category) (?y - category) formula)",
}


def syntax_problem(error: UnexpectedToken, lark: Lark, span: Span, group: Group | None) -> Problem:
    """The problem for ``error`` at ``span``; ``group`` is the innermost group that the unexpected token is part of."""
    found = str(error.token)
    accepted = set(error.accepts or error.expected)
    outer = group.parent if group is not None and found == "(" else group
    kind = outer.kind if outer else ""
    first = outer is not None and group is outer and _follows_opening(error, outer)
    words = sorted(
        pattern.value
        for name in accepted
        if name not in {"$END", "LPAR", "RPAR", "MINUS"}
        and isinstance(pattern := lark.get_terminal(name).pattern, PatternStr)
    )
    # Eleven sections are too many to read out.
    options = ["a section"] if len(words) > 5 else [f"`{word}`" for word in words]
    if "SYMBOL" in accepted:
        options.append(
            _symbol(kind, after_dash=accepted == {"SYMBOL"} and kind in {":fixtures", ":objects"}, first=first)
        )
    if "LPAR" in accepted:
        options.append("a formula" if kind in QUANTIFIERS and "SYMBOL" not in accepted else OPENS.get(kind, "`(`"))
    if "MINUS" in accepted:
        options.append("`- category`")
    if "RPAR" in accepted:
        options.append("`)`")
    if "$END" in accepted:
        options.append("the end of the file")
    shown = "the end of the file" if error.token.type == "$END" else f"`{found}`"
    message = f"expected {_either(options)}, found {shown}"
    return Problem.at(span, codes.SYNTAX, message, near(found.lower(), words) or _hint(found, kind, outer, accepted))


def _hint(found: str, kind: str, outer: Group | None, accepted: set[str]) -> str:
    if outer is not None and outer.kind in QUANTIFIERS | {"imply"}:
        return SURPLUS_HINTS[outer.kind]
    if found.startswith(":") and "SYMBOL" in accepted:
        return "a name does not begin with `:`"
    if found == "(" and "RPAR" in accepted:
        return SURPLUS_HINTS.get(kind, "")
    return HINTS.get(kind, "") if "LPAR" in accepted else ""


def _symbol(kind: str, *, after_dash: bool, first: bool) -> str:
    if after_dash:
        return "a category"
    if kind == "atom" and first:
        return "a predicate"
    return SYMBOLS.get(kind, "a name")


def _follows_opening(error: UnexpectedToken, group: Group) -> bool:
    """Whether the unexpected token is the first thing in ``group``."""
    history = error.token_history
    return bool(history) and history[-1].type == "LPAR" and (history[-1].start_pos == group.start)


def _either(options: list[str]) -> str:
    if len(options) > 2:
        return f"one of {', '.join(options[:-1])} or {options[-1]}"
    return " or ".join(options) or "something else"
