"""The stages of the training, on films of a small world, with few steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from grounding.world_model.checkpoint import read_card
from grounding.world_model.model import FILES, load_scene_model
from onto_compiler.problems import OntoError
from runtime.training import STAGES, motion
from runtime.worlds.libero.training import heads
from runtime.worlds.libero.training import train as training
from runtime.worlds.libero.training.config import SceneTrainingConfig
from runtime.worlds.libero.training.heads import WindowSampler, calibrate
from runtime.worlds.libero.training.measure import predict_facts
from runtime.worlds.libero.training.scene import SceneFacts
from runtime.worlds.libero.training.train import FilmPlace, load_windows, train
from tests.gpu import DEVICE, Gpu
from tests.interruption import interrupted
from tests.runtime.worlds.libero.training.test_windows import FACTS

COURSE = SceneTrainingConfig(
    encoder="pixels:16:128", components=8, members=2, motion=80, appearance=60, estimate=5, facts=80, events=20
)
ASKED = SceneFacts(FACTS, {0: (0,)}, {0: (0,)})


def quiet(_text: str) -> None:
    pass


@pytest.fixture(scope="module")
def world(films):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(training, "filmed", lambda _shoot, _jobs, _say: films)
        patch.setattr(training, "_suite_facts", lambda: ASKED)
        patch.setattr(motion, "_BATCH", 64)
        patch.setattr(motion, "_SEGMENTS", 16)
        patch.setattr(heads, "_WINDOWS", 16)
        yield films


@pytest.fixture(scope="module")
def trained(world, tmp_path_factory):
    place = FilmPlace(tmp_path_factory.mktemp("model"), tmp_path_factory.mktemp("data"))
    metrics = {stage: train(stage, COURSE, place, f"onto train libero {stage}", "", quiet) for stage in STAGES}
    return place, metrics


def test_each_stage_leaves_a_card_with_what_it_saw_and_its_figures(trained):
    place, metrics = trained
    cards = {name: read_card(place.folder / file) for name, file in FILES.items()}
    assert {name: dict(card.metrics) for name, card in cards.items()} == metrics
    assert cards["facts"].facts == ("placed(thing)", "lost(thing)")
    assert cards["dynamics"].sees == "pixels, proprioception"
    assert cards["facts"].sees == cards["events"].sees == "pixels, proprioception; labels of privileged-state"
    assert metrics["dynamics"]["feature_error"] < metrics["dynamics"]["feature_error_if_still"]
    assert all((place.folder / file).stat().st_size < 10_000_000 for file in FILES.values())


def test_the_model_tells_where_the_thing_will_be_on_films_that_were_held_out(trained):
    place, _ = trained
    model = load_scene_model(place.folder)
    data = load_windows(COURSE, place, "held", model.encoder, quiet)
    told, seen = predict_facts(model.dynamics, model.facts, FACTS, data)
    truth = data.truth[:, -1, 0]
    assert 0 < truth.sum() < len(truth)
    for each in (told, seen):
        assert np.mean((each.score[:, 0] > 0.5) == truth) > 0.85
        assert np.abs(each.margin[:, 0] - data.margin[:, -1, 0]).mean() < 0.1
        assert each.score[:, 1].max() < 0.3


def test_temperatures_make_the_held_out_truth_likelier(trained):
    place, _ = trained
    model = load_scene_model(place.folder)
    held = load_windows(COURSE, place, "held", model.encoder, quiet)
    ends = WindowSampler(model.dynamics, held).ends(np.arange(len(held)))
    head = model.facts

    def entropy() -> float:
        _, logit = head(*ends.read)
        return float(torch.nn.functional.binary_cross_entropy_with_logits(logit[:, 0], ends.truth[:, 0].float()))

    fitted = entropy()
    before = head.temperature.clone()
    head.temperature.fill_(5.0)
    worse = entropy()
    calibrate(head, ends)
    assert entropy() == pytest.approx(fitted, abs=1e-6)
    assert worse > fitted
    assert torch.allclose(head.temperature, before)


def test_an_interrupted_stage_ends_as_one_that_was_not(trained, tmp_path):
    place, _ = trained
    for name in ("projection", "dynamics"):
        (tmp_path / FILES[name]).write_bytes((place.folder / FILES[name]).read_bytes())
    other = FilmPlace(tmp_path, place.data)
    with interrupted(saves=12):
        train("facts", COURSE, other, "onto train libero facts", "", quiet)
    train("facts", COURSE, other, "onto train libero facts", "", quiet)
    assert (tmp_path / FILES["facts"]).read_bytes() == (place.folder / FILES["facts"]).read_bytes()


def test_every_stage_trains_on_the_device_as_it_does_on_the_cpu(world, tmp_path):
    short = replace(COURSE, motion=5, appearance=5, estimate=5, facts=5, events=5)
    found = []
    with Gpu() as gpu:
        for device in ("cpu", DEVICE):
            place = FilmPlace(tmp_path / device, tmp_path, device=device)
            found.append({stage: train(stage, short, place, "", "", quiet) for stage in STAGES})
    assert gpu.operations > 1000
    for stage in STAGES:
        assert found[1][stage] == pytest.approx(found[0][stage], rel=1e-3, abs=1e-4, nan_ok=True)


def test_a_head_without_its_dynamics_is_not_trained(world, tmp_path):
    with pytest.raises(OntoError) as caught:
        train("facts", COURSE, FilmPlace(tmp_path, tmp_path), "", "", quiet)
    assert caught.value.problems[0].code == "WM001"


def test_heads_of_other_dynamics_are_refused(trained, tmp_path):
    place, _ = trained
    for name in FILES:
        (tmp_path / FILES[name]).write_bytes((place.folder / FILES[name]).read_bytes())
    short = replace(COURSE, motion=5, appearance=5, estimate=5)
    train("dynamics", short, FilmPlace(tmp_path, place.data), "", "", quiet)
    with pytest.raises(OntoError) as caught:
        load_scene_model(tmp_path)
    assert caught.value.problems[0].code == "WM014"


def test_a_file_of_another_architecture_and_one_that_was_cut_off_are_told(trained, tmp_path):
    place, _ = trained
    for name in FILES:
        (tmp_path / FILES[name]).write_bytes((place.folder / FILES[name]).read_bytes())
    whole = (tmp_path / FILES["facts"]).read_bytes()
    for content, code in (((tmp_path / FILES["events"]).read_bytes(), "WM003"), (whole[:-100], "WM002")):
        (tmp_path / FILES["facts"]).write_bytes(content)
        with pytest.raises(OntoError) as caught:
            load_scene_model(tmp_path)
        assert caught.value.problems[0].code == code


def test_a_split_without_demonstrations_is_told(world, tmp_path, monkeypatch):
    monkeypatch.setattr(training, "filmed", lambda _shoot, _jobs, _say: world[:1])
    with pytest.raises(OntoError) as caught:
        training._of_split(COURSE, FilmPlace(tmp_path, tmp_path), "train", quiet)
    assert caught.value.problems[0].code == "WM016"


def test_a_task_with_another_fact_is_refused_before_anything_is_imagined(trained):
    place, _ = trained
    model = load_scene_model(place.folder)
    data = load_windows(COURSE, place, "held", model.encoder, quiet)
    strange = replace(FACTS[0], predicate="x#opened")
    with pytest.raises(OntoError) as caught:
        predict_facts(model.dynamics, model.facts, (FACTS[0], strange), data)
    assert [problem.code for problem in caught.value.problems] == ["WM013"]
    negated = replace(FACTS[1], polarity=False)
    told, _ = predict_facts(model.dynamics, model.facts, (negated,), data)
    assert told.score.shape == (len(data), 1)
