"""A world model whole: encoder, dynamics, event head and fact head, as a folder of checkpoints that belong together."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from grounding.world_model import dynamics, events, facts
from grounding.world_model.checkpoint import Checkpoint, restore
from grounding.world_model.dynamics import Dynamics
from grounding.world_model.encoder import require_encoder
from grounding.world_model.events import EventHead
from grounding.world_model.facts import FactHead
from grounding.world_model.projection import Projected, load_projected
from grounding.world_model.scene import SCENE_EVENTS, SCENE_FACTS, SceneEventHead, SceneFactHead
from onto_compiler.problems import OntoError

__all__ = ["FILES", "SceneModel", "WorldModel", "load_dynamics", "load_scene_model", "load_world_model"]

FILES = {name: f"{name}.safetensors" for name in ("projection", "dynamics", "events", "facts")}
"""What a folder holds."""


@dataclass(frozen=True, slots=True, eq=False)
class WorldModel:
    """``encoder`` reads pictures, ``dynamics`` predicts states, the heads predict facts and events of these."""

    encoder: Projected
    dynamics: Dynamics
    events: EventHead
    facts: FactHead


@dataclass(frozen=True, slots=True, eq=False)
class SceneModel:
    """As :class:`WorldModel`, with heads whose goals are facts of one scene and not pictures."""

    encoder: Projected
    dynamics: Dynamics
    events: SceneEventHead
    facts: SceneFactHead


def load_world_model(folder: Path, device: str = "cpu") -> WorldModel:
    """The world model in ``folder``, frozen.

    Raises:
        OntoError: as :func:`grounding.world_model.checkpoint.restore` and
            :func:`grounding.world_model.projection.load_projected`; ``WM014`` if a head was trained on other
            dynamics, or dynamics on other features.
    """
    encoder, network, found = load_dynamics(folder, device)
    event_head, event_file = restore(folder / FILES["events"], events.ARCHITECTURE, EventHead, device)
    fact_head, fact_file = restore(folder / FILES["facts"], facts.ARCHITECTURE, FactHead, device)
    for file in (event_file, fact_file):
        _require(file, "dynamics", found.identity)
    return WorldModel(encoder, network, event_head, fact_head)


def load_scene_model(folder: Path, device: str = "cpu") -> SceneModel:
    """The world model of a scene in ``folder``, frozen; raises as :func:`load_world_model`."""
    encoder, network, found = load_dynamics(folder, device)
    event_head, event_file = restore(folder / FILES["events"], SCENE_EVENTS, SceneEventHead, device)
    fact_head, fact_file = restore(folder / FILES["facts"], SCENE_FACTS, SceneFactHead, device)
    for file in (event_file, fact_file):
        _require(file, "dynamics", found.identity)
    return SceneModel(encoder, network, event_head, fact_head)


def load_dynamics(folder: Path, device: str = "cpu") -> tuple[Projected, Dynamics, Checkpoint]:
    """The encoder and the dynamics in ``folder``, which is all that its heads are trained on; raises as above."""
    encoder = load_projected(folder / FILES["projection"], device)
    network, found = restore(folder / FILES["dynamics"], dynamics.ARCHITECTURE, Dynamics, device)
    require_encoder(encoder, found.card.encoder, found.path)
    return encoder, network, found


def _require(file: Checkpoint, what: str, identity: str) -> None:
    trained_on = str(file.card.data.get(what, ""))
    if trained_on != identity:
        message = f"the head was trained on {what} {trained_on[:12] or 'unknown'}, and {identity[:12]} lie beside it"
        raise OntoError.of("WM014", message, "take the files of one training run", str(file.path))
