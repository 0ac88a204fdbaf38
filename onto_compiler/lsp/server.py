"""The language server: which function answers what."""

from __future__ import annotations

from pathlib import Path

from lsprotocol import types

from onto_compiler.lsp import requests
from onto_compiler.lsp.actions import OPTIONS, actions, resolve
from onto_compiler.lsp.publish import changed, closed, recheck
from onto_compiler.lsp.session import OntoServer

__all__ = ["make_server"]

_WATCHED = ("**/*.ttl", "**/{pyproject,onto}.toml")
"""What is found in an open file may depend on these."""


def make_server(extra: tuple[Path, ...] = ()) -> OntoServer:
    """A server that is ready to be started; ``extra`` is the user's own Turtle, for task files."""
    server = OntoServer(extra)
    server.feature(types.INITIALIZED)(_ready)
    server.feature(types.TEXT_DOCUMENT_DID_OPEN)(_opened)
    server.feature(types.TEXT_DOCUMENT_DID_CHANGE)(_typed)
    server.feature(types.TEXT_DOCUMENT_DID_CLOSE)(_closed)
    server.feature(types.WORKSPACE_DID_CHANGE_WATCHED_FILES)(_watched)
    server.feature(types.TEXT_DOCUMENT_CODE_ACTION, OPTIONS)(actions)
    server.feature(types.CODE_ACTION_RESOLVE)(resolve)
    completion = types.CompletionOptions(trigger_characters=[":", "("])
    server.feature(types.TEXT_DOCUMENT_COMPLETION, completion)(requests.complete)
    server.feature(types.TEXT_DOCUMENT_HOVER)(requests.hover)
    server.feature(types.TEXT_DOCUMENT_DEFINITION)(requests.define)
    server.feature(types.TEXT_DOCUMENT_REFERENCES)(requests.find_references)
    server.feature(types.TEXT_DOCUMENT_PREPARE_RENAME)(requests.prepare_rename)
    server.feature(types.TEXT_DOCUMENT_RENAME, types.RenameOptions(prepare_provider=True))(requests.rename)
    server.feature(types.TEXT_DOCUMENT_DOCUMENT_SYMBOL)(requests.document_symbols)
    server.feature(types.WORKSPACE_SYMBOL)(requests.workspace_symbols)
    server.feature(types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL, requests.LEGEND)(requests.semantic_tokens)
    server.feature(types.TEXT_DOCUMENT_FORMATTING)(requests.format_document)
    return server


async def _ready(ls: OntoServer, _params: types.InitializedParams) -> None:
    """Ask for word of changes outside of the editor, where it can give it."""
    workspace = ls.client_capabilities.workspace
    watching = workspace.did_change_watched_files if workspace else None
    if watching is not None and watching.dynamic_registration:
        options = types.DidChangeWatchedFilesRegistrationOptions([types.FileSystemWatcher(one) for one in _WATCHED])
        name = types.WORKSPACE_DID_CHANGE_WATCHED_FILES
        await ls.client_register_capability_async(types.RegistrationParams([types.Registration(name, name, options)]))


def _opened(ls: OntoServer, params: types.DidOpenTextDocumentParams) -> None:
    ls.open(params.text_document)
    changed(ls, ls.document(params.text_document.uri))


def _typed(ls: OntoServer, params: types.DidChangeTextDocumentParams) -> None:
    changed(ls, ls.document(params.text_document.uri))


def _closed(ls: OntoServer, params: types.DidCloseTextDocumentParams) -> None:
    closed(ls, params.text_document.uri)


def _watched(ls: OntoServer, _params: types.DidChangeWatchedFilesParams) -> None:
    recheck(ls)
