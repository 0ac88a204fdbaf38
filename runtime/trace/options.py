"""Arguments of commands that record episodes; light, as the help of every command imports it."""

from __future__ import annotations

import argparse

__all__ = ["add_identity"]


def add_identity(parser: argparse.ArgumentParser) -> None:
    """``--run`` and ``--tag``, which identify recorded episodes besides task, state and seed."""
    parser.add_argument("--run", metavar="NAME", help="the run that the episodes are recorded under")
    parser.add_argument(
        "--tag",
        type=_tag,
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="what else tells the recorded episodes from others; may be given several times",
    )


def _tag(text: str) -> tuple[str, str]:
    key, equals, value = text.partition("=")
    if not (key and equals):
        raise argparse.ArgumentTypeError(f"`{text}` is not KEY=VALUE, as in --tag light=dim")
    return key, value
