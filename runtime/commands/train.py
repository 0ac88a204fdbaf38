"""``onto train``: the networks of a world model, stage by stage or all in a row."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from onto_compiler.command import CLEAN, Command, add_format, print_json
from onto_compiler.problems import OntoError
from onto_compiler.versions import git
from runtime.training import STAGES
from runtime.training.request import Stage, TrainingRequest, trained_worlds

__all__ = ["TRAIN"]


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("world", choices=tuple(trained_worlds()), help="the world to model")
    parser.add_argument(
        "stages",
        nargs="*",
        metavar="STAGE",
        default=STAGES,
        help=f"some of {', '.join(STAGES)}, in this order (default: all)",
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of data, initial weights and batches (default 0)")
    parser.add_argument("--encoder", metavar="NAME", help="what reads the pictures (default: lite0)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="default: out/models/WORLD/SEED")
    parser.add_argument("--threads", type=int, default=0, metavar="N", help="of torch (default: all)")
    parser.add_argument("--demos", type=Path, metavar="DIR", help="libero: folder of existing demonstrations")
    parser.add_argument("--count", type=int, metavar="N", help="libero: demonstrations a task (default 40)")
    add_format(parser)


def _run(options: argparse.Namespace) -> int:
    """Train; resumes an interrupted run."""
    from grounding.world_model.device import use_threads  # noqa: PLC0415 - torch takes a second to import

    unknown = [stage for stage in options.stages if stage not in STAGES]
    if unknown:
        raise OntoError.of("WM015", f"`{unknown[0]}` is not a training stage", f"stages: {', '.join(STAGES)}")
    if options.encoder is not None and "projection" not in options.stages:
        message = "the stage `projection` sets the encoder, and later stages use the same one"
        raise OntoError.of("CLI002", message, "leave --encoder out, or start with `projection`")
    if options.threads:
        use_threads(options.threads)
    folder = options.out or Path("out/models") / options.world / str(options.seed)
    commit = git(Path(__file__).parent, "rev-parse", "HEAD")
    asked = TrainingRequest(
        folder, options.seed, _encoder(options, folder), options.threads, options.demos, options.count
    )
    stage_of: Stage = trained_worlds()[options.world].load()(asked)
    metrics = {}
    for stage in options.stages:
        begun = time.perf_counter()
        command = f"onto train {options.world} {stage} --seed {options.seed}{_chosen(options, stage)}"
        found = stage_of(stage, command, commit, lambda text: _log(options, text))
        metrics[stage] = {**found, "seconds": round(time.perf_counter() - begun, 1)}
        if options.format == "text":
            values = "  ".join(f"{name} {value:.3g}" for name, value in metrics[stage].items())
            sys.stdout.write(f"{stage:<11}{values}\n")
    if options.format == "json":
        print_json(metrics)
    else:
        sys.stdout.write(f"wrote {folder}\n")
    return CLEAN


def _encoder(options: argparse.Namespace, folder: Path) -> str | None:
    """The encoder given with --encoder, or that of the projection that exists already."""
    from grounding.world_model.checkpoint import read_card  # noqa: PLC0415 - as above
    from grounding.world_model.model import FILES  # noqa: PLC0415

    there = "projection" not in options.stages
    name: str | None = read_card(folder / FILES["projection"]).data.get("encoder") if there else options.encoder
    return name


def _chosen(options: argparse.Namespace, stage: str) -> str:
    """The options that determine the data, for the card; without local paths."""
    chosen = ""
    if options.encoder is not None and stage == "projection":
        chosen += f" --encoder {options.encoder}"
    if options.count is not None:
        chosen += f" --count {options.count}"
    return f"{chosen} --demos DIR" if options.demos is not None else chosen


def _log(options: argparse.Namespace, text: str) -> None:
    if options.format == "text":
        sys.stderr.write(f"{text}\n")


TRAIN = Command(
    name="train",
    help="Train the networks of a world model; an interrupted training resumes.",
    example="onto train pointmaze --seed 0",
    configure=_configure,
    run=_run,
)
