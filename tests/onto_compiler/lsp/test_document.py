"""Places of a document are the protocol's: lines end as it says, and columns count its units."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

types = pytest.importorskip("lsprotocol.types")
from pygls.workspace import PositionCodec  # noqa: E402 - as above

from onto_compiler.lsp.document import Document, read_document  # noqa: E402 - as above

TEXTS = st.text(st.sampled_from("ab \n\r\u2028\u0085\x0c\x1eäß😀𝄞"), max_size=30)
ENCODINGS = {
    types.PositionEncodingKind.Utf8: ("utf-8", 1),
    types.PositionEncodingKind.Utf16: ("utf-16-le", 2),
    types.PositionEncodingKind.Utf32: ("utf-32-le", 4),
}


def units(text, encoding):
    name, size = ENCODINGS[encoding]
    return len(text.encode(name)) // size


def document(text, encoding=types.PositionEncodingKind.Utf16):
    return Document("file:///d.ttl", source=text, position_codec=PositionCodec(encoding))


@given(TEXTS, st.integers(0, 30), st.sampled_from(sorted(ENCODINGS)))
def test_a_place_and_its_offset_lead_to_each_other(text, offset, encoding):
    offset = min(offset, len(text))
    if text[max(offset - 1, 0) : offset + 1] == "\r\n":
        return  # within a line end there is no place
    rows = re.split(r"\r\n|\n|\r", text[:offset])
    found = document(text, encoding).position(offset)
    assert (found.line, found.character) == (len(rows) - 1, units(rows[-1], encoding))
    assert document(text, encoding).offset_at_position(found) == offset


@given(TEXTS, st.integers(0, 30), st.integers(0, 30), TEXTS)
def test_a_change_is_what_the_client_did(text, one, other, new):
    start, end = sorted((min(one, len(text)), min(other, len(text))))
    held = document(text)
    where = held.range(start, end)
    start, end = map(held.offset_at_position, (where.start, where.end))
    held.apply_change(types.TextDocumentContentChangePartial(range=where, text=new))
    assert held.source == text[:start] + new + text[end:]
    held.apply_change(types.TextDocumentContentChangeWholeDocument(text="all"))
    assert held.source == "all"


def test_a_place_behind_the_end_is_the_end():
    held = document("ab\r\nc😀")
    for line, character, offset in ((0, 9, 2), (1, 9, 6), (7, 0, 6)):
        assert held.offset_at_position(types.Position(line, character)) == offset
    assert held.line(0) == "ab"
    assert held.line(7) == ""


def test_a_file_keeps_its_line_ends_and_loses_its_byte_order_mark(tmp_path):
    path = tmp_path / "a.ttl"
    path.write_bytes(b"\xef\xbb\xbfa\r\nb")
    assert read_document(path, PositionCodec()).source == "a\r\nb"
    path.write_bytes(b"\xff")
    assert read_document(path, PositionCodec()).source == ""
