"""Tokens of ASCII text are found with a smaller pattern, which must find what the whole one does."""

from hypothesis import example, given, settings
from hypothesis import strategies as st

from onto_compiler.turtle import tokens as module
from onto_compiler.turtle.tokens import tokens

PIECES = st.sampled_from(
    (
        "ex:a.b",
        "ex:%41",
        ":",
        "_:b1.",
        "<urn:x>",
        '"a\\"b"',
        "'''x'",
        '"open\n',
        "@en-GB",
        "^^",
        "?this",
        "-1.5e3",
        ".5",
        "# remark\n",
        "SELECT",
        "a.",
        ".",
        " ",
        "\t",
        "{",
        "ex:a\\-b",
        "\\",
        "é",
        "·",
    )
)


@settings(deadline=None)
@given(st.lists(st.one_of(PIECES, st.text(st.characters(max_codepoint=127), max_size=4)), max_size=12).map("".join))
@example('ex:a.b. ?x "y" # z')
def test_a_letter_behind_a_remark_changes_no_token_of_ascii_text(text):
    whole = [token for token in tokens(f"{text}\n# ·") if token.start < len(text)]
    assert whole == list(tokens(text))


def test_only_other_letters_need_the_whole_pattern():
    module._token.cache_clear()
    assert [token.kind for token in tokens("ex:a a ex:b .")] == ["name", "word", "name", "mark"]
    assert module._token.cache_info().currsize == 1
    assert [token.text for token in tokens("ex:a\u00b7b .")] == ["ex:a\u00b7b", "."]
    assert module._token.cache_info().currsize == 2
