"""`onto train`: what is refused before anything is made, and what a card says of the command."""

import argparse
from functools import partial

import pytest

from grounding.world_model.model import FILES, load_world_model
from runtime.cli import main
from runtime.commands.train import _chosen
from runtime.worlds.pointmaze import training as pointmaze


@pytest.mark.parametrize(
    ("words", "code", "hint"),
    [
        (["libero", "frames"], "WM015", "projection, dynamics, events, facts"),
        (["libero", "--count", "0"], "CLI002", "at least 1"),
        (["pointmaze", "--count", "3"], "CLI002", "leave --demos and --count out"),
        (["pointmaze", "--demos", "out"], "CLI002", "leave --demos and --count out"),
        (["libero", "facts", "--demos", "nowhere"], "WM001", "there is no checkpoint here"),
        (["pointmaze", "events"], "WM001", "there is no checkpoint here"),
        (["pointmaze", "events", "--encoder", "pixels"], "CLI002", "leave --encoder out"),
        (["pointmaze", "--encoder", "pixel"], "WM007", "did you mean `pixels`?"),
        (["libero", "--encoder", "pixels:0"], "WM007", "pixels"),
        (["libero", "--encoder", "pixels:16:64"], "WM009", "(N, 64, 64, 3)"),
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
    def chosen(stage="facts", encoder=None, count=None, demos=None):
        return _chosen(argparse.Namespace(encoder=encoder, count=count, demos=demos), stage)

    assert chosen() == ""
    assert chosen(count=12) == " --count 12"
    assert chosen(count=12, demos="/somewhere/of/mine") == " --count 12 --demos DIR"
    assert chosen("projection", "pixels") == " --encoder pixels"
    assert chosen("dynamics", "pixels") == ""  # which reads what the projection does


@pytest.mark.sim
def test_every_stage_reads_what_the_chosen_encoder_sees(quick, tmp_path, monkeypatch, capsys):
    config = partial(
        pointmaze.MazeTrainingConfig, trajectories=12, steps=60, members=2, motion=4, appearance=4, estimate=4, heads=4
    )
    monkeypatch.setattr(pointmaze, "MazeTrainingConfig", config)
    out = ["--seed", "1", "--out", str(tmp_path)]
    assert main(["train", "pointmaze", "--encoder", "pixels:2", *out]) == 0
    model = load_world_model(tmp_path)
    assert model.encoder.name == "pixels:2:64>12"  # all of its features, which are fewer than 128
    facts = tmp_path / FILES["facts"]
    whole = facts.read_bytes()
    facts.unlink()
    assert main(["train", "pointmaze", "facts", *out]) == 0  # it need not be told of the encoder again
    assert facts.read_bytes() == whole
    assert "wrote" in capsys.readouterr().out
