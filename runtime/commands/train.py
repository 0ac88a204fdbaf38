"""``onto train``: the networks of a world model, stage by stage or all in a row."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from onto_compiler.command import CLEAN, Command, add_format, print_json
from onto_compiler.problems import OntoError
from onto_compiler.versions import git
from runtime.training import STAGES

__all__ = ["TRAIN"]

WORLDS = ("pointmaze", "libero")
Log = Callable[[str], None]
Stage = Callable[[str, str, str, Log], Mapping[str, float]]
"""Stage, command, commit and what says how far it is, to the metrics of the stage's card."""


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("world", choices=WORLDS, help="what the model is of")
    parser.add_argument(
        "stages",
        nargs="*",
        metavar="STAGE",
        default=STAGES,
        help=f"some of {', '.join(STAGES)}, in this order (default: all)",
    )
    parser.add_argument("--seed", type=int, default=0, help="decides data, beginnings and batches (default 0)")
    parser.add_argument("--encoder", metavar="NAME", help="what reads the pictures (default: lite0)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="default: out/models/WORLD/SEED")
    parser.add_argument("--threads", type=int, default=0, metavar="N", help="of torch (default: all)")
    parser.add_argument("--demos", type=Path, metavar="DIR", help="libero: demonstrations that are there already")
    parser.add_argument("--count", type=int, metavar="N", help="libero: demonstrations a task (default 40)")
    add_format(parser)


def _run(options: argparse.Namespace) -> int:
    """Train; goes on where an earlier run stopped."""
    import torch  # noqa: PLC0415 - it takes a second to import

    unknown = [stage for stage in options.stages if stage not in STAGES]
    if unknown:
        raise OntoError.of("WM015", f"`{unknown[0]}` is no stage of a training", f"stages: {', '.join(STAGES)}")
    if options.world != "libero" and (options.demos is not None or options.count is not None):
        raise OntoError.of(
            "CLI002", f"`{options.world}` has no demonstrations to choose", "leave --demos and --count out"
        )
    if options.encoder is not None and "projection" not in options.stages:
        message = "an encoder is chosen where the projection is made, and later stages read what that one reads"
        raise OntoError.of("CLI002", message, "leave --encoder out, or begin with `projection`")
    if options.threads:
        torch.set_num_threads(options.threads)
    folder = options.out or Path("out/models") / options.world / str(options.seed)
    commit = git(Path(__file__).parent, "rev-parse", "HEAD")
    stage_of = _pointmaze(options, folder) if options.world == "pointmaze" else _libero(options, folder)
    metrics = {}
    for stage in options.stages:
        begun = time.perf_counter()
        command = f"onto train {options.world} {stage} --seed {options.seed}{_chosen(options, stage)}"
        found = stage_of(stage, command, commit, lambda text: _say(options, text))
        metrics[stage] = {**found, "seconds": round(time.perf_counter() - begun, 1)}
        if options.format == "text":
            told = "  ".join(f"{name} {value:.3g}" for name, value in metrics[stage].items())
            sys.stdout.write(f"{stage:<11}{told}\n")
    if options.format == "json":
        print_json(metrics)
    else:
        sys.stdout.write(f"wrote {folder}\n")
    return CLEAN


def _pointmaze(options: argparse.Namespace, folder: Path) -> Stage:
    from runtime.training.stages import TrainingDir  # noqa: PLC0415
    from runtime.worlds.pointmaze.training import MazeTrainingConfig, train  # noqa: PLC0415 - as above

    config = MazeTrainingConfig(seed=options.seed, **_given(encoder=_encoder(options, folder)))
    place = TrainingDir(folder)
    return lambda stage, command, commit, log: train(stage, config, place, command, commit, log)


def _libero(options: argparse.Namespace, folder: Path) -> Stage:
    from onto_compiler.batch import available_jobs  # noqa: PLC0415 - as above
    from runtime.worlds.libero.training.config import SceneTrainingConfig  # noqa: PLC0415
    from runtime.worlds.libero.training.train import FilmPlace, train  # noqa: PLC0415

    if options.count is not None and options.count < 1:
        raise OntoError.of("CLI002", f"--count must be at least 1, and is {options.count}")
    given = _given(encoder=_encoder(options, folder), demos=options.count)
    config = SceneTrainingConfig(seed=options.seed, **given)
    place = FilmPlace(folder, folder.parent / "data", options.demos, options.threads or available_jobs())
    return lambda stage, command, commit, log: train(stage, config, place, command, commit, log)


def _encoder(options: argparse.Namespace, folder: Path) -> str | None:
    """What is asked for; where the projection is there already, what that was made for."""
    from grounding.world_model.checkpoint import read_card  # noqa: PLC0415 - as above
    from grounding.world_model.model import FILES  # noqa: PLC0415

    there = "projection" not in options.stages
    name: str | None = read_card(folder / FILES["projection"]).data.get("encoder") if there else options.encoder
    return name


def _given(**options: Any) -> dict[str, Any]:  # noqa: ANN401 - of any type
    """Those that are not None, so that defaults stay with what has them."""
    return {name: value for name, value in options.items() if value is not None}


def _chosen(options: argparse.Namespace, stage: str) -> str:
    """What of the command decides the data, for the card, without a path of this machine."""
    chosen = ""
    if options.encoder is not None and stage == "projection":
        chosen += f" --encoder {options.encoder}"
    if options.count is not None:
        chosen += f" --count {options.count}"
    return f"{chosen} --demos DIR" if options.demos is not None else chosen


def _say(options: argparse.Namespace, text: str) -> None:
    if options.format == "text":
        sys.stderr.write(f"{text}\n")


TRAIN = Command(
    name="train",
    help="Train the networks of a world model; an interrupted training goes on.",
    example="onto train pointmaze --seed 0",
    configure=_configure,
    run=_run,
)
