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

_WIDTH = 80  # columns of a terminal
_LONG = 120  # characters of values that stand in a sentence of Markdown


def _configure(parser: argparse.ArgumentParser) -> None:
    forms = "a Turtle file, a folder of them, or REVISION:PATH of git"
    parser.add_argument("old", metavar="OLD", help=f"the earlier version: {forms}")
    parser.add_argument("new", metavar="NEW", help="the later version, as OLD")
    add_format(parser, "markdown")


def _run(options: argparse.Namespace) -> int:
    from onto_compiler.diff.compare import compare  # noqa: PLC0415 - `onto --help` stays quick
    from onto_compiler.diff.sides import read_side  # noqa: PLC0415
    from onto_compiler.terms import prefixes_of  # noqa: PLC0415

    found = compare(read_side(options.old), read_side(options.new))
    if options.format == "json":
        print_json({
            "ok": found.ok,
            "changes": [asdict(change) for change in found.changes],
            "releases": [asdict(release) for release in found.releases],
            "prefixes": dict(prefixes_of(found.prefixes)),
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
            sentence = f"{'breaking: ' if change.breaking else ''}{_sentence(change, '', found)}"
            line = f"  {sentence}{_inline(change, '')}"
            if len(line) <= _WIDTH and "\n" not in line:
                yield line
                continue
            yield from _wrapped(sentence, "  ", "      ")
            for each in _differing(change):
                yield from _wrapped(each, "    ", "      ")
        if not release.enough:
            yield f"  the version must be raised: {counted(release.breaking, 'breaking change')}"


def _wrapped(line: str, first: str, rest: str) -> list[str]:
    """A line of text in the columns of a terminal; a word is never broken."""
    from textwrap import TextWrapper  # noqa: PLC0415 - `onto --help` stays quick

    if len(first + line) <= _WIDTH:
        return [first + line]
    whole = TextWrapper(_WIDTH, first, rest, break_long_words=False, break_on_hyphens=False)
    return whole.wrap(line)


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
                for change in chosen:
                    yield from _item(change, found)
        if not release.enough:
            yield from ("", f"**The version must be raised from {release.old or 'none'}.**")


def _item(change: Change, found: Comparison) -> Iterator[str]:
    sentence, inline = _sentence(change, "`", found), _inline(change, "`")
    ticks = max((len(run) for value in (*change.was, *change.now) for run in re.findall("`+", value)), default=0)
    if "\n" not in inline and len(inline) <= _LONG and not ticks:
        yield f"- {sentence}{inline}"
        return
    fence = "`" * max(3, ticks + 1)
    yield from (f"- {sentence}", "", f"  {fence}diff")
    yield from (f"  {line}" for line in _differing(change))
    yield from (f"  {fence}", "")


def _heading(release: Release) -> str:
    version = f"{release.old or 'none'} -> {release.new or 'none'}" if release.old != release.new else release.old
    return f"{release.ontology or 'no ontology'}, version {version or 'none'}"


def _sentence(change: Change, tick: str, found: Comparison) -> str:
    """What changed, without the values."""
    from onto_compiler.rdf import node  # noqa: PLC0415 - as above
    from onto_compiler.terms import show  # noqa: PLC0415

    def named(iri: str) -> str:
        shown = show(node(iri), found.prefixes)
        return f"{tick}{shown.strip('<>') if tick == '' else shown}{tick}"

    if not change.term:
        return f"{change.change} {change.kind} without a name:"
    term = named(change.term)
    if change.change in {"added", "removed", "deprecated"}:
        return f"{change.change} {change.kind} {term}"
    return f"changed {change.facet} of {change.kind} {term}: {named(change.property)}"


def _inline(change: Change, tick: str) -> str:
    """The values behind the sentence."""
    if not change.term:
        return " " + ", ".join(f"{tick}{value}{tick}" for value in (*change.was, *change.now))
    if change.change != "changed":
        return ""
    was, now = (", ".join(f"{tick}{value}{tick}" for value in side) or "none" for side in (change.was, change.now))
    return f" {was} -> {now}"


def _differing(change: Change) -> Iterator[str]:
    """What was, each line behind a minus, and what is, behind a plus; of one text that became another, what differs."""
    from difflib import unified_diff  # noqa: PLC0415 - as above

    if len(change.was) == len(change.now) == 1 and "\n" in change.was[0] + change.now[0]:
        lines = unified_diff(change.was[0].split("\n"), change.now[0].split("\n"), n=1, lineterm="")
        yield from ("..." if line.startswith("@@") else line for line in list(lines)[2:])
        return
    for sign, values in (("- ", change.was), ("+ ", change.now)):
        yield from (sign + line for value in values for line in value.split("\n"))


DIFF = Command(
    name="diff",
    help="Compare two versions of an ontology: what was added, removed or changed, and whether it breaks users.",
    example="onto diff v0.1.0:ontology ontology",
    configure=_configure,
    run=_run,
)
