"""`onto train`: what is refused before anything is made, and what a card says of the command."""

import argparse

import pytest

from runtime.cli import main
from runtime.training.command import _chosen


@pytest.mark.parametrize(
    ("words", "code", "hint"),
    [
        (["libero", "frames"], "WM015", "projection, dynamics, events, facts"),
        (["libero", "--count", "0"], "CLI002", "at least 1"),
        (["pointmaze", "--count", "3"], "CLI002", "leave --demos and --count out"),
        (["pointmaze", "--demos", "out"], "CLI002", "leave --demos and --count out"),
        (["libero", "facts", "--demos", "nowhere"], "WM001", "there is no checkpoint here"),
    ],
)
def test_a_mistake_is_told_before_anything_is_made(capsys, tmp_path, monkeypatch, words, code, hint):
    monkeypatch.chdir(tmp_path)
    assert main(["train", *words]) > 1
    told = capsys.readouterr()
    assert told.out == ""
    assert f"error[{code}]" in told.err
    assert hint in told.err
    assert list(tmp_path.iterdir()) == []


def test_a_card_names_what_was_chosen_and_no_path():
    def chosen(count=None, demos=None):
        return _chosen(argparse.Namespace(count=count, demos=demos))

    assert chosen() == ""
    assert chosen(12) == " --count 12"
    assert chosen(12, "/somewhere/of/mine") == " --count 12 --demos DIR"
