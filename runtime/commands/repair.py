"""``onto repair``: run the correction loop on one task and state, and print what happened."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from onto_compiler.command import CLEAN, FINDINGS, Command, add_format, add_ontology, print_json
from runtime.commands.options import add_budget, add_state, add_task, settled_words, start_options, uncertain_lines
from runtime.trace.options import add_identity

__all__ = ["REPAIR"]


def _configure(parser: argparse.ArgumentParser) -> None:
    add_task(parser)
    add_state(parser)
    add_budget(parser)
    add_identity(parser)
    parser.add_argument(
        "--judge",
        choices=("native", "grounding"),
        default="native",
        help="who accepts: LIBERO's own predicate (default), or the facts as they are grounded, which the record says",
    )
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="also record the episode in DIR/store and DIR/trace.trig"
    )
    parser.add_argument(
        "--proposer",
        action="append",
        default=[],
        type=_choice,
        metavar="ROUTE=NAME",
        help="which proposer serves a route, where several are installed; may be given for several routes",
    )
    add_ontology(parser)
    add_format(parser)


def _choice(text: str) -> tuple[str, str]:
    route, equals, name = text.partition("=")
    if not (route and equals and name):
        raise argparse.ArgumentTypeError(f"`{text}` is not of the form ROUTE=NAME")
    return route, name


def _run(options: argparse.Namespace) -> int:
    from onto_compiler.knowledge import load_knowledge  # noqa: PLC0415 - heavy imports wait for the run
    from runtime.commands.tasks import repair  # noqa: PLC0415
    from runtime.trace.narrate import narrate  # noqa: PLC0415
    from runtime.trace.store import TraceStore  # noqa: PLC0415
    from runtime.trace.summary import episode_summary  # noqa: PLC0415
    from runtime.wording import wrapped  # noqa: PLC0415

    episode = repair(
        options.task,
        ontology=options.ontology,
        budget=options.budget,
        judge=options.judge,
        proposers=dict(options.proposer),
        **start_options(options),
    )
    schema = load_knowledge(*options.ontology).schema
    settings = dict(episode.provenance)
    reason, steps = settings.get("reason", ""), settings["start_settle_steps"]
    uncertain = json.loads(settings.get("uncertain", "[]"))
    if options.out is not None:
        run = options.run or "repair"
        with TraceStore(options.out / "store", schema, run, ontology=options.ontology, tags=options.tag) as store:
            store.add(episode)
            store.export_trig(options.out / "trace.trig")
    if options.format == "json":
        print_json(episode_summary(episode, schema))
    else:
        lines = [*narrate(episode, schema), *([f"  Reason: {reason}."] if reason else [])]
        lines += [f"  The start was {settled_words(steps)}.", *uncertain_lines(uncertain)]
        sys.stdout.write("\n".join(wrapped(lines)) + "\n")
    return CLEAN if episode.accepted else FINDINGS


REPAIR = Command(
    name="repair",
    help="Diagnose, route, correct and verify one task from one initial state.",
    example="onto repair libero_goal/8 --state 3 --budget 4",
    configure=_configure,
    run=_run,
)
