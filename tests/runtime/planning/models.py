"""A world model of the maze whose networks are tiny and random: it runs as a trained one does, and knows nothing."""

from __future__ import annotations

import torch

from grounding.world_model import dynamics, events, facts
from grounding.world_model.checkpoint import Card, load, save
from grounding.world_model.dynamics import Dynamics
from grounding.world_model.encoder import encoder
from grounding.world_model.events import EventHead
from grounding.world_model.facts import FactHead
from grounding.world_model.model import FILES
from grounding.world_model.projection import Projected, fit, save_projection
from runtime.worlds.pointmaze.maze import maze_named
from runtime.worlds.pointmaze.picture import draw
from runtime.worlds.pointmaze.trials import trial

NAMES = ["at_target", "velocity_matches", "free_of"]
CENTRE, SCALE = [1.8, 1.8, 0.0, 0.0], [2.5, 2.5, 5.0, 5.0]


def write_model(folder, names=tuple(NAMES)):
    """Write the four files of a world model whose weights mean nothing; return the folder."""
    torch.manual_seed(0)
    import numpy as np

    base = encoder("pixels:4:64")
    pictures = draw(maze_named("u_maze"), np.stack([trial(k).start for k in range(40)]), base.size)
    small = Projected(base, fit(base.encode(pictures), 4))
    save_projection(folder / FILES["projection"], small, Card("", seed=0))
    motion = {"centre": CENTRE, "scale": SCALE, "bound": [9.0] * 4, "actions": 2, "members": 2, "width": 16}
    parameters = {"motion": motion, "features": 4, "feature_scale": 1.0, "width": 16}
    network = Dynamics(**parameters)
    for weight in network.parameters():
        torch.nn.init.normal_(weight, std=0.1)
    path = folder / FILES["dynamics"]
    save(path, network.state_dict(), Card(dynamics.ARCHITECTURE, parameters, encoder=small.identity, seed=0))
    known = {"dynamics": load(path, dynamics.ARCHITECTURE).identity}
    head = {"centre": CENTRE, "scale": SCALE, "features": 4, "feature_scale": 1.0}
    save(
        folder / FILES["events"],
        EventHead(**head).state_dict(),
        Card(events.ARCHITECTURE, head, encoder=small.identity, data=known, seed=0),
    )
    spoken = {"facts": list(names), **head}
    save(
        folder / FILES["facts"],
        FactHead(**spoken).state_dict(),
        Card(facts.ARCHITECTURE, spoken, encoder=small.identity, facts=tuple(names), data=known, seed=0),
    )
    return folder
