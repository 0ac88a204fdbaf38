"""Symbols, references, renaming and colours of Turtle, from the outline of a text."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from pyoxigraph import RdfFormat, parse

from onto_compiler.lsp.answers import Change, Colour, Place, RefusedError, Symbol
from onto_compiler.lsp.outline import Block, Name, Outline, outline, query_outline
from onto_compiler.lsp.siblings import MOST
from onto_compiler.lsp.vocabulary import VocabularyTerm
from onto_compiler.rdf import BASE, OWL, PREFIXES, RDF, RDFS, SH, namespace_of
from onto_compiler.schema import local_name
from onto_compiler.turtle.tokens import SourceText, Token
from onto_compiler.vocabularies import TERMS

__all__ = ["colours", "read_outline", "references", "refuse_foreign", "renamable", "rename", "symbols"]

_CLASSES = {OWL + "Class", RDFS + "Class", RDFS + "Datatype"}
_SHAPES = {SH + "NodeShape", SH + "PropertyShape"}
_COMMENT = re.compile(r"#[^\n\r]*")
_LINE = re.compile(r"[^\n\r]+")
_KINDS = {"ontology": "namespace", "class": "class", "property": "property", "shape": "type"}


def read_outline(path: Path, text: str) -> Outline:
    """The outline of a Turtle file, or of a file with a query."""
    return query_outline(text) if path.suffix == ".rq" else outline(text, path.as_uri())


def symbols(text: str, path: Path) -> tuple[Symbol, ...]:
    """What each block of a Turtle text is about."""
    return tuple(
        Symbol(
            name=block.written,
            kind=_kind(block),
            detail=", ".join(map(local_name, block.types)),
            start=block.start,
            end=block.end,
            name_start=block.subject.start,
            name_end=block.subject.end,
            deprecated=block.deprecated,
        )
        for block in read_outline(path, text).blocks
    )


def references(iri: str, texts: Mapping[Path, str], *, declarations: bool = True) -> Iterator[Place]:
    """Where ``iri`` is written in ``texts``, queries included; as the subject of a block only with ``declarations``."""
    for path, text in texts.items():
        if _may_hold(text, iri):
            read = read_outline(path, text)
            declared = set() if declarations else {block.subject.start for block in read.blocks}
            yield from (Place(path, name.start, name.end) for name in read.of(iri) if name.start not in declared)


def renamable(text: str, path: Path, offset: int) -> tuple[Name, str, int]:
    """The name at ``offset``, its local part, and where that begins.

    Raises:
        RefusedError: there is none, or it belongs to a standard vocabulary.

    """
    name = read_outline(path, text).at(offset)
    if name is None:
        raise RefusedError("There is no term here that can be renamed.")
    namespace = namespace_of(name.iri) if name.namespace is None else name.namespace
    local = name.iri.removeprefix(namespace)
    standard = namespace_of(name.iri) in TERMS or any(
        name.iri.startswith(known) for known in PREFIXES.values() if not known.startswith(BASE)
    )
    if standard:
        raise RefusedError(f"`{_written(text, name)}` is a term of a standard vocabulary, and keeps its name.")
    if not local:
        raise RefusedError(f"`{_written(text, name)}` is a namespace, not a term in it.")
    written = _written(text, name)
    begin = written.rfind(local)
    if begin < 0:  # written with escapes
        raise RefusedError(f"`{written}` is written with escapes: rename it at a place where it is written without.")
    return name, local, name.start + begin


def refuse_foreign(name: Name, local: str, texts: Mapping[Path, str], vocabulary: Mapping[str, VocabularyTerm]) -> None:
    """Refuse to rename a term that none of ``texts`` declares.

    Raises:
        RefusedError: none does; the message names the file that does.

    """
    holding = (read_outline(path, text) for path, text in texts.items() if _may_hold(text, name.iri))
    blocks = [block for read in holding for block in read.blocks if block.subject.iri == name.iri]
    known = vocabulary.get(name.iri)
    if not any(block.types for block in blocks) and known is not None and known.file not in texts:
        where = f"`{known.file.name}`" if known.file is not None else "a file"
        raise RefusedError(f"`{local}` is declared in {where}, outside of this folder: rename it there.")
    if not blocks:
        raise RefusedError(f"No file of this folder declares `{local}`.")


def rename(
    name: Name,
    local: str,
    new: str,
    texts: Mapping[Path, str],
    vocabulary: Mapping[str, VocabularyTerm],
) -> tuple[Change, ...]:
    """The changes that give the term at ``name`` the local name ``new`` instead of ``local`` in all ``texts``.

    Raises:
        RefusedError: ``new`` is no local name or is taken, or another file declares the term.

    """
    _refuse_name(new)
    if len(texts) >= MOST:
        raise RefusedError(f"There are {MOST} files or more in this folder, and not all would be changed.")
    stem = name.iri.removesuffix(local)
    wanted = stem + new
    if wanted == name.iri:
        return ()
    refuse_foreign(name, local, texts, vocabulary)
    for path, text in texts.items():
        taken = next(references(wanted, {path: text}), None)
        if taken is not None:
            line = SourceText("", text).span(taken.start, taken.start).line
            raise RefusedError(f"`{new}` is a term already ({path.name}:{line}): the two would become one.")
    return tuple(
        Change(path, each.start, each.end, _renamed(_written(text, each), each, local, new, wanted))
        for path, text in texts.items()
        if _may_hold(text, name.iri)
        for each in read_outline(path, text).of(name.iri)
    )


def colours(text: str, path: Path, vocabulary: Mapping[str, VocabularyTerm]) -> Iterator[Colour]:
    """What each part of a Turtle text is, in order; a string is cut at its line ends."""
    read = read_outline(path, text)
    kinds = {block.subject.iri: _KINDS.get(_kind(block), "enumMember") for block in read.blocks if block.types}
    declaring = {block.subject.start for block in read.blocks if block.types}
    names = iter(read.names)
    name = next(names, None)
    at = 0
    for token in read.tokens:
        if token.start > at:
            yield from _lines(_COMMENT, text, at, token.start, "comment")
        at = token.end
        inside = False
        while name is not None and name.start < token.end:
            inside = True
            yield from _coloured(text, name, kinds.get(name.iri) or _known(name, vocabulary), name.start in declaring)
            name = next(names, None)
        if not inside:
            yield from _plain(text, token)
    yield from _lines(_COMMENT, text, at, len(text), "comment")


def _kind(block: Block) -> str:
    types = set(block.types)
    if OWL + "Ontology" in types:
        return "ontology"
    if types & _SHAPES:
        return "shape"
    if types & _CLASSES:
        return "class"
    if any(one.startswith((OWL, RDF)) and one.endswith("Property") for one in types):
        return "property"
    return "individual"


def _known(name: Name, vocabulary: Mapping[str, VocabularyTerm]) -> str:
    """The kind of a name that this file does not declare, by its declaration elsewhere or by its place."""
    if name.role in {"predicate", "class"}:
        return "property" if name.role == "predicate" else "class"
    term = vocabulary.get(name.iri)
    if term is None:
        return "variable"
    return "class" if term.kind == "Class" else "property" if term.kind.endswith("Property") else "enumMember"


def _coloured(text: str, name: Name, kind: str, declares: bool) -> Iterator[Colour]:  # noqa: FBT001 - a private helper
    colon = text.find(":", name.start, name.end) if name.namespace is not None else -1
    if name.end - name.start == 1:  # `a`
        yield Colour(name.start, name.end, "keyword")
    elif colon < 0:
        yield Colour(name.start, name.end, kind, declares)
    else:
        if colon > name.start:
            yield Colour(name.start, colon, "namespace")
        if colon + 1 < name.end:
            yield Colour(colon + 1, name.end, kind, declares)


def _plain(text: str, token: Token) -> Iterator[Colour]:
    if token.kind == "string":
        yield from _lines(_LINE, text, token.start, token.end, "string")
    elif token.kind == "number":
        yield Colour(token.start, token.end, "number")
    elif token.kind == "variable":
        yield Colour(token.start, token.end, "parameter")
    elif token.kind == "word" or token.text.lower() in {"@prefix", "@base", "@version"}:
        yield Colour(token.start, token.end, "keyword")
    elif token.kind == "name" and token.text[0] != ":":  # a prefix where it is declared
        yield Colour(token.start, token.start + token.text.index(":"), "namespace")


def _lines(pattern: re.Pattern[str], text: str, start: int, end: int, kind: str) -> Iterator[Colour]:
    return (Colour(match.start(), match.end(), kind) for match in pattern.finditer(text, start, end))


def _may_hold(text: str, iri: str) -> bool:
    """Whether ``iri`` can be written in ``text``: the longest word of its end must be."""
    words: list[str] = re.findall(r"\w+", iri[len(namespace_of(iri)) :] or iri)
    return "\\" in text or max(words, key=len, default="") in text


def _written(text: str, name: Name) -> str:
    return text[name.start : name.end]


def _refuse_name(new: str) -> None:
    try:
        read = list(parse(f"<x:s> <x:p> <x:{new}> . @prefix p: <x:> . <x:s> <x:p> p:{new} .", format=RdfFormat.TURTLE))
    except (SyntaxError, ValueError):
        read = []
    if len(read) != 2 or read[0].object != read[1].object or not re.fullmatch(r"[\w.-]+", new):
        raise RefusedError(f"`{new}` is no local name: use letters, digits, `_`, `-` and dots in between.")


def _renamed(written: str, name: Name, local: str, new: str, wanted: str) -> str:
    """A name as it is written, with its new local part, or else the new IRI."""
    if name.namespace is None:
        whole = written.removesuffix(">")
        return f"{whole.removesuffix(local)}{new}>" if whole.endswith(local) else f"<{wanted}>"
    if wanted.startswith(name.namespace):
        return f"{written.partition(':')[0]}:{wanted.removeprefix(name.namespace)}"
    return f"<{wanted}>"
