"""The state of the language server between requests: documents, and the files, settings and terms around them."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import cast
from urllib.parse import unquote

from lsprotocol import types
from pygls import uris
from pygls.lsp.server import LanguageServer
from pyoxigraph import QuerySolutions, Store

from onto_compiler.check.imports import Imports
from onto_compiler.check.model import load_model
from onto_compiler.check.settings import DEFAULT, Settings, read_settings
from onto_compiler.compile_schema import compile_schema
from onto_compiler.lsp.diagnose import NOTHING, Around
from onto_compiler.lsp.document import Document, read_document
from onto_compiler.lsp.siblings import files_below, header, ontologies_above, siblings, turtle_below
from onto_compiler.lsp.vocabulary import VocabularyTerm, read_vocabulary
from onto_compiler.problems import OntoError, Problem
from onto_compiler.rdf import prologue
from onto_compiler.schema import Schema
from onto_compiler.sources import collect, read_into

__all__ = ["Lifting", "OntoServer"]

_CATEGORIES = "SELECT ?name ?term WHERE { GRAPH ?g { ?term a core:Category ; core:category ?name } } ORDER BY ?term"


@dataclass(frozen=True, slots=True)
class Lifting:
    """What task files are lifted by, and where its terms are declared."""

    schema: Schema
    vocabulary: Mapping[str, VocabularyTerm]
    categories: Mapping[str, str]  # asset category -> the IRI that declares it


@dataclass(slots=True)
class State:
    """What is known of an open document: ``settled`` are its text and what only the whole check finds in it."""

    siblings: tuple[Path, ...] = ()
    settings: Settings = DEFAULT
    faults: tuple[Problem, ...] = ()  # of the settings
    shown: tuple[Problem, ...] = ()
    settled: tuple[str, tuple[Problem, ...]] = ("", ())
    vocabulary: Mapping[str, VocabularyTerm] | None = None
    waiting: asyncio.Task[None] | None = field(default=None, repr=False)


class OntoServer(LanguageServer):
    """``extra`` is the Turtle of ``--ontology``; ``states`` are those of the open documents by their address."""

    def __init__(self, extra: tuple[Path, ...]) -> None:
        super().__init__("onto", version("onto-evwm"))
        self.extra = collect(extra)
        self.states: dict[str, State] = {}
        self.faulty: set[str] = set()  # files of settings that are shown to be wrong
        self._lifting: dict[object, Lifting] = {}

    # Documents and files

    def open(self, item: types.TextDocumentItem) -> None:
        """Take the place of pygls, whose documents end a line where the protocol does not."""
        documents = cast("dict[str, Document]", self.workspace.text_documents)
        documents[unquote(item.uri)] = Document(
            item.uri,
            source=item.text,
            version=item.version,
            language_id=item.language_id,
            position_codec=self.workspace.position_codec,
        )

    def document(self, uri: str) -> Document:
        """An open document, or the file of that address."""
        found = self.workspace.text_documents.get(unquote(uri))
        return found if isinstance(found, Document) else self.document_of(Path(uris.to_fs_path(uri) or ""))

    def document_of(self, path: Path) -> Document:
        """The document of a file, open or not."""
        held = (one for one in self.open_documents() if one.file == path)
        return next(held, None) or read_document(path, self.workspace.position_codec)

    def text_of(self, path: Path) -> str:
        """The text of a file, as the editor holds it where it is open; one that cannot be read has none."""
        return self.document_of(path).source

    def open_documents(self) -> list[Document]:
        """Every open document."""
        return [one for one in self.workspace.text_documents.values() if isinstance(one, Document)]

    def folders(self) -> list[Path]:
        """The folders of the workspace."""
        addresses = [one.uri for one in self.workspace.folders.values()] or [self.workspace.root_uri or ""]
        return [Path(name).resolve() for uri in addresses if uri and (name := uris.to_fs_path(uri))]

    def files(self, path: Path, *endings: str) -> tuple[Path, ...]:
        """The files of the workspace folder that ``path`` is in; without one, those beside it."""
        inside = [folder for folder in self.folders() if path.is_relative_to(folder)]
        if inside:
            return files_below(inside, endings)
        return tuple(sorted(one for one in path.parent.glob("*") if one.suffix in endings))

    def texts(self, files: Sequence[Path]) -> dict[Path, str]:
        """The text of each file, as the editor holds it."""
        held = {one.file: one.source for one in self.open_documents()}
        return {file: held[file] if file in held else self.document_of(file).source for file in files}

    # What belongs to a document

    def state(self, document: Document) -> State:
        """The state of a document; of one that is not open, a new one each time."""
        if document.uri in self.states:
            return self.states[document.uri]
        state = State()
        if unquote(document.uri) in self.workspace.text_documents:
            self.states[document.uri] = state
        self.gather(document.file, document.source, state)
        return state

    def gather(self, path: Path, text: str, state: State) -> None:
        """Read the settings again, and find the files that belong to a document."""
        try:
            state.settings, state.faults = read_settings([path]), ()
        except OntoError as error:
            state.settings, state.faults = DEFAULT, error.problems
        if path.suffix == ".bddl":
            state.siblings = self.extra or self._above(path)
        elif path.exists():
            inside = [folder for folder in self.folders() if path.is_relative_to(folder)]
            files = turtle_below(inside) if inside else tuple(sorted(path.parent.glob("*.ttl")))
            given = [file for file in files if not state.settings.excludes(file)]
            state.siblings = siblings(path, header(text, path), given)

    def _above(self, path: Path) -> tuple[Path, ...]:
        inside = [folder for folder in self.folders() if path.is_relative_to(folder)]
        return ontologies_above(path, min(inside, key=lambda one: len(one.parts), default=path.parent))

    def around(self, state: State) -> Around:
        """The files that belong to a document, with the text of those that are open and not broken."""
        if not state.siblings:
            return NOTHING
        held = {one.file: one.source for one in self.open_documents()}
        return {
            file: text if (text := held.get(file)) and not read_into(Store(), file, text) else None
            for file in state.siblings
        }

    def vocabulary(self, document: Document) -> Mapping[str, VocabularyTerm]:
        """Every term in sight of a Turtle document; while it is broken, what was in sight before."""
        state = self.state(document)
        path, text, around = document.file, document.source, self.around(state)
        given = [*self.extra, *around, *([path] if path.exists() else [])]
        texts = {file: held for file, held in around.items() if held is not None}
        lead = Imports(state.settings.imported)
        try:
            state.vocabulary = read_vocabulary(load_model(given, {**texts, path: text}, lead=lead).store)
        except OntoError:
            if state.vocabulary is None:
                state.vocabulary = read_vocabulary(load_model().store)
        return state.vocabulary

    def lifting(self, document: Document) -> Lifting:
        """What a task file is lifted by; where an ontology of the workspace is broken, by the shipped one alone."""
        state = self.state(document)
        around, imported = self.around(state), state.settings.imported
        files = [*around, *imported.values()]
        stamps = tuple((file, around.get(file) or (file.stat().st_mtime_ns if file.exists() else 0)) for file in files)
        if stamps not in self._lifting:
            texts = {file: text for file, text in around.items() if text is not None}
            try:
                found = _lifting(load_model(tuple(around), texts, lead=Imports(imported)).store)
            except OntoError:
                if not around or self.extra:
                    raise
                found = _lifting(load_model().store)
            self._lifting = {**dict(list(self._lifting.items())[-3:]), stamps: found}
        return self._lifting[stamps]


def _lifting(store: Store) -> Lifting:
    rows = cast("QuerySolutions", store.query(prologue() + _CATEGORIES))
    categories = {row["name"].value.casefold(): row["term"].value for row in rows}
    return Lifting(compile_schema(store), read_vocabulary(store), categories)
