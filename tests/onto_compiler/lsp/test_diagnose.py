"""Problems follow the text around them until they are found anew."""

from hypothesis import given
from hypothesis import strategies as st

from onto_compiler.lsp.diagnose import moved
from onto_compiler.problems import Problem

LINES = st.lists(st.text(alphabet="abc ", max_size=6), min_size=1, max_size=8)


def at(line):
    return Problem("f.ttl", line, 1, "DOC004", "error", "m")


@given(LINES, LINES, st.integers(1, 8))
def test_a_problem_stays_on_a_line_of_the_same_text_or_goes(before, after, line):
    kept = moved([at(line)], "\n".join(before), "\n".join(after))
    for problem in kept:
        if line <= len("\n".join(before).split("\n")):
            assert "\n".join(after).split("\n")[problem.line - 1] == "\n".join(before).split("\n")[line - 1]


def test_an_insertion_above_moves_it_down_and_a_change_of_its_line_removes_it():
    assert moved([at(2)], "a\nb\nc", "a\nx\ny\nb\nc") == (at(4),)
    assert moved([at(2)], "a\nb\nc", "a\nbb\nc") == ()
    assert moved([at(1), at(3)], "a\nb\nc", "a\nbb\nc") == (at(1), at(3))
