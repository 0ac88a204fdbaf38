"""``onto demo``: one episode per task of a suite, recorded, queried with SPARQL and reported."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

from onto_compiler.command import CLEAN, FINDINGS, print_json
from onto_compiler.knowledge import Knowledge, load_knowledge
from runtime.loop.records import Episode
from runtime.report import write_report
from runtime.report.gallery import Pictures
from runtime.trace.output import print_answer
from runtime.trace.rows import DEMONSTRATION
from runtime.trace.sparql import Answer, named_query
from runtime.trace.store import TraceStore
from runtime.trace.summary import demo_table
from runtime.worlds.episodes import EpisodeRunner
from runtime.worlds.pictures import ADVICE, Cameras
from runtime.worlds.world import world_of

__all__ = ["demonstrate"]

_QUESTIONS = ("unmet-predicates", "repairs")


@dataclass(frozen=True, slots=True)
class _Shown:
    episode: Episode
    pictures: Pictures | None


def demonstrate(options: argparse.Namespace, *, drawing: bool) -> int:
    """Run, record and report; exit code 1 when a task was not accepted."""
    started = time.perf_counter()
    knowledge = load_knowledge(*options.ontology)
    run = options.run or f"demo-{options.suite}-state{options.state}-seed{options.seed}"
    shown: list[_Shown] = []
    answers: list[Answer] = []
    where = options.out / "store"
    with TraceStore(where, knowledge.schema, run, ontology=options.ontology, tags=options.tag) as store:
        try:
            for each in _episodes(options, knowledge, drawing=drawing):
                store.add(each.episode)
                shown.append(each)
        finally:
            # What was recorded stays readable, however the run ends.
            if shown:
                store.export_trig(options.out / "trace.trig")
                answers = [store.query(query.text, name=query.name) for query in map(named_query, _QUESTIONS)]
                _report(options, shown, knowledge, answers)
    wall = time.perf_counter() - started
    accepted = sum(each.episode.accepted for each in shown)
    if options.format == "json":
        played = [each.episode for each in shown]
        settled = sum(bool(task.accepted and task.verification and task.verification.settled) for task in played)
        record = {"tasks": played, "accepted": accepted, "settled": settled, "wall_s": round(wall, 2)}
        print_json(DEMONSTRATION.of(record, knowledge.schema))
    else:
        _print(options, shown, knowledge, answers, wall)
    return CLEAN if accepted == len(shown) else FINDINGS


def _episodes(options: argparse.Namespace, knowledge: Knowledge, *, drawing: bool) -> Iterator[_Shown]:
    world = world_of(options.suite)
    proposers, refs = world.proposers(knowledge.schema), world.tasks(options.suite)
    columns = (BarColumn(20), MofNCompleteColumn(), TextColumn("{task.description}"))
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress, Cameras() as cameras:
        bar = progress.add_task("", total=len(refs))
        for ref in refs:
            progress.update(bar, description=ref.name.replace("_", " "))
            runner = EpisodeRunner.open(world, ref, knowledge, proposers, options.seed, options.budget)
            try:
                yield _show(runner, options.state, cameras if drawing else None)
            finally:
                runner.close()
            progress.advance(bar)


def _show(runner: EpisodeRunner, state: int, cameras: Cameras | None) -> _Shown:
    runner.start(state)
    if cameras is None:
        return _Shown(runner.correct(state), None)
    camera = cameras.of(runner.environment.textured())
    before = camera.shoot(runner.environment.data)
    episode = runner.correct(state)
    return _Shown(episode, (before, camera.shoot(runner.environment.data)))


def _report(
    options: argparse.Namespace, shown: Sequence[_Shown], knowledge: Knowledge, answers: Sequence[Answer]
) -> None:
    pictures = [each.pictures for each in shown if each.pictures is not None]
    episodes = [each.episode for each in shown]
    write_report(options.out / "report.html", episodes, knowledge.schema, answers, pictures)


def _print(
    options: argparse.Namespace,
    shown: Sequence[_Shown],
    knowledge: Knowledge,
    answers: Sequence[Answer],
    wall: float,
) -> None:
    episodes = [each.episode for each in shown]
    Console(highlight=False).print(demo_table(episodes, knowledge.schema))
    for answer in answers:
        print_answer(answer, "table")
    accepted = sum(e.accepted for e in episodes)
    settled = sum(bool(e.accepted and e.verification and e.verification.settled) for e in episodes)
    lines = [
        f"{accepted} of {len(episodes)} tasks accepted by the native predicate, {settled} still true after settling.",
        f"Seconds: {wall:.0f}",
        f"Trace: {options.out / 'trace.trig'}",
        f"Report: {options.out / 'report.html'}",
    ]
    if not all(each.pictures for each in shown):
        lines.append(f"The report has no pictures, as nothing here can draw; {ADVICE}")
    lines.append("Next: onto trace show 1; onto trace query --list; onto diagnose libero_10/2")
    sys.stdout.write("\n".join(lines) + "\n")
