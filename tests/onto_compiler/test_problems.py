"""A problem as it is printed: the line fits a terminal, and the caret stands under the character that is meant."""

import pytest

from onto_compiler.problems import OntoError, Problem, render


def shown(line, column):
    *_, source, caret = render(Problem("x.ttl", 1, column, "TTL001", "error", "m"), line).splitlines()
    return source, caret


def test_a_line_that_fits_is_shown_whole():
    line = "x" * 75
    assert shown(line, 75) == (f"   | {line}", f"   | {' ' * 74}^")


@pytest.mark.parametrize("length", [76, 200, 5_000_000])
@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.9, 1.0])
def test_a_longer_line_is_cut_around_the_caret(length, share):
    column = round(share * (length - 1)) + 1
    line = "x" * (column - 1) + "!" + "x" * (length - column)
    source, caret = shown(line, column)
    assert len(source) == 80
    assert source[len(caret) - 1] == "!"
    assert source.startswith("   | …") == (source[5:79] != line[:74])
    assert source.endswith("…") == (source[6:] != line[-74:])


def test_an_error_of_an_error_has_its_problems():
    inner = OntoError.of("SIM001", "no such entity", "did you mean `b`?")
    assert type(inner)(inner).problems == inner.problems
    assert str(OntoError(inner)) == str(inner)
