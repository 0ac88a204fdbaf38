"""``onto diff``: what changed between two versions of an ontology, and whether the version says so."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator
from dataclasses import asdict
from typing import TYPE_CHECKING

from onto_compiler.command import CLEAN, FINDINGS, Command, add_format, print_json
from onto_compiler.wording import counted

if TYPE_CHECKING:  # `onto --help` reads this module, and stays without Oxigraph
    from onto_compiler.diff.compare import Change, Comparison, Release

__all__ = ["DIFF"]

_PLAIN = re.compile(r'"([^"]*)"\^\^xsd:(?:boolean|decimal|double|integer)\b')
_LONG = 60  # characters of a value that a line shows


def _configure(parser: argparse.ArgumentParser) -> None:
    forms = "a Turtle file, a folder of them, or REVISION:PATH of git"
    parser.add_argument("old", metavar="OLD", help=f"the earlier version: {forms}")
    parser.add_argument("new", metavar="NEW", help="the later version, as OLD")
    add_format(parser, "markdown")


def _run(options: argparse.Namespace) -> int:
    from onto_compiler.diff.compare import compare  # noqa: PLC0415 - `onto --help` stays quick
    from onto_compiler.diff.sides import read_side  # noqa: PLC0415

    found = compare(read_side(options.old), read_side(options.new))
    if options.format == "json":
        print_json({
            "ok": found.ok,
            "changes": [asdict(change) for change in found.changes],
            "releases": [asdict(release) for release in found.releases],
        })  # fmt: skip
    else:
        lines = _markdown(found) if options.format == "markdown" else _text(found)
        sys.stdout.write("".join(f"{line}\n" for line in lines))
    return CLEAN if found.ok else FINDINGS


def _text(found: Comparison) -> Iterator[str]:
    if not found.changes:
        yield "no term changed"
    for release in found.releases:
        yield _heading(release)
        own = [change for change in found.changes if change.ontology == release.ontology]
        for change in sorted(own, key=lambda change: not change.breaking):
            yield f"  {'breaking: ' if change.breaking else ''}{_sentence(change, '')}"
        if not release.enough:
            yield f"  the version must be raised: {counted(release.breaking, 'breaking change')}"


def _markdown(found: Comparison) -> Iterator[str]:
    for number, release in enumerate(found.releases):
        yield from [""] * bool(number)
        yield f"## {_heading(release)}"
        own = [change for change in found.changes if change.ontology == release.ontology]
        for title, chosen in (
            ("Breaking", [change for change in own if change.breaking]),
            ("Other", [change for change in own if not change.breaking]),
        ):
            if chosen:
                yield from ("", f"### {title}", "")
                yield from (f"- {_sentence(change, '`')}" for change in chosen)
        if not release.enough:
            yield from ("", f"**The version must be raised from {release.old or 'none'}.**")


def _heading(release: Release) -> str:
    version = f"{release.old or 'none'} -> {release.new or 'none'}" if release.old != release.new else release.old
    return f"{release.ontology or 'no ontology'}, version {version or 'none'}"


def _sentence(change: Change, tick: str) -> str:
    from onto_compiler.rdf import shorten  # noqa: PLC0415 - as above

    term = f"{tick}{shorten(change.term)}{tick}"
    if change.change in {"added", "removed"}:
        return f"{change.change} {change.kind} {term}"
    if change.change == "deprecated":
        return f"deprecated {change.kind} {term}"
    values = " -> ".join(_values(side, tick) for side in (change.old, change.new))
    return f"changed {change.facet} of {change.kind} {term}: {tick}{shorten(change.property)}{tick} {values}"


def _values(values: tuple[str, ...], tick: str) -> str:
    plain = (_PLAIN.sub(r"\1", value) for value in values)
    shown = (value if len(value) <= _LONG else f"{value[: _LONG - 3]}..." for value in plain)
    return ", ".join(f"{tick}{value}{tick}" for value in shown) or "none"


DIFF = Command(
    name="diff",
    help="Compare two versions of an ontology: what was added, removed or changed, and whether it breaks users.",
    example="onto diff v0.1.0:ontology ontology",
    configure=_configure,
    run=_run,
)
