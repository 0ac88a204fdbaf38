"""Completion, hover and definition in a Turtle buffer, which may be broken at the cursor."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from pyoxigraph import NamedNode

from onto_compiler.lsp.answers import Completion, Hover
from onto_compiler.lsp.vocabulary import VocabularyTerm
from onto_compiler.problems import Span
from onto_compiler.rdf import PREFIXES, RDF
from onto_compiler.turtle.source_map import map_text
from onto_compiler.turtle.tokens import SourceText, Token, tokens

__all__ = ["block_of", "complete", "defined_at", "hover", "prefixes", "term_at"]

_DECLARED = re.compile(r"(?im)^[ \t]*@?prefix[ \t]+([\w.-]*):[ \t]*<([^>\s]*)>")
_NAME = re.compile(r"([\w.-]*):([\w.-]*)$|([\w-]+)$")
_KINDS = {
    "Class": "class",
    "ObjectProperty": "property",
    "DatatypeProperty": "property",
    "AnnotationProperty": "property",
}


def prefixes(text: str) -> Mapping[str, str]:
    """The prefixes that ``text`` declares; a mistake elsewhere in it does not matter."""
    return {match[1]: match[2] for match in _DECLARED.finditer(text)}


def complete(text: str, offset: int, vocabulary: Mapping[str, VocabularyTerm]) -> tuple[Completion, ...]:
    """Declared terms behind ``prefix:``, or prefixes where none is written yet; nothing in a string or a comment."""
    line = text[text.rfind("\n", 0, offset) + 1 : offset]
    match = _NAME.search(line)
    if match is None or _in_text(text, offset):
        return ()
    known = prefixes(text)
    if match[3] is not None:
        begun = match[3].casefold()
        start = offset - len(match[3])
        return tuple(
            Completion(f"{name}:", start, namespace, kind="prefix")
            for name, namespace in sorted(known.items())
            if name.casefold().startswith(begun)
        )
    namespace = known.get(match[1], PREFIXES.get(match[1]))
    if not namespace:
        return ()
    begun, start = match[2].casefold(), offset - len(match[0])
    offers = []
    for iri, term in vocabulary.items():
        local = iri.removeprefix(namespace)
        if local not in {iri, ""} and not re.search(r"[#/]", local) and begun in local.casefold():
            kind = _KINDS.get(term.kind, "name")
            offers.append(Completion(f"{match[1]}:{local}", start, term.signature or term.kind, term.definition, kind))
    return tuple(
        sorted(offers, key=lambda offer: (not offer.text.casefold().startswith(match[0].casefold()), offer.text))
    )


def term_at(text: str, offset: int) -> tuple[str, Token] | None:
    """The IRI that is written at ``offset``, and its token."""
    for token in tokens(text):
        if token.start <= offset <= token.end and token.kind in {"name", "iri", "word"}:
            if token.kind == "iri":
                return token.text[1:-1], token
            if token.kind == "word":
                if token.text == "a":
                    return RDF + "type", token
                continue
            prefix, _, local = token.text.partition(":")
            namespace = prefixes(text).get(prefix)
            return (namespace + local.replace("\\", ""), token) if namespace else None
        if token.start > offset:
            break
    return None


def hover(text: str, offset: int, vocabulary: Mapping[str, VocabularyTerm]) -> Hover | None:
    """The documentation of the term at ``offset``."""
    found = term_at(text, offset)
    if found is None or found[0] not in vocabulary:
        return None
    return Hover(vocabulary[found[0]].markdown, SourceText("", text).span(found[1].start, found[1].end))


def defined_at(
    text: str, path: Path, offset: int, vocabulary: Mapping[str, VocabularyTerm], read: Callable[[Path], str]
) -> Span | None:
    """Where the term at ``offset`` is the subject of a block: in this buffer, or else in the file that types it.

    ``read`` gives the text of another file.
    """
    found = term_at(text, offset)
    if found is None:
        return None
    term = vocabulary.get(found[0])
    here = _subject(text, path, found[0])
    elsewhere = here is None and term is not None and term.file != path
    return block_of(found[0], vocabulary, read) if elsewhere else here


def block_of(iri: str, vocabulary: Mapping[str, VocabularyTerm], read: Callable[[Path], str]) -> Span | None:
    """The subject of the block that declares ``iri``, in the file that does; ``read`` gives its text."""
    term = vocabulary.get(iri)
    return _subject(read(term.file), term.file, iri) if term is not None and term.file is not None else None


def _subject(text: str, path: Path, iri: str) -> Span | None:
    source_map = map_text(text, str(path), path.as_uri())
    triples = source_map.find(NamedNode(iri), NamedNode(RDF + "type"))
    return source_map.span(triples[0].at_subject) if triples else None


def _in_text(text: str, offset: int) -> bool:
    """Whether ``offset`` lies in a string or a comment."""
    for token in tokens(text):
        if token.start < offset < token.end:
            return token.kind == "string"
        if token.start >= offset:
            break
    line = text[text.rfind("\n", 0, offset) + 1 : offset]
    return bool(re.match(r"[^<\"']*(?:<[^>]*>[^<\"']*)*#", re.sub(r"<[^>]*>", "", line)))
