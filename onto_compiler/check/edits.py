"""The mechanical repair of a problem, as a change of a few characters where the problem stands.

Only problems with one right answer are repaired. The intended name of a misspelt one, a person must decide.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from pyoxigraph import NamedNode

from onto_compiler.check.model import Model
from onto_compiler.problems import Problem
from onto_compiler.rdf import OWL, PREFIXES, RDF, RDFS
from onto_compiler.sources import graph_of
from onto_compiler.turtle.source_map import SourceMap, map_text
from onto_compiler.turtle.tokens import Token, tokens, unescape

__all__ = ["FIXABLE", "Edit", "apply", "each_edit", "edits"]

_TYPE, _ONTOLOGY = NamedNode(RDF + "type"), NamedNode(OWL + "Ontology")
_REPLACED_BY = NamedNode(PREFIXES["dcterms"] + "isReplacedBy")
_FULL_STOP, _DEFINED_BY = "End the definition with a full stop", "Say which ontology defines the term"
_OPENING, _CLOSING = frozenset("[("), frozenset("])")


@dataclass(frozen=True, slots=True, order=True)
class Edit:
    """Replace the characters from ``start`` up to ``end`` of a text; ``done`` says it in the past tense.

    ``title`` offers it.
    """

    start: int
    end: int
    text: str
    problem: Problem
    done: str
    title: str


@dataclass(frozen=True, slots=True)
class _Place:
    """Where a problem stands: the tokens of its file, and the index of its own."""

    model: Model
    path: Path
    text: str
    map: SourceMap
    tokens: tuple[Token, ...]
    at: int
    problem: Problem

    @property
    def token(self) -> Token:
        return self.tokens[self.at]

    def edit(self, start: int, end: int, text: str, done: str, title: str) -> Edit:
        return Edit(start, end, text, self.problem, done, title)

    def written(self, iri: str) -> str:
        """An IRI with the prefixes of the file."""
        for prefix in self.map.declared:
            local = iri.removeprefix(prefix.namespace)
            if local != iri and local.replace("_", "").replace("-", "").isalnum():
                return f"{prefix.name}:{local}"
        return f"<{iri}>"


def edits(model: Model, path: Path, problems: Iterable[Problem]) -> tuple[Edit, ...]:
    """The repairs of ``problems`` to be made together, in the order of their places, none overlapping another."""
    found = tuple(each_edit(model, path, problems))
    # A prefix that is unused now may be what another repair writes: it goes when nothing else is left.
    kept: list[Edit] = []
    for edit in sorted([edit for edit in found if edit.problem.code != "TTL007"] or found):
        if not kept or edit.start >= kept[-1].end:
            kept.append(edit)
    return tuple(kept)


def each_edit(model: Model, path: Path, problems: Iterable[Problem]) -> Iterator[Edit]:
    """The repair of each of ``problems`` that has one, all of ``path``, as if it were the only one."""
    text = model.text(path)
    read = tuple(tokens(text))
    source_map = map_text(text, str(path), path.as_uri())
    starts = {token.start: index for index, token in enumerate(read)}
    for problem in problems:
        at = starts.get(source_map.source.offset(problem.line, problem.column))
        if problem.code in FIXABLE and at is not None:
            edit = FIXABLE[problem.code](_Place(model, path, text, source_map, read, at, problem))
            if edit is not None:
                yield edit


def apply(text: str, changes: Iterable[Edit]) -> str:
    """``text`` with ``changes``, which do not overlap."""
    for edit in sorted(changes, reverse=True):
        text = text[: edit.start] + edit.text + text[edit.end :]
    return text


def _full_stop(place: _Place) -> Edit | None:
    """A definition that ends in a letter, a digit or a closing parenthesis gets a full stop."""
    token = place.token
    if token.kind != "string":
        return None
    quote = 3 if token.text[:3] in {'"""', "'''"} and len(token.text) >= 6 else 1
    inside = token.text[quote:-quote]
    kept = inside.rstrip()
    last = unescape(inside).rstrip()[-1:]
    # What ends in an escape, or in other punctuation, a person must end.
    if not kept.endswith(last) or not (last.isalnum() or last == ")"):
        return None
    start = token.start + quote + len(kept)
    return place.edit(start, token.end - quote, ".", "ended the definition with a full stop", _FULL_STOP)


def _defined_by(place: _Place) -> Edit | None:
    """A term without origin is defined by the one ontology whose header its file holds."""
    quads = place.model.store.quads_for_pattern(None, _TYPE, _ONTOLOGY, graph_of(place.path))
    headers = {quad.subject.value for quad in quads if isinstance(quad.subject, NamedNode)}
    if len(headers) != 1:
        return None
    end = _statement_end(place.tokens, place.at)
    if end is None:
        return None
    last = place.tokens[end - 1]
    newline = "\r\n" if "\r\n" in place.text else "\n"
    one_line = "\n" not in place.text[place.token.start : last.end]
    gap = " " if one_line else f"{newline}    "
    mark = "" if last.text == ";" else " ;"
    (header,) = headers
    added = f"{mark}{gap}{place.written(RDFS + 'isDefinedBy')} <{header}>"
    return place.edit(last.end, last.end, added, "said which ontology defines the term", _DEFINED_BY)


def _statement_end(read: tuple[Token, ...], at: int) -> int | None:
    """The index of the dot that ends the statement of token ``at``."""
    depth = 0
    for index in range(at, len(read)):
        token = read[index]
        if token.kind != "mark":
            continue
        if token.text in _OPENING:
            depth += 1
        elif token.text in _CLOSING:
            depth -= 1
        elif token.text == "." and depth == 0:
            return index
    return None


def _remove_prefix(place: _Place) -> Edit | None:
    """An unused prefix goes, with its line where nothing else stands there."""
    before, at, read = place.tokens[place.at - 1], place.at, place.tokens
    if place.at == 0 or before.text.lower() not in {"@prefix", "prefix"} or at + 1 >= len(read):
        return None
    last = read[at + 1]
    if before.text.startswith("@"):
        if at + 2 >= len(read) or read[at + 2].text != ".":
            return None
        last = read[at + 2]
    start, end = before.start, last.end
    line_start = place.text.rfind("\n", 0, start) + 1
    line_end = place.text.find("\n", end) + 1 or len(place.text)
    if not place.text[line_start:start].strip() and not place.text[end:line_end].strip():
        start, end = line_start, line_end
    prefix = f"the unused prefix `{place.token.text}`"
    return place.edit(start, end, "", f"removed {prefix}", f"Remove {prefix}")


def _replace_deprecated(place: _Place) -> Edit | None:
    """A deprecated term gives way to the one term that its own declaration names."""
    token = place.token
    if token.kind not in {"name", "iri"}:
        return None
    named = {
        part
        for triple in place.map.triples
        for part, at in (
            (triple.subject, triple.at_subject),
            (triple.predicate, triple.at_predicate),
            (triple.object, triple.at_object),
        )
        if at == token and isinstance(part, NamedNode)
    }
    news = {
        quad.object.value
        for term in named
        for quad in place.model.store.quads_for_pattern(term, _REPLACED_BY, None, None)
        if isinstance(quad.object, NamedNode)
    }
    if len(named) != 1 or len(news) != 1:
        return None
    new = place.written(news.pop())
    replacing = f"the deprecated `{token.text}` by `{new}`"
    return place.edit(token.start, token.end, new, f"replaced {replacing}", f"Replace {replacing}")


FIXABLE: dict[str, Callable[[_Place], Edit | None]] = {
    "DOC004": _full_stop,
    "DOC005": _defined_by,
    "TTL007": _remove_prefix,
    "VOC006": _replace_deprecated,
}
"""The repair of each code that has a mechanical one; a repair is None if it would have to guess."""
