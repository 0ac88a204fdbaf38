"""A text in the editor, and its places in the units of the client.

The protocol ends a line at a line feed, a carriage return, or both; Python's ``splitlines``, which pygls uses, also
at a form feed or U+2028. A place behind the end of its line is that end.
"""

from __future__ import annotations

from pathlib import Path

from lsprotocol import types
from pygls import uris
from pygls.workspace import PositionCodec, TextDocument

from onto_compiler.problems import Span
from onto_compiler.turtle.tokens import SourceText

__all__ = ["Document", "read_document"]


class Document(TextDocument):
    """A document whose places are offsets into its text, or spans that count from 1 as everywhere else."""

    _places: SourceText | None = None

    @property
    def is_task(self) -> bool:
        """Whether it is a task file."""
        return self.language_id == "bddl" or self.uri.endswith(".bddl")

    @property
    def file(self) -> Path:
        """The file that it is, or will be."""
        return Path(self.path).resolve() if self.path else Path("/untitled.ttl")

    @property
    def text(self) -> SourceText:
        """The text with the offsets of its lines."""
        source = self.source
        if self._places is None or self._places.text is not source:
            self._places = SourceText(str(self.file), source)
        return self._places

    def line(self, number: int) -> str:
        """A line by its number from 0, without its end; there is none behind the last."""
        starts, source = self.text.starts, self.source
        if number >= len(starts):
            return ""
        end = starts[number + 1] if number + 1 < len(starts) else len(source)
        return source[starts[number] : end].rstrip("\r\n")

    def offset_at_position(self, client_position: types.Position) -> int:
        """The offset of a place."""
        starts = self.text.starts
        if client_position.line >= len(starts):
            return len(self.source)
        line, wanted = self.line(client_position.line), client_position.character
        if line.isascii():
            return starts[client_position.line] + min(wanted, len(line))
        units = column = 0
        while column < len(line) and units < wanted:
            units += self.position_codec.client_num_units(line[column])
            column += 1
        return starts[client_position.line] + column

    def position(self, offset: int) -> types.Position:
        """The place of an offset."""
        span = self.text.span(offset, offset)
        begin = self.text.starts[span.line - 1]
        return types.Position(span.line - 1, self.units(self.source[begin:offset]))

    def units(self, part: str) -> int:
        """How long a part of a line is to the client."""
        return len(part) if part.isascii() else self.position_codec.client_num_units(part)

    def range(self, start: int, end: int) -> types.Range:
        """The range of the characters from ``start`` up to ``end``."""
        return types.Range(self.position(start), self.position(end))

    def range_of(self, span: Span) -> types.Range:
        """The range of a span."""
        return self.range(
            self.text.offset(span.line, span.column), self.text.offset(span.end_line or span.line, span.end_column)
        )

    def apply_change(self, change: types.TextDocumentContentChangeEvent) -> None:
        """Change the text as the client did."""
        if isinstance(change, types.TextDocumentContentChangePartial):
            start, end = map(self.offset_at_position, (change.range.start, change.range.end))
            self._source = self.source[:start] + change.text + self.source[end:]
        else:
            self._source = change.text


def read_document(path: Path, codec: PositionCodec) -> Document:
    """A file that is not open; one that cannot be read is empty."""
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except (OSError, UnicodeDecodeError):
        text = ""
    return Document(uris.from_fs_path(str(path)) or path.as_uri(), source=text, position_codec=codec)
