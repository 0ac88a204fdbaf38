"""``onto play``: skills act under dynamics from one initial state, and LIBERO judges the episode."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

from onto_compiler.command import Command, add_format, add_ontology
from runtime.commands.options import add_state, add_task, control_steps
from runtime.trace.options import add_identity

__all__ = ["PLAY"]

_FILMS = (".html", ".jpg", ".png")


def _configure(parser: argparse.ArgumentParser) -> None:
    add_task(parser)
    add_state(parser)
    add_identity(parser)
    parser.add_argument("--look-ahead", action="store_true", help="rehearse each decision in a fork of the simulation")
    parser.add_argument(
        "--horizon",
        type=partial(control_steps, least=1),
        metavar="N",
        help="control steps that it may take (default: the suite's)",
    )
    parser.add_argument(
        "--candidates",
        choices=("geometry", "offset-grid"),
        default="geometry",
        help="where an object is put down: where the scene's geometry says that the fact will hold (default), or at a "
        "finite grid of offsets beside the landmark, as the paper tells of LIBERO-90 Task 76",
    )
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="also record the episode in DIR/store, DIR/trace.trig and DIR/actions"
    )
    parser.add_argument(
        "--film",
        type=_film,
        metavar="FILE",
        help="also draw each attempt before, at grasp and release, and after, as .html, .jpg or .png",
    )
    add_ontology(parser)
    add_format(parser)


def _film(text: str) -> Path:
    path = Path(text)
    if path.suffix.lower() not in _FILMS:
        raise argparse.ArgumentTypeError(f"`{text}` ends in none of {', '.join(_FILMS)}")
    return path


def _run(options: argparse.Namespace) -> int:
    from runtime.worlds.pictures import cannot_render, enable  # noqa: PLC0415 - heavy imports wait for the command to run

    if options.film is not None and not enable():  # before MuJoCo is imported, which then chooses how it renders
        raise cannot_render()
    from runtime.worlds.libero.commands.playing import play  # noqa: PLC0415 - as above

    return play(options)


PLAY = Command(
    name="play",
    help="Play one task by skills under dynamics, judged by LIBERO, and print each attempt.",
    example="onto play libero_90/76 --candidates offset-grid --film out/mug.html",
    configure=_configure,
    run=_run,
)
