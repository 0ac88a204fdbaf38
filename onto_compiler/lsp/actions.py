"""Code actions: what ``onto check --fix`` would do, one problem at a time or all at once."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence

from lsprotocol import types

from onto_compiler.check.edits import FIXABLE, Edit, each_edit
from onto_compiler.check.fix import repair
from onto_compiler.check.imports import Imports
from onto_compiler.check.model import load_model
from onto_compiler.lsp.diagnose import texts_of
from onto_compiler.lsp.document import Document
from onto_compiler.lsp.publish import diagnostic
from onto_compiler.lsp.session import OntoServer
from onto_compiler.problems import OntoError, Problem

__all__ = ["FIX_ALL", "OPTIONS", "actions", "resolve"]

FIX_ALL = "source.fixAll.onto"
OPTIONS = types.CodeActionOptions(
    code_action_kinds=[types.CodeActionKind.QuickFix, types.CodeActionKind.SourceFixAll], resolve_provider=True
)


async def actions(server: OntoServer, params: types.CodeActionParams) -> list[types.CodeAction]:
    """The repairs of the problems in a range, and one of all; what is no Turtle has none."""
    document = server.document(params.text_document.uri)
    if document.is_task or not document.file.exists():
        return []
    fixable = [problem for problem in server.state(document).shown if problem.code in FIXABLE]
    only = params.context.only
    found: list[types.CodeAction] = []
    if fixable and _wanted(types.CodeActionKind.QuickFix, only):
        found += _quick_fixes(server, document, fixable, params.range)
    if fixable and _wanted(FIX_ALL, only):
        action = types.CodeAction("Repair everything that onto can", kind=FIX_ALL, data=document.uri)
        # An editor that asks for this kind alone may apply it without resolving it, as on saving.
        lazily = only is None and _resolves_edits(server)
        found.append(action if lazily else await resolve(server, action))
    return found


async def resolve(server: OntoServer, action: types.CodeAction) -> types.CodeAction:
    """Add the edit to the action that repairs everything."""
    document = server.document(str(action.data))
    path, text, state = document.file, document.source, server.state(document)
    around = server.around(state)
    texts = texts_of(path, text, around)
    made = await asyncio.to_thread(repair, [path, *around], state.settings, texts, (path,))
    after = made.after.get(path, text)
    action.edit = types.WorkspaceEdit(changes={document.uri: difference(document, after)})
    return action


def difference(document: Document, after: str) -> list[types.TextEdit]:
    """What makes the text of a document ``after``: one edit of what lies between the common start and end."""
    before = document.source
    start = next((i for i, (old, new) in enumerate(zip(before, after, strict=False)) if old != new), None)
    start = min(len(before), len(after)) if start is None else start
    most = min(len(before), len(after)) - start
    same = next((i for i in range(most) if before[-1 - i] != after[-1 - i]), most)
    if before == after:
        return []
    return [types.TextEdit(document.range(start, len(before) - same), after[start : len(after) - same])]


def _quick_fixes(
    server: OntoServer, document: Document, fixable: Sequence[Problem], where: types.Range
) -> list[types.CodeAction]:
    here = {problem: shown for problem in fixable if _overlap((shown := diagnostic(document, problem)).range, where)}
    if not here:
        return []
    path, state = document.file, server.state(document)
    around, lead = server.around(state), Imports(state.settings.imported)
    try:
        model = load_model([path, *around], texts_of(path, document.source, around), lead=lead)
    except OntoError:
        return []
    return [_action(document, edit, here[edit.problem]) for edit in each_edit(model, path, here)]


def _action(document: Document, edit: Edit, shown: types.Diagnostic) -> types.CodeAction:
    change = types.TextEdit(document.range(edit.start, edit.end), edit.text)
    return types.CodeAction(
        edit.title,
        kind=types.CodeActionKind.QuickFix,
        diagnostics=[shown],
        is_preferred=True,
        edit=types.WorkspaceEdit(changes={document.uri: [change]}),
    )


def _overlap(one: types.Range, other: types.Range) -> bool:
    return one.start <= other.end and other.start <= one.end


def _wanted(kind: str, only: Sequence[types.CodeActionKind | str] | None) -> bool:
    """Whether a kind is among those asked for, which stand for all that begin so."""
    if only is None:
        return True
    named = [one.value if isinstance(one, types.CodeActionKind) else one for one in only]
    return any(kind == one or kind.startswith(f"{one}.") or one == "" for one in named)


def _resolves_edits(server: OntoServer) -> bool:
    text = server.client_capabilities.text_document
    support = text.code_action.resolve_support if text and text.code_action else None
    return support is not None and "edit" in support.properties
