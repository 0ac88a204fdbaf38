"""The protocol's side of the language server: documents, positions in UTF-16, and when diagnostics are sent."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path

from lsprotocol import types
from pygls import uris
from pygls.lsp.server import LanguageServer
from pygls.workspace import ServerTextPosition, ServerTextRange, TextDocument
from pyoxigraph import Store

from onto_compiler.check.model import load_model
from onto_compiler.compile_schema import compile_schema
from onto_compiler.lsp import bddl, turtle
from onto_compiler.lsp.answers import Completion
from onto_compiler.lsp.diagnose import NOTHING, Around, formatted, moved, quick_turtle, task_problems, whole_turtle
from onto_compiler.lsp.siblings import header, siblings, turtle_below
from onto_compiler.lsp.vocabulary import VocabularyTerm, read_vocabulary
from onto_compiler.problems import OntoError, Problem, Span
from onto_compiler.schema import Schema
from onto_compiler.sources import read_into
from onto_compiler.turtle.tokens import SourceText

__all__ = ["make_server"]

PAUSE = 0.3  # s without a keystroke before the whole check runs
_WORD = re.compile(r"[^\s()\[\],;\"]+")
_KINDS = {
    "class": types.CompletionItemKind.Class,
    "property": types.CompletionItemKind.Property,
    "predicate": types.CompletionItemKind.Function,
    "prefix": types.CompletionItemKind.Module,
    "name": types.CompletionItemKind.Variable,
}


class OntoServer(LanguageServer):
    """The state between requests: the vocabulary, the schema, and the findings of the last full check."""

    def __init__(self, extra: tuple[Path, ...]) -> None:
        super().__init__("onto", version("onto-evwm"))
        self.extra = extra
        self.vocabularies: dict[str, Mapping[str, VocabularyTerm]] = {}
        self.schema: Schema | None = None
        self.settled: dict[str, tuple[str, tuple[Problem, ...]]] = {}
        self.waiting: dict[str, asyncio.Task[None]] = {}
        self.siblings: dict[str, tuple[Path, ...]] = {}

    def compiled(self) -> Schema:
        """The schema of the shipped ontology with the files of ``--ontology`` on top."""
        if self.schema is None:
            self.schema = compile_schema(load_model(self.extra).store)
        return self.schema

    def vocabulary(self, document: TextDocument) -> Mapping[str, VocabularyTerm]:
        """Every term in sight of a Turtle document; while it is broken, what was in sight before."""
        path, text = _path(document), document.source
        around = self.around(document.uri)
        given = [*self.extra, *around, *([path] if path.exists() else [])]
        texts = {file: held for file, held in around.items() if held is not None}
        try:
            self.vocabularies[document.uri] = read_vocabulary(load_model(given, {**texts, path: text}).store)
        except OntoError:
            if document.uri not in self.vocabularies:
                self.vocabularies[document.uri] = read_vocabulary(load_model().store)
        return self.vocabularies[document.uri]

    def gather(self, uri: str, path: Path, text: str) -> None:
        """Find the files that belong to a document; without a workspace, among those of its folder."""
        folders = [
            Path(name).resolve() for one in self.workspace.folders.values() if (name := uris.to_fs_path(one.uri))
        ]
        inside = [folder for folder in folders if path.is_relative_to(folder)]
        files = turtle_below(inside) if inside else tuple(sorted(path.parent.glob("*.ttl")))
        self.siblings[uri] = siblings(path, header(text, path), files) if path.exists() else ()

    def around(self, uri: str) -> Around:
        """The files that belong to a document, with the text of those that are open and not broken."""
        found = self.siblings.get(uri, ())
        if not found:
            return NOTHING
        held = {_path(document): document.source for document in self.workspace.text_documents.values()}
        return {
            file: text if (text := held.get(file)) and not read_into(Store(), file, text) else None for file in found
        }


def make_server(extra: tuple[Path, ...] = ()) -> OntoServer:
    """A server that is ready to be started; ``extra`` is the user's own Turtle, for task files."""
    server = OntoServer(extra)
    server.feature(types.TEXT_DOCUMENT_DID_OPEN)(_opened)
    server.feature(types.TEXT_DOCUMENT_DID_CHANGE)(_typed)
    server.feature(types.TEXT_DOCUMENT_DID_CLOSE)(_closed)
    server.feature(types.TEXT_DOCUMENT_COMPLETION, types.CompletionOptions(trigger_characters=[":", "("]))(_complete)
    server.feature(types.TEXT_DOCUMENT_HOVER)(_hover)
    server.feature(types.TEXT_DOCUMENT_DEFINITION)(_definition)
    server.feature(types.TEXT_DOCUMENT_FORMATTING)(_format)
    return server


def _opened(ls: OntoServer, params: types.DidOpenTextDocumentParams) -> None:
    _changed(ls, params.text_document.uri)


def _typed(ls: OntoServer, params: types.DidChangeTextDocumentParams) -> None:
    _changed(ls, params.text_document.uri)


def _closed(ls: OntoServer, params: types.DidCloseTextDocumentParams) -> None:
    uri = params.text_document.uri
    if uri in ls.waiting:
        ls.waiting.pop(uri).cancel()
    ls.settled.pop(uri, None)
    ls.vocabularies.pop(uri, None)
    ls.siblings.pop(uri, None)
    ls.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri=uri, diagnostics=[]))


def _complete(ls: OntoServer, params: types.CompletionParams) -> types.CompletionList:
    document = ls.workspace.get_text_document(params.text_document.uri)
    offset = document.offset_at_position(params.position)
    if _is_task(document):
        offers = bddl.complete(document.source, offset, ls.compiled())
    else:
        offers = turtle.complete(document.source, offset, ls.vocabulary(document))
    items = [_item(document, offer, params.position, rank) for rank, offer in enumerate(offers)]
    return types.CompletionList(is_incomplete=False, items=items)


def _hover(ls: OntoServer, params: types.HoverParams) -> types.Hover | None:
    document = ls.workspace.get_text_document(params.text_document.uri)
    offset = document.offset_at_position(params.position)
    if _is_task(document):
        info = bddl.hover(document.source, offset, ls.compiled())
    else:
        info = turtle.hover(document.source, offset, ls.vocabulary(document))
    if info is None:
        return None
    content = types.MarkupContent(types.MarkupKind.Markdown, info.markdown)
    return types.Hover(content, _range(document, info.span))


def _definition(ls: OntoServer, params: types.DefinitionParams) -> types.Location | None:
    document = ls.workspace.get_text_document(params.text_document.uri)
    offset, path = document.offset_at_position(params.position), _path(document)
    if _is_task(document):
        span = bddl.defined_at(document.source, str(path), offset)
    else:
        span = turtle.defined_at(document.source, path, offset, ls.vocabulary(document))
    if span is None:
        return None
    uri = document.uri if span.file == str(path) else uris.from_fs_path(span.file)
    target = document if uri == document.uri else ls.workspace.get_text_document(uri or "")
    return types.Location(uri or document.uri, _range(target, span))


def _format(ls: OntoServer, params: types.DocumentFormattingParams) -> list[types.TextEdit]:
    """The layout of ``onto fmt``; a document that is broken stays as it is, and its problems are shown anyway."""
    document = ls.workspace.get_text_document(params.text_document.uri)
    before = document.source
    try:
        after = formatted(_path(document), before, task=_is_task(document))
    except OntoError:
        return []
    if after == before:
        return []
    end = SourceText("", before).span(len(before), len(before))
    return [types.TextEdit(_range(document, Span("", 1, 1, end.end_line, end.end_column)), after)]


def _changed(server: OntoServer, uri: str) -> None:
    """Answer at once, and have the whole check run once the typing stops."""
    document = server.workspace.get_text_document(uri)
    path, text = _path(document), document.source
    if _is_task(document):
        _publish(server, document, task_problems(path, text, server.compiled()))
        return
    if uri not in server.siblings:
        server.gather(uri, path, text)
    quick = quick_turtle(path, text, server.around(uri))
    before, late = server.settled.get(uri, ("", ()))
    _publish(server, document, (*quick, *(p for p in moved(late, before, text) if p not in quick)))
    _wait(server, document)
    for other, files in server.siblings.items():
        if path in files:  # what is declared here may be what is missing there
            _wait(server, server.workspace.get_text_document(other))


def _wait(server: OntoServer, document: TextDocument) -> None:
    """Have the whole check of a document run after a pause, instead of the one that waits."""
    uri = document.uri
    if uri in server.waiting:
        server.waiting.pop(uri).cancel()
    task = _settle(server, uri, _path(document), document.source)
    server.waiting[uri] = asyncio.get_running_loop().create_task(task)


async def _settle(server: OntoServer, uri: str, path: Path, text: str) -> None:
    await asyncio.sleep(PAUSE)
    await asyncio.to_thread(server.gather, uri, path, text)
    around = server.around(uri)
    found = await asyncio.to_thread(whole_turtle, path, text, around)
    document = server.workspace.get_text_document(uri)
    if document.source != text or uri not in server.waiting:
        return
    quick = await asyncio.to_thread(quick_turtle, path, text, around)
    server.settled[uri] = (text, tuple(problem for problem in found if problem not in quick))
    _publish(server, document, found)


def _publish(server: OntoServer, document: TextDocument, problems: tuple[Problem, ...]) -> None:
    diagnostics = [_diagnostic(document, problem) for problem in problems]
    server.text_document_publish_diagnostics(
        types.PublishDiagnosticsParams(uri=document.uri, version=document.version, diagnostics=diagnostics)
    )


def _diagnostic(document: TextDocument, problem: Problem) -> types.Diagnostic:
    levels = types.DiagnosticSeverity
    severity = {"error": levels.Error, "warning": levels.Warning, "info": levels.Information}[problem.severity]
    message = f"{problem.message}\n{problem.hint}" if problem.hint else problem.message
    return types.Diagnostic(
        range=_range(document, _word_at(document, problem)),
        message=message,
        severity=severity,
        code=problem.code,
        source="onto",
    )


def _word_at(document: TextDocument, problem: Problem) -> Span:
    """From the place of the problem to the end of the word there, so that there is something to underline."""
    lines = document.lines
    row, column = max(problem.line, 1), max(problem.column, 1)
    text = lines[row - 1] if row <= len(lines) else ""
    match = _WORD.match(text, column - 1)
    end = match.end() if match else min(column, len(text.rstrip("\r\n")))
    return Span(problem.file, row, column, row, max(end + 1, column))


def _range(document: TextDocument, span: Span) -> types.Range:
    """A span in the units of the client, which usually counts UTF-16."""
    start = ServerTextPosition(max(span.line - 1, 0), max(span.column - 1, 0))
    end = ServerTextPosition(max(span.end_line - 1, 0), max(span.end_column - 1, 0))
    return document.range_to_client_units(ServerTextRange(start, end))


def _item(document: TextDocument, offer: Completion, cursor: types.Position, rank: int) -> types.CompletionItem:
    source = SourceText("", document.source)
    begin = source.span(offer.start, offer.start)
    span = types.Range(_range(document, begin).start, cursor)
    return types.CompletionItem(
        label=offer.text,
        kind=_KINDS[offer.kind],
        detail=offer.detail or None,
        documentation=offer.about or None,
        sort_text=f"{rank:05}",
        filter_text=offer.text,
        text_edit=types.TextEdit(span, offer.text),
    )


def _is_task(document: TextDocument) -> bool:
    return document.language_id == "bddl" or document.uri.endswith(".bddl")


def _path(document: TextDocument) -> Path:
    return Path(document.path).resolve() if document.path else Path("/untitled.ttl")
