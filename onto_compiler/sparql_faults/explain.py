"""From a query that Oxigraph rejects to the first thing that is wrong with it."""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import replace

from pyoxigraph import Store

from onto_compiler.problems import near
from onto_compiler.rdf import PREFIXES
from onto_compiler.sparql import refusal
from onto_compiler.sparql_faults.fault import FORMS, Fault, fault_at, listed
from onto_compiler.turtle.tokens import Token, tokens

__all__ = ["query_fault", "without_mark"]


def query_fault(
    query: str,
    prefixes: Mapping[str, str] | None = None,
    *,
    graphs: Container[str] = frozenset(),
    declare: str = "",
) -> Fault | None:
    """Why ``query`` is not asked: it must not be (QRY001 to QRY003), or is not SPARQL; None where it may be.

    ``prefixes`` need no declaration in it, and ``declare`` says how one is declared, with ``{prefix}`` and ``{iri}``.
    ``graphs`` are the IRIs of the graphs that its FROM may name. A byte-order mark is passed over.
    """
    text = without_mark(query)
    mark = len(query) - len(text)
    try:
        refused = refusal(text, prefixes=prefixes, graphs=graphs)
        if refused is not None:
            start, length = refused.place(text)
            return Fault(refused.message, refused.hint, start + mark, length, refused.code)
        Store().query(text, prefixes=dict(prefixes or {}))
    except SyntaxError as error:
        fault = _explained(text, prefixes or {}, str(error), declare)
        return replace(fault, start=fault.start + mark)
    except (OSError, RuntimeError, ValueError):
        pass  # it was parsed, and evaluated over nothing
    return None


def without_mark(text: str) -> str:
    """``text`` without a byte-order mark, which no query may begin with."""
    return text.removeprefix("\ufeff")


def _explained(query: str, prefixes: Mapping[str, str], said: str, declare: str) -> Fault:
    from onto_compiler.sparql_faults.form import unexpected  # noqa: PLC0415 - a sound query needs no grammar
    from onto_compiler.sparql_faults.meaning import meaningless  # noqa: PLC0415

    read = list(tokens(query))
    if not read:
        return Fault("the query is empty", f"begin with one of {listed(FORMS, 'or')}", 0, max(len(query), 1))
    for look in (_unterminated, _bad_start):
        if (fault := look(read)) is not None:
            return fault
    undeclared = _undeclared(read, prefixes, declare)
    wrong = unexpected(query, read)
    if wrong is not None and (undeclared is None or wrong.start < undeclared.start):
        return wrong
    return undeclared or meaningless(query, read, said)


def _unterminated(read: list[Token]) -> Fault | None:
    for token in read:
        if token.kind == "unterminated":
            return fault_at(
                token, f"the text that begins with {token.text} does not end", f"close it with {token.text}"
            )
    return None


def _bad_start(read: list[Token]) -> Fault | None:
    """A query that begins with none of its four words."""
    at = 0
    while at < len(read) and read[at].kind == "word" and read[at].text.upper() in {"PREFIX", "BASE", "VERSION"}:
        at += 3 if read[at].text.upper() == "PREFIX" else 2
    if at >= len(read):
        token = read[-1]
        return fault_at(token, "the query ends behind its prefixes", f"go on with one of {listed(FORMS, 'or')}")
    token = read[at]
    if token.kind == "word" and token.text.upper() in FORMS:
        return None
    if token.kind not in {"word", "at", "mark"} and at:
        return None  # the prologue itself is wrong
    if token.kind == "at" and token.text.lower() in {"@prefix", "@base"}:
        word = token.text[1:].upper()
        return fault_at(
            token, f"`{token.text}` is Turtle, and this is SPARQL", f"write `{word}` without @ and without a dot"
        )
    meant = near(token.text.upper(), FORMS)
    message = f"a query begins with {listed(FORMS, 'or')}, not with `{token.text}`"
    return fault_at(token, message, meant)


def _undeclared(read: list[Token], prefixes: Mapping[str, str], declare: str) -> Fault | None:
    """The first name whose prefix is not declared."""
    declared = set(prefixes)
    for at, token in enumerate(read):
        if token.kind != "name":
            continue
        prefix = token.text.partition(":")[0]
        if at and read[at - 1].kind == "word" and read[at - 1].text.upper() == "PREFIX":
            declared.add(prefix)
        elif prefix not in declared:
            known = PREFIXES.get(prefix, "...")
            how = (declare or "add a line `PREFIX {prefix}: <{iri}>`").format(prefix=prefix, iri=known)
            meant = near(prefix, sorted(declared)) if prefix else ""
            hint = f"{meant} Otherwise: {how}" if meant else how
            return fault_at(token, f"the prefix `{prefix}:` is not declared", hint)
    return None
