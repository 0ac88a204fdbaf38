"""``onto docs``: the reference of an ontology as one HTML file."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from onto_compiler.command import CLEAN, Command, add_ontology
from onto_compiler.problems import OntoError

__all__ = ["DOCS"]


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="the folder that gets index.html")
    add_ontology(parser)


def _run(options: argparse.Namespace) -> int:
    from onto_compiler.reference.page import reference_html  # noqa: PLC0415 - `onto --help` stays quick

    text = reference_html(options.ontology)
    target = options.out / "index.html"
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        hint = "name a folder that you may write to, with space left"
        raise OntoError.of(
            "SCH004", f"cannot write `{target}`: {error.strerror or error}", hint, str(target)
        ) from error
    sys.stdout.write(f"{target}\n")
    return CLEAN


DOCS = Command(
    name="docs",
    help="Write an HTML reference of the ontology: predicates, failures, routes, rules, bindings and questions.",
    example="onto docs --ontology my_domain.ttl --out site",
    configure=_configure,
    run=_run,
)
