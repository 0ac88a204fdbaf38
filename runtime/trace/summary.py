"""A summary of one episode, as JSON and as a row of a table."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from onto_compiler.schema import Schema
from onto_compiler.wording import counted
from runtime.loop.records import Diagnosis, Episode, state_name
from runtime.trace.rows import EPISODE_ROW, first_diagnoses, margin_after, routes_of
from runtime.wording import amount, atom, short_name, unit_of

__all__ = ["demo_table", "episode_summary", "first_diagnoses", "margin_after", "routes_of", "verdict"]

_NARROW = 36  # what a table of 80 columns leaves for a fact
_VERDICTS = {"grounding_verifier_disagreement": "disagreement", "run_fault": "run fault"}
_STYLES = {"accepted": "green", "verified": "green", "retained": "cyan", "unresolved": "yellow"}


def episode_summary(episode: Episode, schema: Schema) -> dict[str, Any]:
    """The record as plain JSON values: names are notations, an undefined margin is None, lengths are in metres."""
    return EPISODE_ROW.of(episode, schema)


def verdict(episode: Episode) -> str:
    """The outcome in a few words, also whether grounding was the judge."""
    text = _VERDICTS.get(episode.outcome, episode.outcome)
    return f"{text} by grounding" if episode.accepted and episode.judge == "grounding" else text


def demo_table(episodes: Sequence[Episode], schema: Schema) -> Table:
    """A table that fits 80 columns: for each episode its unmet facts, what they were diagnosed as, and the verdict."""
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    table.add_column("task, unmet fact, margin before and after", ratio=1, overflow="fold")
    table.add_column("failure > route", overflow="fold")
    table.add_column("verdict", overflow="fold")
    for episode in episodes:
        name = Text(f"{episode.task.replace('_', ' ')}, {state_name(episode.state_index)}", style="bold")
        found = first_diagnoses(episode)
        facts = Text("\n").join([name, *(_before_after(d, episode, schema) for d in found)])
        ways = [line for diagnosis in found for line in _way(diagnosis, episode, schema)]
        table.add_row(facts, Text("\n".join(ways)), _cell(episode))
    return table


def _before_after(diagnosis: Diagnosis, episode: Episode, schema: Schema) -> Text:
    unit = unit_of(diagnosis.fact, schema)
    before, after = (amount(m, unit) for m in (diagnosis.margin, margin_after(episode, diagnosis.index)))
    margins = before if before == after else f"{before} -> {after}"
    fact = atom(diagnosis.fact, schema)
    if max(map(len, fact.split())) > _NARROW:
        fact = fact.replace("(", "(\n  ", 1)
    return Text(f"{fact}\n  {margins}")


def _way(diagnosis: Diagnosis, episode: Episode, schema: Schema) -> Iterator[str]:
    yield short_name(diagnosis.failure, schema)
    for route in dict.fromkeys(short_name(route, schema) for route in routes_of(episode, diagnosis.index)):
        yield f"> {route}"


def _cell(episode: Episode) -> Text:
    text = Text(verdict(episode), style=_STYLES.get(episode.outcome, "red"))
    settled = None if episode.verification is None else episode.verification.settled
    if settled is not None:
        text.append("\nsettled" if settled else "\nlost settling", style="green" if settled else "red")
    tries = len(episode.attempts)
    text.append(f"\n{counted(tries, 'attempt')}", style="default")
    return text
