"""``onto lsp``: the language server on standard input and output."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from onto_compiler.command import CLEAN, Command, add_ontology

__all__ = ["LSP"]


def _configure(parser: argparse.ArgumentParser) -> None:
    add_ontology(parser)


def _run(options: argparse.Namespace) -> int:
    from onto_compiler.lsp.server import make_server  # noqa: PLC0415 - pygls is an extra, and heavy

    server = make_server(tuple(Path(path).resolve() for path in options.ontology))
    # The server closes what it reads and writes; standard output itself is still flushed at the end of a command.
    with os.fdopen(os.dup(0), "rb") as stdin, os.fdopen(os.dup(1), "wb") as stdout:
        server.start_io(stdin, stdout)
    return CLEAN


LSP = Command(
    name="lsp",
    help="Serve an editor (LSP): problems, quick fixes, renaming, completion and more in Turtle and BDDL.",
    example="onto lsp --ontology my_domain.ttl",
    configure=_configure,
    run=_run,
)
