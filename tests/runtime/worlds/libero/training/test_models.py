"""The world model of LIBERO-Goal that ships: it is whole, it is small, and its cards say what it is."""

import pytest

from grounding.world_model.checkpoint import read_card
from grounding.world_model.model import FILES, load_scene_model
from runtime.worlds.libero.training.config import SceneTrainingConfig
from runtime.worlds.libero.training.models import shipped


def test_its_files_belong_together_and_are_small():
    model = load_scene_model(shipped())
    assert model.encoder.encoder.name == SceneTrainingConfig().encoder
    assert all((shipped() / file).stat().st_size < 10_000_000 for file in FILES.values())


def test_its_cards_tell_the_command_the_data_and_what_was_seen():
    for stage, file in FILES.items():
        card = read_card(shipped() / file)
        assert card.command == f"onto train libero {stage} --seed 0"
        assert len(card.commit) == 40
        assert card.data["demos"] == SceneTrainingConfig().demos
        assert card.metrics
        assert ("privileged-state" in card.sees) == (stage in {"events", "facts"})


@pytest.mark.sim
def test_it_knows_what_the_ten_tasks_require():
    from onto_compiler.knowledge import load_knowledge
    from runtime.worlds.libero.training.scene import scene_facts

    model, asked = load_scene_model(shipped()), scene_facts(load_knowledge())
    assert model.facts.facts == asked.names
