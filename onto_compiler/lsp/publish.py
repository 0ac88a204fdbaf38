"""When problems are sent: at once what a keystroke can wait for, and the whole check once the typing stops."""

from __future__ import annotations

import asyncio
import re
from functools import lru_cache
from pathlib import Path

from lsprotocol import types

from onto_compiler.check.pages import FOLDER, codes
from onto_compiler.lsp.diagnose import moved, quick_turtle, task_problems, whole_turtle
from onto_compiler.lsp.document import Document
from onto_compiler.lsp.session import OntoServer, State
from onto_compiler.problems import Problem

__all__ = ["changed", "closed", "diagnostic", "recheck"]

PAUSE = 0.3  # s without a keystroke before the whole check runs
_WORD = re.compile(r"[^\s()\[\],;\"]+")
_TAGS = {
    "CFG002": types.DiagnosticTag.Unnecessary,
    "TTL007": types.DiagnosticTag.Unnecessary,
    "VOC006": types.DiagnosticTag.Deprecated,
}
_LEVELS = {
    "error": types.DiagnosticSeverity.Error,
    "warning": types.DiagnosticSeverity.Warning,
    "info": types.DiagnosticSeverity.Information,
}


def changed(server: OntoServer, document: Document) -> None:
    """Answer at once, and have the whole check run after a pause."""
    state = server.state(document)
    path, text = document.file, document.source
    if document.is_task:
        _publish(server, document, task_problems(path, text, server.lifting(document).schema, state.settings))
        return
    quick = quick_turtle(path, text, server.around(state), state.settings)
    before, late = state.settled
    _publish(server, document, (*quick, *(p for p in moved(late, before, text) if p not in quick)))
    _wait(server, document)
    for other in server.open_documents():
        if path in server.state(other).siblings:  # what is declared here may be what is missing there
            _wait(server, other)


def recheck(server: OntoServer) -> None:
    """Have every open document checked again, as files outside of the editor changed."""
    for document in server.open_documents():
        _wait(server, document)


def closed(server: OntoServer, uri: str) -> None:
    """Forget a document, and clear its problems."""
    state = server.states.pop(uri, None)
    if state is not None and state.waiting is not None:
        state.waiting.cancel()
    server.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri=uri, diagnostics=[]))


def diagnostic(document: Document, problem: Problem) -> types.Diagnostic:
    """A problem as the protocol has it, with the page of its code."""
    tag = _TAGS.get(problem.code)
    page = _pages().get(problem.code)
    return types.Diagnostic(
        range=_word_at(document, problem),
        message=f"{problem.message}\n{problem.hint}" if problem.hint else problem.message,
        severity=_LEVELS[problem.severity],
        code=problem.code,
        code_description=types.CodeDescription(page) if page else None,
        source="onto",
        tags=[tag] if tag else None,
    )


def _wait(server: OntoServer, document: Document) -> None:
    """Have the whole check of a document run after a pause, instead of the one that waits."""
    state = server.state(document)
    if state.waiting is not None:
        state.waiting.cancel()
    task = _settle(server, state, document, document.source)
    state.waiting = asyncio.get_running_loop().create_task(task)


async def _settle(server: OntoServer, state: State, document: Document, text: str) -> None:
    await asyncio.sleep(PAUSE)
    path = document.file
    await asyncio.to_thread(server.gather, path, text, state)
    _publish_settings(server)
    if document.is_task:
        changed(server, document)
        return
    around = server.around(state)
    found = await asyncio.to_thread(whole_turtle, path, text, around, state.settings)
    if document.source != text or server.states.get(document.uri) is not state:
        return
    quick = await asyncio.to_thread(quick_turtle, path, text, around, state.settings)
    state.settled = (text, tuple(problem for problem in found if problem not in quick))
    _publish(server, document, found)
    before = state.vocabulary
    if await asyncio.to_thread(server.vocabulary, document) != before:
        _refresh(server)


def _refresh(server: OntoServer) -> None:
    """Have semantic tokens asked for again, as the kinds of terms of other files are known now."""
    workspace = server.client_capabilities.workspace
    tokens = workspace.semantic_tokens if workspace else None
    if tokens is not None and tokens.refresh_support:
        server.workspace_semantic_tokens_refresh(None)


def _publish(server: OntoServer, document: Document, problems: tuple[Problem, ...]) -> None:
    state = server.state(document)
    state.shown = () if state.settings.excludes(document.file) else problems
    diagnostics = [diagnostic(document, problem) for problem in state.shown]
    server.text_document_publish_diagnostics(
        types.PublishDiagnosticsParams(uri=document.uri, version=document.version, diagnostics=diagnostics)
    )


def _publish_settings(server: OntoServer) -> None:
    """Show what is wrong with a file of settings at that file, as long as it is."""
    faults = {fault.file: fault for one in server.states.values() for fault in one.faults}
    for file in sorted(faults.keys() | server.faulty):
        document = server.document_of(Path(file))
        shown = [diagnostic(document, faults[file])] if file in faults else []
        server.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri=document.uri, diagnostics=shown))
    server.faulty = set(faults)


def _word_at(document: Document, problem: Problem) -> types.Range:
    """From the place of the problem to the end of the word there, so that there is something to underline."""
    row, column = max(problem.line, 1), max(problem.column, 1)
    line = document.line(row - 1)
    match = _WORD.match(line, column - 1)
    start = document.text.offset(row, column)
    return document.range(start, start + (match.end() - match.start() if match else int(column <= len(line))))


@lru_cache(maxsize=1)
def _pages() -> dict[str, str]:
    """The address of the page of each code, as it was installed."""
    return {code: (FOLDER / f"{code}.md").resolve().as_uri() for code in codes()}
