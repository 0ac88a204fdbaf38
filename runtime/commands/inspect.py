"""``onto ground`` and ``onto diagnose``: what a state shows of a task's facts, and what follows from it."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from onto_compiler.command import CLEAN, FINDINGS, Command, add_format, add_ontology, print_json
from runtime.commands.options import add_state, add_task, settled_words

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
    from onto_compiler.tables import SATISFIED, STATUSES  # noqa: PLC0415 - heavy imports wait for the command to run
    from runtime.commands.opening import start_of, task_runner, uncertain_lines, uncertain_rows  # noqa: PLC0415
    from runtime.loop.diagnosis import evidence_status  # noqa: PLC0415
    from runtime.loop.records import state_name  # noqa: PLC0415
    from runtime.wording import amount, atom, short_name, unit_of  # noqa: PLC0415

    with task_runner(options) as runner:
        start, state = start_of(options)
        steps = runner.start(start, state, settle=options.settle)
        schema, required = runner.knowledge.schema, runner.required
        verdict = runner.environment.verify().outcome if runner.environment.judged else None
        record: dict[str, Any] = {
            "suite": runner.ref.suite,
            "task": required.task,
            "state": start,
            "settle_steps": steps,
            "fixtures": runner.placed or None,
            "uncertain": uncertain_rows(runner, start),
        }
        for part, facts, observation in (
            ("facts", required.facts, runner.environment.observe()),
            ("premise", required.premise, runner.environment.observe_premise()),
        ):
            statuses = evidence_status(facts, observation)
            record[part] = [
                {
                    "fact": atom(fact, schema),
                    "predicate": short_name(fact.predicate, schema),
                    "arguments": [argument.name for argument in fact.arguments],
                    "polarity": fact.polarity,
                    "truth": bool(observation.truth[i]),
                    "satisfied": STATUSES[statuses[i]] == SATISFIED,
                    "status": schema.labels[STATUSES[statuses[i]]],
                    "margin": float(observation.margin[i]),
                    "unit": unit_of(fact, schema),
                    "limit": observation.limit[i],
                    "native": str(fact.native),
                }
                for i, fact in enumerate(facts)
            ]
        record["native_success"] = verdict
    if options.format == "json":
        print_json(record)
        return CLEAN
    lines = [f"{record['task']}, {state_name(start)}, {settled_words(steps)}"]
    for part, heading in (("facts", "goal"), ("premise", "premise")):
        lines.append(f"  {heading}")
        for row in record[part]:
            mark = "yes" if row["satisfied"] else "no"
            limit = f" ({row['limit']})" if row["limit"] else ""
            status = "tolerated" if row["satisfied"] and row["truth"] != row["polarity"] else row["status"]
            lines.append(f"    {mark:<4}{row['fact']}: {amount(row['margin'], row['unit'])}{limit}, {status}")
    says = {
        True: "the native check says success",
        False: "the native check says no success",
        None: "LIBERO cannot judge",
    }
    lines.append(f"  {says[verdict]}")
    lines += uncertain_lines(record["uncertain"])
    sys.stdout.write("\n".join(lines) + "\n")
    return CLEAN


def _diagnose(options: argparse.Namespace) -> int:
    from runtime.commands.opening import start_of, task_runner, uncertain_lines, uncertain_rows  # noqa: PLC0415
    from runtime.loop.diagnosis import by_distance, diagnose_goal, select  # noqa: PLC0415
    from runtime.loop.records import state_name  # noqa: PLC0415
    from runtime.loop.routing import route  # noqa: PLC0415
    from runtime.wording import amount, atom, short_name, unit_of  # noqa: PLC0415

    with task_runner(options) as runner:
        start, state = start_of(options)
        steps = runner.start(start, state, settle=options.settle)
        knowledge, required = runner.knowledge, runner.required
        observation = runner.environment.observe()
        ways = by_distance(required, observation)
        ranked = [
            diagnose_goal(required, observation, knowledge.tables, rank)
            for rank in range(len(ways) if options.alternatives else 1)
        ]
        found, task = ranked[0], required.task
        uncertain = uncertain_rows(runner, start)
    schema = knowledge.schema
    first = select(found).index if found else -1
    rows = [
        {
            "predicate": short_name(d.fact.predicate, schema),
            "arguments": [argument.name for argument in d.fact.arguments],
            "polarity": d.fact.polarity,
            "truth": d.truth,
            "status": schema.labels[d.status],
            "margin": d.margin,
            "unit": unit_of(d.fact, schema),
            "limit": d.limit,
            "failure": short_name(d.failure, schema),
            "route": short_name(route(d, knowledge).route, schema),
            "rule": schema.labels.get(d.rule, d.rule),
            "selected": d.index == first,
        }
        for d in found
    ]
    if options.format == "json":
        record: dict[str, Any] = {
            "task": task,
            "state": start,
            "settle_steps": steps,
            "fixtures": runner.placed or None,
            "uncertain": uncertain,
            "diagnoses": rows,
        }
        if options.alternatives:
            record["alternatives"] = [[atom(d.fact, schema) for d in each] for each in ranked]
        print_json(record)
    else:
        heading = f"{task}, {state_name(start)}, {settled_words(steps)}"
        lines = [f"{heading}: {len(rows) or 'no'} unmet of {len(ways[0])} required"]
        if len(ways) > 1:
            lines[0] += f", by the nearest of {len(ways)} alternatives"
        for diagnosis, row in zip(found, rows, strict=True):
            margin = amount(diagnosis.margin, unit_of(diagnosis.fact, schema))
            limit = f", decided by {row['limit']}" if row["limit"] else ""
            lines += [
                f"  {row['failure']}: {atom(diagnosis.fact, schema)}",
                f"    margin {margin}{limit}; {row['status']}; rule “{row['rule']}”",
                f"    route {row['route']}{' (selected first)' if row['selected'] and len(rows) > 1 else ''}",
            ]
        for rank, each in enumerate(ranked[1:], 2):
            lines.append(f"  alternative {rank}: {', '.join(atom(d.fact, schema) for d in each) or 'nothing unmet'}")
        lines += uncertain_lines(uncertain)
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
