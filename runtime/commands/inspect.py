"""``onto ground`` and ``onto diagnose``: the observed facts of a task in one state, and their diagnoses."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from onto_compiler.command import CLEAN, FINDINGS, Command, add_format, add_ontology, print_json
from runtime.commands.options import add_state, add_task, settled_words, start_options, uncertain_lines

if TYPE_CHECKING:
    pass

__all__ = ["DIAGNOSE", "GROUND"]


def _configure(parser: argparse.ArgumentParser) -> None:
    add_task(parser)
    add_state(parser)
    add_ontology(parser)
    add_format(parser)


def _configure_diagnose(parser: argparse.ArgumentParser) -> None:
    _configure(parser)
    parser.add_argument(
        "--alternatives",
        action="store_true",
        help="also what each other way to reach the goal lacks, the nearest first",
    )


def _ground(options: argparse.Namespace) -> int:
    from runtime.commands.tasks import ground  # noqa: PLC0415 - heavy imports wait for the command to run
    from runtime.loop.records import state_name  # noqa: PLC0415
    from runtime.trace.rows import GROUNDING  # noqa: PLC0415
    from runtime.wording import amount  # noqa: PLC0415

    found = ground(options.task, ontology=options.ontology, **start_options(options))
    if options.format == "json":
        print_json(GROUNDING.of(found))
        return CLEAN
    lines = [f"{found.task}, {state_name(found.state)}, {settled_words(found.settle_steps)}"]
    for heading, facts in (("goal", found.facts), ("premise", found.premise)):
        lines.append(f"  {heading}")
        for row in facts:
            mark = "yes" if row.satisfied else "no"
            limit = f" ({row.limit})" if row.limit else ""
            status = "tolerated" if row.satisfied and row.truth != row.polarity else row.status
            lines.append(f"    {mark:<4}{row.fact}: {amount(row.margin, row.unit)}{limit}, {status}")
    says = {
        True: "the native check says success",
        False: "the native check says no success",
        None: f"{found.world} cannot judge",
    }
    lines.append(f"  {says[found.native_success]}")
    lines += uncertain_lines(found.uncertain)
    sys.stdout.write("\n".join(lines) + "\n")
    return CLEAN


def _diagnose(options: argparse.Namespace) -> int:
    from runtime.commands.tasks import diagnose  # noqa: PLC0415 - as above
    from runtime.loop.records import state_name  # noqa: PLC0415
    from runtime.trace.rows import DIAGNOSES  # noqa: PLC0415
    from runtime.wording import amount  # noqa: PLC0415

    found = diagnose(options.task, ontology=options.ontology, **start_options(options))
    rows = found.diagnoses
    if options.format == "json":
        printed = DIAGNOSES.of(found)
        print_json(printed if options.alternatives else {k: v for k, v in printed.items() if k != "alternatives"})
        return FINDINGS if rows else CLEAN
    heading = f"{found.task}, {state_name(found.state)}, {settled_words(found.settle_steps)}"
    lines = [f"{heading}: {len(rows) or 'no'} unmet of {found.required} required"]
    if len(found.alternatives) > 1:
        lines[0] += f", by the nearest of {len(found.alternatives)} alternatives"
    for row in rows:
        limit = f", decided by {row.limit}" if row.limit else ""
        lines += [
            f"  {row.failure}: {row.fact}",
            f"    margin {amount(row.margin, row.unit)}{limit}; {row.status}; rule “{row.rule}”",
            f"    route {row.route}{' (selected first)' if row.selected and len(rows) > 1 else ''}",
        ]
    for rank, unmet in enumerate(found.alternatives[1:] if options.alternatives else (), 2):
        lines.append(f"  alternative {rank}: {', '.join(unmet) or 'nothing unmet'}")
    lines += uncertain_lines(found.uncertain)
    sys.stdout.write("\n".join(lines) + "\n")
    return FINDINGS if rows else CLEAN


GROUND = Command(
    name="ground",
    help="Ground a task's facts in an initial state: truth, signed margin and status of each.",
    example="onto ground libero_goal/8 --state 3",
    configure=_configure,
    run=_ground,
)
DIAGNOSE = Command(
    name="diagnose",
    help="Name each unmet fact of a task in an initial state, its kind of failure and its route.",
    example="onto diagnose libero_10/2 --json",
    configure=_configure_diagnose,
    run=_diagnose,
)
