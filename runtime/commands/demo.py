"""``onto demo``: the main job on the ten LIBERO-Goal tasks, recorded, questioned and reported."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from onto_compiler.command import CLEAN, FINDINGS, Command, add_format, add_ontology, print_json
from runtime.commands.options import add_budget

if TYPE_CHECKING:
    from onto_compiler.knowledge import Knowledge
    from runtime.records import Episode
    from runtime.trace.sparql import Answer
    from runtime.trace.store import TraceStore

__all__ = ["DEMO"]

_QUESTIONS = ("unmet-predicates", "repairs")


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--out", type=Path, default=Path("out/demo"), metavar="DIR", help="default out/demo")
    parser.add_argument("--suite", default="libero_goal", help="which suite's tasks (default libero_goal)")
    parser.add_argument("--state", type=int, default=0, metavar="N", help="official initial state, from 0 (default 0)")
    parser.add_argument("--seed", type=int, default=0, help="places the fixtures (default 0)")
    add_budget(parser)
    add_ontology(parser)
    add_format(parser)


def _run(options: argparse.Namespace) -> int:
    from onto_compiler.knowledge import load_knowledge  # noqa: PLC0415 - heavy imports wait for the command to run
    from runtime.report import write_report  # noqa: PLC0415
    from runtime.trace.sparql import named_query  # noqa: PLC0415
    from runtime.trace.store import TraceStore  # noqa: PLC0415

    started = time.perf_counter()
    knowledge = load_knowledge(*options.ontology)
    run = f"demo-{options.suite}-state{options.state}-seed{options.seed}"
    episodes: list[Episode] = []
    answers: list[Answer] = []
    with TraceStore(options.out / "store", knowledge.schema, run, ontology=options.ontology) as store:
        try:
            _episodes(options, knowledge, store, episodes)
        finally:
            # What was recorded stays readable, however the run ends.
            if episodes:
                queries = [named_query(name) for name in _QUESTIONS]
                answers = [store.query(query.text, name=query.name) for query in queries]
                store.export_trig(options.out / "trace.trig")
                write_report(options.out / "report.html", episodes, knowledge.schema, answers)
    accepted = sum(episode.accepted for episode in episodes)
    wall = round(time.perf_counter() - started, 2)
    if options.format == "json":
        from runtime.summary import episode_summary  # noqa: PLC0415 - as above

        tasks = [episode_summary(episode, knowledge.schema) for episode in episodes]
        settled = sum(bool(task["settled"]) for task in tasks if task["accepted"])
        print_json({"tasks": tasks, "accepted": accepted, "settled": settled, "wall_s": wall})
    else:
        _print(episodes, knowledge, answers, options.out, wall)
    return CLEAN if accepted == len(episodes) else FINDINGS


def _episodes(options: argparse.Namespace, knowledge: Knowledge, store: TraceStore, episodes: list[Episode]) -> None:
    from rich.console import Console  # noqa: PLC0415 - as above
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn  # noqa: PLC0415

    from runtime.episodes import EpisodeRunner  # noqa: PLC0415
    from runtime.proposers.registry import load_proposers  # noqa: PLC0415
    from runtime.simulator.assets import tasks  # noqa: PLC0415

    proposers = load_proposers(knowledge.schema)
    refs = tasks(options.suite)
    columns = (BarColumn(20), MofNCompleteColumn(), TextColumn("{task.description}"))
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        bar = progress.add_task("", total=len(refs))
        for ref in refs:
            progress.update(bar, description=ref.name.replace("_", " "))
            runner = EpisodeRunner.open(ref, knowledge, proposers, options.seed, options.budget)
            try:
                episode = runner.run(options.state)
            finally:
                runner.close()
            store.add(episode)
            episodes.append(episode)
            progress.advance(bar)


def _print(
    episodes: Sequence[Episode], knowledge: Knowledge, answers: Sequence[Answer], out: Path, wall: float
) -> None:
    from rich.console import Console  # noqa: PLC0415 - as above

    from runtime.summary import demo_table  # noqa: PLC0415
    from runtime.trace.asking import print_answer  # noqa: PLC0415

    console = Console(highlight=False)
    console.print(demo_table(episodes, knowledge.schema))
    for answer in answers:
        print_answer(answer, "table")
    accepted = sum(e.accepted for e in episodes)
    settled = sum(bool(e.accepted and e.verification and e.verification.settled) for e in episodes)
    sys.stdout.write(
        f"{accepted} of {len(episodes)} tasks repaired and accepted by the native predicate, {settled} still true after"
        f" settling, in {wall:.0f} s.\n"
        f"Trace: {out / 'trace.trig'}\nReport: {out / 'report.html'}\n"
        "Next: onto trace show 1; onto trace query --list; onto diagnose libero_10/2\n"
    )


DEMO = Command(
    name="demo",
    help="Diagnose, repair and verify the ten LIBERO-Goal tasks from their initial states, and report it.",
    example="onto demo --json",
    configure=_configure,
    run=_run,
)
