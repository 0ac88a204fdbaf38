"""Syntax errors point at the slip and say what was expected."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import Store

import ontology
from onto_compiler.sources import read_into

HEAD = "@prefix ex: <https://example.org/> .\n"
CASES = [
    ("ex:s ex:p .", "TTL001", 2, 11, "expected an object, found `.`", "write an object here"),
    ("ex:s .", "TTL001", 2, 6, "expected a predicate, found `.`", "write a predicate here"),
    ('ex:s ex:p 1 .\n  ex:q "x" .', "TTL001", 3, 8, "expected a predicate", "does line 2 end with `.`"),
    ("ex:s ex:p 1 ,, 2 .", "TTL001", 2, 14, "expected an object, found `,`", "remove the `,`"),
    ("ex:s ex:p 1 ! .", "TTL001", 2, 13, "expected a subject, found `!`", "write a subject here"),
    ("ex:s ex:p ! .", "TTL001", 2, 11, "expected an object, found `!`", "write an object"),
    (
        "owl:s ex:p 1 .",
        "TTL003",
        2,
        1,
        "`owl:` is not declared",
        "add `@prefix owl: <http://www.w3.org/2002/07/owl#> .`",
    ),
    ("exx:s ex:p 1 .", "TTL003", 2, 1, "`exx:` is not declared", "did you mean `ex:`?"),
    ('ex:s ex:p "abc .\nex:s ex:p "d" .', "TTL004", 2, 11, "never closed", 'close it with "'),
    ('ex:s ex:p """abc .\n"', "TTL004", 2, 11, "never closed", 'close it with """'),
    ("ex:s ex:p 1\nex:s ex:p 2 .", "TTL005", 2, 12, "has no `.`", "put `;` here if `ex:s`"),
    ("ex:s ex:p 1", "TTL005", 2, 12, "has no `.`", "end the statement with `.`"),
    ("ex:s ex:p [ ex:q 1 .", "TTL006", 2, 11, "the `[` that opens here", "close it with `]`"),
    ("ex:s ex:p ( 1 [ ] .", "TTL006", 2, 11, "the `(` that opens here", "close it with `)`"),
    ("ex:s ex:p <https://example.org/a b> .", "TTL001", 2, 11, "cannot hold a space", "%20"),
    ('ex:s ex:p "a\\q" .', "TTL001", 2, 13, "unexpected escape character", "onto explain TTL001"),
]


def problem(tmp_path, text):
    path = tmp_path / "x.ttl"
    path.write_text(text, encoding="utf-8")
    return read_into(Store(), path)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case[0])
def test_a_syntax_error_points_at_the_slip(case, tmp_path):
    text, code, line, column, message, hint = case
    (found,) = problem(tmp_path, HEAD + text)
    assert (found.code, found.line, found.column) == (code, line, column)
    assert message in found.message
    assert hint in found.hint


@settings(max_examples=150, deadline=None)
@given(data=st.data())
def test_no_damage_to_a_file_breaks_the_report(data, tmp_path_factory):
    """Whatever is cut out of a shipped file, the result is a problem with a place or a file that still parses."""
    text = (ontology.ROOT / "rules" / "diagnosis.ttl").read_text(encoding="utf-8")
    start = data.draw(st.integers(0, len(text) - 1))
    length = data.draw(st.integers(1, 30))
    damaged = text[:start] + data.draw(st.sampled_from(["", '"', "[", "<", "."])) + text[start + length :]
    lines = damaged.count("\n") + 1
    for found in problem(tmp_path_factory.mktemp("damaged"), damaged):
        assert found.code.startswith("TTL")
        assert 1 <= found.line <= lines
        assert found.column >= 1
        assert "\n" not in found.message


def test_a_file_that_is_not_utf_8_says_which_byte(tmp_path):
    path = Path(tmp_path / "x.ttl")
    path.write_bytes(b"# caf\xe9\n")
    (found,) = read_into(Store(), path)
    assert (found.code, found.line, found.column) == ("TTL002", 1, 6)
    assert "0xE9" in found.message
