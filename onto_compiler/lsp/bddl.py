"""Completion, hover and definition in a BDDL buffer, which may be broken at the cursor.

Declarations are read from the words of the text, so that one open parenthesis does not hide every name.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

from onto_compiler.lsp.answers import Completion, Hover
from onto_compiler.lsp.task_names import use_at
from onto_compiler.problems import OntoError, Span
from onto_compiler.schema import Schema, local_name
from onto_compiler.turtle.tokens import SourceText

__all__ = ["Declared", "complete", "declarations", "defined_at", "hover", "terms_at"]

_WORD = re.compile(r"[\w?.-]+")
_BEGUN = re.compile(r"[\w?.-]*$")
_SECTION = re.compile(r"\(\s*:(\w+)", re.IGNORECASE)
_GROUP = re.compile(r"((?:\w[\w.-]*\s+)+)-\s+(\w[\w.-]*)")
_REGION = re.compile(r"\(\s*([\w.-]+)\s*\(\s*:target\s+([\w.-]+)", re.IGNORECASE)
_COMMENT = re.compile(r";[^\n]*")
_LOGIC = ("and", "or", "not", "imply", "forall", "exists", "forn", "forpairs", "fornpairs")
_STATEMENTS = frozenset(("init", "goal"))


@dataclass(frozen=True, slots=True)
class Declared:
    """A name that atoms may use: ``kind`` is object, fixture or region, ``category`` its category or its target."""

    name: str
    kind: str
    category: str
    start: int
    end: int


@lru_cache(maxsize=8)
def declarations(text: str) -> Mapping[str, Declared]:
    """The objects, fixtures and sites of regions that ``text`` declares, by name in lower case."""
    bare = _COMMENT.sub(lambda match: " " * len(match[0]), text)
    found = {declared.name.casefold(): declared for declared in _instances(bare)}
    for match in _REGION.finditer(bare):
        site = f"{match[2]}_{match[1]}"
        found[site.casefold()] = Declared(site, "region", match[2], match.start(1), match.end(1))
    return found


def complete(text: str, offset: int, schema: Schema) -> tuple[Completion, ...]:
    """Predicates behind a parenthesis in ``:init`` or ``:goal``, names in atoms, categories behind a dash."""
    begun = _BEGUN.search(text, max(0, text.rfind("\n", 0, offset)), offset)
    start = begun.start() if begun else offset
    word, before = text[start:offset].casefold(), text[:start].rstrip(" \t\n")
    section = _section(text, start)
    if ";" in text[text.rfind("\n", 0, offset) + 1 : offset] or section is None:
        return ()
    if section in {"objects", "fixtures"}:
        if not before.endswith("-"):
            return ()
        names = {
            name: Completion(name, start, local_name(cls), kind="class") for name, cls in schema.categories.items()
        }
    elif section in _STATEMENTS and before.endswith("("):
        names = {name: Completion(name, start, what, about, "predicate") for name, what, about in _predicates(schema)}
        if section == "goal":
            names |= {name: Completion(name, start, "connective") for name in _LOGIC}
    else:
        declared = declarations(text).values()
        names = {d.name: Completion(d.name, start, f"{d.kind} ({d.category})") for d in declared}
    return tuple(offer for name, offer in sorted(names.items()) if name.casefold().startswith(word))


def hover(text: str, offset: int, schema: Schema) -> Hover | None:
    """The documentation of the word at ``offset``, from the task or the ontology."""
    word = _word(text, offset)
    if word is None:
        return None
    name = word[0].casefold()
    span = SourceText("", text).span(word.start(), word.end())
    declared = declarations(text).get(name)
    if declared is not None:
        cls = _class(declared, schema)
        what = f", of class {local_name(cls)}" if cls else ""
        of = "region of" if declared.kind == "region" else f"{declared.kind} of category"
        return Hover(f"**{declared.name}**: {of} `{declared.category}`{what}", span)
    entries = [f"`{what}`\n\n{about}" for known, what, about in _predicates(schema) if known.casefold() == name]
    return Hover(f"**{word[0]}** (predicate)\n\n" + "\n\n".join(entries), span) if entries else None


def defined_at(text: str, file: str, offset: int) -> Span | None:
    """Where the task declares the name at ``offset``."""
    word = _word(text, offset)
    use = use_at(text, offset)
    declared = declarations(text).get(word[0].casefold()) if word else None
    if declared is None or (use is not None and use.kind in {"predicate", "category"}):
        return None
    return SourceText(file, text).span(declared.start, declared.end)


def terms_at(text: str, offset: int, schema: Schema, categories: Mapping[str, str]) -> tuple[str, ...]:
    """The IRIs of what the predicate or the category at ``offset`` stands for in the ontology.

    A native predicate stands for the typed one that its atom is lifted to; where the atom does not lift, for each that
    one of its name may be lifted to. ``categories`` are the IRIs of the declared asset categories.
    """
    use = use_at(text, offset)
    if use is None or use.kind not in {"predicate", "category"}:
        return ()
    if use.kind == "category":
        found = categories.get(use.name) or schema.categories.get(use.name)
        return (found,) if found else ()
    lifted = _lifted(text, use.start, schema)
    if lifted is not None:
        return (lifted,)
    direct = schema.predicate_named(use.name)
    bound = [binding.lifts for binding in schema.bindings if binding.native.casefold() == use.name]
    return tuple(dict.fromkeys([*bound, *([direct.iri] if direct else [])]))


def _lifted(text: str, offset: int, schema: Schema) -> str | None:
    """The predicate that the atom whose name begins at ``offset`` is lifted to."""
    from onto_compiler.bddl import parse  # noqa: PLC0415 - Lark is heavy, and Turtle needs none
    from onto_compiler.bddl.ast import atoms  # noqa: PLC0415 - as above
    from onto_compiler.bddl.lift import lift_atom  # noqa: PLC0415 - as above
    from onto_compiler.bddl.scope import scope_of  # noqa: PLC0415 - as above

    try:
        spec = parse(text, "")
    except OntoError:
        return None
    span = SourceText("", text).span(offset, offset)
    for atom in (*spec.init, *spec.absent, *atoms(spec.goal)):
        if (atom.name_span.line, atom.name_span.column) == (span.line, span.column):
            fact = lift_atom(atom, scope_of(spec, schema), schema, spec.domain, polarity=True)
            return fact.predicate if fact is not None else None
    return None


def _instances(text: str) -> Iterator[Declared]:
    for opening in _SECTION.finditer(text):
        kind = {"objects": "object", "fixtures": "fixture"}.get(opening[1].casefold())
        if kind is None:
            continue
        end = text.find(")", opening.end())
        body_end = end if end >= 0 else len(text)
        for group in _GROUP.finditer(text, opening.end(), body_end):
            for name in _WORD.finditer(text, group.start(1), group.end(1)):
                yield Declared(name[0], kind, group[2], name.start(), name.end())


def _section(text: str, offset: int) -> str | None:
    """The section that ``offset`` lies in: the last one that was opened before it."""
    found = None
    for match in _SECTION.finditer(text, 0, offset):
        if match[1].casefold() in {"objects", "fixtures", "regions", "init", "goal", "obj_of_interest", "language"}:
            found = match[1].casefold()
    return found


def _predicates(schema: Schema) -> Iterator[tuple[str, str, str]]:
    """Native predicates through their bindings, then the typed ones: name, signature, definition."""
    natives: dict[str, list[str]] = {}
    for binding in schema.bindings:
        arguments = ", ".join(map(local_name, binding.arguments))
        lifted = (
            schema.predicates[binding.lifts].name if binding.lifts in schema.predicates else local_name(binding.lifts)
        )
        natives.setdefault(binding.native, []).append(f"{binding.native}({arguments}) becomes {lifted}")
    for native, ways in natives.items():
        yield native, "; ".join(dict.fromkeys(ways)), ""
    for signature in schema.predicates.values():
        if signature.name.casefold() not in {native.casefold() for native in natives}:
            arguments = ", ".join(map(local_name, signature.parameters))
            yield signature.name, f"{signature.name}({arguments})", signature.definition


def _class(declared: Declared, schema: Schema) -> str | None:
    if declared.kind == "region":
        return None
    return schema.categories.get(declared.category) or schema.defaults.get(declared.kind)


def _word(text: str, offset: int) -> re.Match[str] | None:
    start = max(text.rfind("\n", 0, offset) + 1, 0)
    return next((m for m in _WORD.finditer(text, start) if m.start() <= offset <= m.end()), None)
