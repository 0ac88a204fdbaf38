"""What an editor asks of a place or of a document, from the protocol's types and back."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache, partial
from pathlib import Path

from lsprotocol import types
from pygls.exceptions import JsonRpcException

from onto_compiler.lsp import bddl, task_names, turtle, turtle_names
from onto_compiler.lsp.answers import Change, Colour, Completion, Place, RefusedError, Symbol
from onto_compiler.lsp.diagnose import formatted
from onto_compiler.lsp.document import Document
from onto_compiler.lsp.session import OntoServer
from onto_compiler.lsp.siblings import MOST
from onto_compiler.problems import OntoError, Span

__all__ = [
    "LEGEND",
    "complete",
    "define",
    "document_symbols",
    "find_references",
    "format_document",
    "hover",
    "prepare_rename",
    "rename",
    "semantic_tokens",
    "workspace_symbols",
]

LEGEND = types.SemanticTokensLegend(
    token_types=[
        *("namespace", "class", "property", "variable", "type", "enumMember"),
        *("keyword", "string", "number", "comment", "function", "parameter"),
    ],
    token_modifiers=["declaration"],
)
_TYPES = {name: index for index, name in enumerate(LEGEND.token_types)}
_MOST_SYMBOLS = 500
_COMPLETIONS = {
    "class": types.CompletionItemKind.Class,
    "property": types.CompletionItemKind.Property,
    "predicate": types.CompletionItemKind.Function,
    "prefix": types.CompletionItemKind.Module,
    "name": types.CompletionItemKind.Variable,
}
_SYMBOLS = {
    "ontology": types.SymbolKind.Namespace,
    "class": types.SymbolKind.Class,
    "property": types.SymbolKind.Property,
    "shape": types.SymbolKind.Interface,
    "individual": types.SymbolKind.Constant,
    "section": types.SymbolKind.Module,
    "object": types.SymbolKind.Object,
    "region": types.SymbolKind.Field,
    "fact": types.SymbolKind.Boolean,
}
_REFUSED = -32803  # the protocol's RequestFailed


def complete(ls: OntoServer, params: types.CompletionParams) -> types.CompletionList:
    """What can stand at a place."""
    document = ls.document(params.text_document.uri)
    offset = document.offset_at_position(params.position)
    if document.is_task:
        offers = bddl.complete(document.source, offset, ls.lifting(document).schema)
    else:
        offers = turtle.complete(document.source, offset, ls.vocabulary(document))
    items = [_item(document, offer, params.position, rank) for rank, offer in enumerate(offers)]
    return types.CompletionList(is_incomplete=False, items=items)


def hover(ls: OntoServer, params: types.HoverParams) -> types.Hover | None:
    """What stands at a place."""
    document = ls.document(params.text_document.uri)
    offset = document.offset_at_position(params.position)
    if document.is_task:
        info = bddl.hover(document.source, offset, ls.lifting(document).schema)
    else:
        info = turtle.hover(document.source, offset, ls.vocabulary(document))
    if info is None:
        return None
    content = types.MarkupContent(types.MarkupKind.Markdown, info.markdown)
    return types.Hover(content, document.range_of(info.span))


def define(ls: OntoServer, params: types.DefinitionParams) -> types.Location | list[types.Location] | None:
    """Where the name at a place is declared: in the task, or else in the ontology, there perhaps at several places."""
    document = ls.document(params.text_document.uri)
    offset, path = document.offset_at_position(params.position), document.file
    if not document.is_task:
        span = turtle.defined_at(document.source, path, offset, ls.vocabulary(document), ls.text_of)
        return _location(ls, document, span) if span else None
    span = bddl.defined_at(document.source, str(path), offset)
    if span is not None:
        return _location(ls, document, span)
    lifting = ls.lifting(document)
    terms = bddl.terms_at(document.source, offset, lifting.schema, lifting.categories)
    blocks = (turtle.block_of(iri, lifting.vocabulary, ls.text_of) for iri in terms)
    found = [_location(ls, document, block) for block in blocks if block]
    return found[0] if len(found) == 1 else found or None


def find_references(ls: OntoServer, params: types.ReferenceParams) -> list[types.Location]:
    """Where the name at a place is written in the workspace."""
    document = ls.document(params.text_document.uri)
    offset, path = document.offset_at_position(params.position), document.file
    declarations = params.context.include_declaration
    if document.is_task:
        use = task_names.use_at(document.source, offset)
        shared = use is not None and use.kind in {"predicate", "category"}
        tasks = {**(ls.texts(ls.files(path, ".bddl")) if shared else {}), path: document.source}
        found = task_names.references(use, tasks, declarations=declarations) if use else ()
    else:
        name = turtle_names.read_outline(path, document.source).at(offset)
        texts = _turtle(ls, document)
        found = turtle_names.references(name.iri, texts, declarations=declarations) if name else ()
    return _locations(ls, found)


def prepare_rename(ls: OntoServer, params: types.PrepareRenameParams) -> types.PrepareRenamePlaceholder:
    """The part of the name at a place that can be changed.

    Raises:
        JsonRpcException: it cannot be; the message says why.

    """
    document = ls.document(params.text_document.uri)
    offset = document.offset_at_position(params.position)
    try:
        if document.is_task:
            use, written = task_names.renamable(document.source, offset)
            return types.PrepareRenamePlaceholder(document.range(use.start, use.end), written)
        name, local, start = turtle_names.renamable(document.source, document.file, offset)
        turtle_names.refuse_foreign(name, local, _turtle(ls, document), ls.vocabulary(document))
        return types.PrepareRenamePlaceholder(document.range(start, start + len(local)), local)
    except RefusedError as error:
        raise JsonRpcException(str(error), _REFUSED) from error


def rename(ls: OntoServer, params: types.RenameParams) -> types.WorkspaceEdit:
    """The edits that give the name at a place another.

    Raises:
        JsonRpcException: it cannot be renamed so; the message says why.

    """
    document = ls.document(params.text_document.uri)
    offset, path = document.offset_at_position(params.position), document.file
    try:
        if document.is_task:
            use, _ = task_names.renamable(document.source, offset)
            return _edit(ls, task_names.rename(use, params.new_name, path, document.source))
        name, local, _ = turtle_names.renamable(document.source, path, offset)
        texts = _turtle(ls, document)
        changes = turtle_names.rename(name, local, params.new_name, texts, ls.vocabulary(document))
    except RefusedError as error:
        raise JsonRpcException(str(error), _REFUSED) from error
    return _edit(ls, changes)


def document_symbols(ls: OntoServer, params: types.DocumentSymbolParams) -> list[types.DocumentSymbol]:
    """What a document declares."""
    document = ls.document(params.text_document.uri)
    found = task_names.symbols if document.is_task else partial(turtle_names.symbols, path=document.file)
    return [_symbol(document, symbol) for symbol in found(document.source)]


def workspace_symbols(ls: OntoServer, params: types.WorkspaceSymbolParams) -> list[types.WorkspaceSymbol]:
    """What the files of the workspace declare, of that whose name holds the letters of the query in their order."""
    found: list[types.WorkspaceSymbol] = []
    files = {document.file for document in ls.open_documents()}
    files.update(file for folder in ls.folders() for file in ls.files(folder, ".ttl", ".bddl"))
    held = {document.file: document.source for document in ls.open_documents()}
    for path in sorted(files):
        symbols = _symbols(path, held[path]) if path in held else _stored_symbols(path)
        flat = [inner for one in symbols for inner in (one.children if one.kind == "section" else (one,))]
        fitting = [symbol for symbol in flat if _fits(params.query, symbol.name)]
        if fitting:
            document = ls.document_of(path)
            found += [_workspace_symbol(document, symbol) for symbol in fitting[: _MOST_SYMBOLS - len(found)]]
    return found


def semantic_tokens(ls: OntoServer, params: types.SemanticTokensParams) -> types.SemanticTokens:
    """What each part of a document is."""
    document = ls.document(params.text_document.uri)
    if document.is_task:
        return types.SemanticTokens(_encoded(document, task_names.colours(document.source)))
    known = ls.state(document).vocabulary or {}
    return types.SemanticTokens(_encoded(document, turtle_names.colours(document.source, document.file, known)))


def format_document(ls: OntoServer, params: types.DocumentFormattingParams) -> list[types.TextEdit]:
    """The layout of ``onto fmt``; a document that is broken stays as it is, and its problems are shown anyway."""
    document = ls.document(params.text_document.uri)
    before = document.source
    try:
        after = formatted(document.file, before, task=document.is_task)
    except OntoError:
        return []
    return [] if after == before else [types.TextEdit(document.range(0, len(before)), after)]


def _turtle(ls: OntoServer, document: Document) -> Mapping[Path, str]:
    """The Turtle and the queries of the folder that a document is in."""
    path = document.file
    return {**ls.texts(ls.files(path, ".ttl", ".rq")), path: document.source}


def _location(ls: OntoServer, document: Document, span: Span) -> types.Location:
    target = document if span.file == str(document.file) else ls.document_of(Path(span.file))
    return types.Location(target.uri, target.range_of(span))


def _locations(ls: OntoServer, places: Iterable[Place]) -> list[types.Location]:
    documents: dict[Path, Document] = {}
    found = []
    for place in places:
        document = documents.get(place.file) or documents.setdefault(place.file, ls.document_of(place.file))
        found.append(types.Location(document.uri, document.range(place.start, place.end)))
    return found


def _edit(ls: OntoServer, changes: Sequence[Change]) -> types.WorkspaceEdit:
    edits: dict[str, list[types.TextEdit]] = {}
    documents = {path: ls.document_of(path) for path in {change.file for change in changes}}
    for change in changes:
        document = documents[change.file]
        edits.setdefault(document.uri, []).append(types.TextEdit(document.range(change.start, change.end), change.text))
    return types.WorkspaceEdit(changes=edits)


def _symbols(path: Path, text: str) -> tuple[Symbol, ...]:
    return task_names.symbols(text) if path.suffix == ".bddl" else turtle_names.symbols(text, path)


def _stored_symbols(path: Path) -> tuple[Symbol, ...]:
    try:
        state = path.stat()
    except OSError:
        return ()
    return _read_symbols(path, state.st_mtime_ns, state.st_size)


@lru_cache(maxsize=2 * MOST)
def _read_symbols(path: Path, _modified: int, _size: int) -> tuple[Symbol, ...]:
    """The symbols of a file; the time and the size are part of the question, so that a change is noticed."""
    try:
        return _symbols(path, path.read_bytes().decode("utf-8-sig"))
    except (OSError, UnicodeDecodeError):
        return ()


def _symbol(document: Document, symbol: Symbol) -> types.DocumentSymbol:
    return types.DocumentSymbol(
        name=symbol.name,
        kind=_SYMBOLS[symbol.kind],
        detail=symbol.detail or None,
        range=document.range(symbol.start, symbol.end),
        selection_range=document.range(symbol.name_start, symbol.name_end),
        tags=[types.SymbolTag.Deprecated] if symbol.deprecated else None,
        children=[_symbol(document, inner) for inner in symbol.children] or None,
    )


def _workspace_symbol(document: Document, symbol: Symbol) -> types.WorkspaceSymbol:
    return types.WorkspaceSymbol(
        location=types.Location(document.uri, document.range(symbol.name_start, symbol.name_end)),
        name=symbol.name,
        kind=_SYMBOLS[symbol.kind],
        container_name=document.filename,
        tags=[types.SymbolTag.Deprecated] if symbol.deprecated else None,
    )


def _fits(query: str, name: str) -> bool:
    letters = iter(name.casefold())
    return all(letter in letters for letter in query.casefold())


def _encoded(document: Document, colours: Iterable[Colour]) -> list[int]:
    """Five numbers for each: lines and units from the one before, length, type and modifiers."""
    starts, source = document.text.starts, document.source
    data: list[int] = []
    line = last_line = last_column = 0
    for colour in colours:
        while line + 1 < len(starts) and starts[line + 1] <= colour.start:
            line += 1
        column = document.units(source[starts[line] : colour.start])
        length = document.units(source[colour.start : colour.end])
        data += (
            line - last_line,
            column - last_column if line == last_line else column,
            length,
            _TYPES[colour.kind],
            int(colour.declares),
        )
        last_line, last_column = line, column
    return data


def _item(document: Document, offer: Completion, cursor: types.Position, rank: int) -> types.CompletionItem:
    return types.CompletionItem(
        label=offer.text,
        kind=_COMPLETIONS[offer.kind],
        detail=offer.detail or None,
        documentation=offer.about or None,
        sort_text=f"{rank:05}",
        filter_text=offer.text,
        text_edit=types.TextEdit(types.Range(document.position(offer.start), cursor), offer.text),
    )
