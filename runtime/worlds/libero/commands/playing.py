"""``onto play``: one episode by skills, replayed natively, printed, recorded and drawn."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import mujoco
import numpy as np
from rich.console import Console

from onto_compiler.bddl.impossible import refuse_impossible
from onto_compiler.command import CLEAN, FINDINGS, print_json
from onto_compiler.knowledge import Knowledge, load_knowledge
from onto_compiler.problems import OntoError
from onto_compiler.schema import Schema
from onto_compiler.wording import counted
from runtime.commands.opening import start_of
from runtime.commands.options import chosen_state, settled_words
from runtime.report.filmstrip import shots, write_film
from runtime.trace.names import file_name
from runtime.trace.narrate import narrate
from runtime.trace.store import TraceStore
from runtime.trace.summary import episode_summary
from runtime.wording import wrapped
from runtime.worlds.libero.demos.fixtures import fixtures_of
from runtime.worlds.libero.scene.horizons import horizon_of
from runtime.worlds.libero.simulator.assets import named_task
from runtime.worlds.libero.simulator.compiled import compile_scene
from runtime.worlds.libero.simulator.native import NativeTask
from runtime.worlds.libero.simulator.own_code import import_own
from runtime.worlds.libero.skills.episode import EpisodePlayer, EpisodeRecord
from runtime.worlds.libero.skills.offers import Carrying
from runtime.worlds.libero.skills.offset_grid import OffsetGrid
from runtime.worlds.libero.skills.play import Player
from runtime.worlds.libero.skills.replay import NativeReplay
from runtime.worlds.pictures import Camera
from runtime.worlds.required import required_of

__all__ = ["play"]


def play(options: argparse.Namespace) -> int:
    """Play, judge, print and record; exit code 1 if LIBERO did not accept."""
    with ExitStack() as stack:
        # Opened first, to report a folder that cannot be written before the episode is played.
        knowledge = load_knowledge(*options.ontology)
        store = stack.enter_context(_store(options, knowledge.schema)) if options.out is not None else None
        stage = stack.enter_context(_stage(options, knowledge))
        horizon = horizon_of(stage.ref.suite) if options.horizon is None else options.horizon
        start, state = start_of(chosen_state(options))
        with Console(stderr=True).status("playing"):
            performance = stage.perform(
                start, horizon, state=state, settle=options.settle, look_ahead=options.look_ahead
            )
        if store is not None:
            _record(options.out, store, performance)
    episode, schema = performance.episode, stage.knowledge.schema
    if options.format == "json":
        print_json(episode_summary(episode, schema))
    else:
        sys.stdout.write("\n".join(_story(performance, schema)) + "\n")
    if options.film is not None:  # last, so that a failure to draw loses no output
        sys.stdout.flush()
        _film(options.film, stage, performance)
    return CLEAN if episode.accepted else FINDINGS


@contextmanager
def _stage(options: argparse.Namespace, knowledge: Knowledge) -> Iterator[EpisodePlayer]:
    ref = named_task(options.task)
    import_own(options.imports, ref.bddl.parent)
    with Console(stderr=True).status(f"building the scene of {ref.name}"):
        required = required_of(ref, knowledge, ordered=True)
        refuse_impossible(required, knowledge.schema)
        scene = compile_scene(ref.bddl, options.seed or 0)
        if options.model is not None:
            scene = scene.placing(fixtures_of(options.model, scene.model))
        player = Player(scene, required, knowledge)
        if options.candidates == "offset-grid":
            grid = OffsetGrid(knowledge.schema)
            player.skills = {name: grid if isinstance(each, Carrying) else each for name, each in player.skills.items()}
        replay = NativeReplay(NativeTask.open(ref, scene.seed), required, knowledge.schema)
    with replay:
        yield EpisodePlayer(ref, required, knowledge, scene, player, replay, options.candidates.replace("-", "_"))


def _store(options: argparse.Namespace, schema: Schema) -> TraceStore:
    run = options.run or "play"
    return TraceStore(options.out / "store", schema, run, ontology=options.ontology, tags=options.tag)


def _record(out: Path, store: TraceStore, performance: EpisodeRecord) -> None:
    """Write the trace and, for a replay, the actions."""
    iri = store.add(performance.episode)
    store.export_trig(out / "trace.trig")
    path = out / "actions" / f"{file_name(iri)}.npz"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(path, actions=performance.actions, bounds=performance.bounds, qpos=performance.qpos)
    except OSError as error:
        hint = "name a folder that you may write, with space left"
        raise OntoError.of("TRC001", f"cannot write `{path}`: {error}", hint, str(path)) from error


def _film(path: Path, stage: EpisodePlayer, performance: EpisodeRecord) -> None:
    """Draw the filmstrip from the poses of the native run."""
    model = compile_scene(stage.ref.bddl, stage.scene.seed, pictures=True).model
    data = mujoco.MjData(model)
    shown = shots(performance.actions, performance.bounds)
    with Camera(model) as camera:

        def shoot(step: int) -> bytes:
            data.qpos[:] = performance.qpos[step]
            mujoco.mj_forward(model, data)
            return camera.shoot(data)

        write_film(path, performance.episode, stage.knowledge.schema, shown, shoot)


def _story(performance: EpisodeRecord, schema: Schema) -> Iterator[str]:
    """The episode in sentences, in lines of 80 columns where names allow."""
    episode = performance.episode
    yield from wrapped(narrate(episode, schema))
    settings = dict(episode.provenance)
    attempts = len(episode.attempts)
    yield (
        f"  {settings['control_steps']} of {settings['horizon']} control steps in "
        f"{counted(attempts, 'attempt')}, {settings['play']} play; {settings['rehearsed_steps']} rehearsed"
    )
    yield f"  The start was {settled_words(settings['start_settle_steps'])}."
