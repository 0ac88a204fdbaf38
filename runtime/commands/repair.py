"""``onto repair``: run the correction loop on one task and state, and tell what happened."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from onto_compiler.command import CLEAN, FINDINGS, Command, add_format, add_ontology, print_json
from runtime.commands.options import add_budget, add_state, add_task, settled_words

__all__ = ["REPAIR"]


def _configure(parser: argparse.ArgumentParser) -> None:
    add_task(parser)
    add_state(parser)
    add_budget(parser)
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="also record the episode in DIR/store and DIR/trace.trig"
    )
    add_ontology(parser)
    add_format(parser)


def _run(options: argparse.Namespace) -> int:
    from runtime.commands.opening import start_of, task_runner, uncertain_lines, uncertain_rows  # noqa: PLC0415 - heavy imports wait for the run
    from runtime.trace.narrate import narrate  # noqa: PLC0415
    from runtime.trace.store import TraceStore  # noqa: PLC0415
    from runtime.trace.summary import episode_summary  # noqa: PLC0415

    with task_runner(options) as runner:
        start, state = start_of(options)
        steps = runner.start(start, state, settle=options.settle)
        uncertain = uncertain_rows(runner, start)
        episode = runner.correct(start, settled=steps)
        schema, reason = runner.knowledge.schema, dict(episode.provenance).get("reason", "")
    if options.out is not None:
        with TraceStore(options.out / "store", schema, "repair", ontology=options.ontology) as store:
            store.add(episode)
            store.export_trig(options.out / "trace.trig")
    if options.format == "json":
        about = {"reason": reason or None, "settle_steps": steps, "uncertain": uncertain}
        print_json({**episode_summary(episode, schema), **about})
    else:
        told = [*narrate(episode, schema), f"  The start was {settled_words(steps)}."]
        told += [f"  It stays unresolved because {reason}."] if reason else []
        lines = [*told, *uncertain_lines(uncertain)]
        sys.stdout.write("\n".join(lines) + "\n")
    return CLEAN if episode.accepted else FINDINGS


REPAIR = Command(
    name="repair",
    help="Diagnose, route, correct and verify one task from one initial state.",
    example="onto repair libero_goal/8 --state 3 --budget 4",
    configure=_configure,
    run=_run,
)
