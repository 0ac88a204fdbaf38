"""``onto audit``: whether each scene matches its task."""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from onto_compiler.command import CLEAN, FINDINGS, Command, add_format, add_ontology, print_json
from onto_compiler.problems import OntoError

if TYPE_CHECKING:
    from runtime.worlds.libero.audit.records import Audit
    from runtime.worlds.libero.simulator.assets import TaskRef

__all__ = ["AUDIT", "LIBERO"]

LIBERO = ("libero_spatial", "libero_object", "libero_goal", "libero_10", "libero_90")


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "suite", nargs="?", metavar="SUITE", help="a suite (default: the five of LIBERO), or `all` that are installed"
    )
    parser.add_argument("task", nargs="?", metavar="TASK", help="index or name of one task of the suite")
    parser.add_argument("--states", type=int, metavar="N", help="initial states of each task (default: all)")
    parser.add_argument("--tasks", type=int, metavar="N", help="tasks of each suite (default: all)")
    parser.add_argument("--seed", type=int, default=0, help="places the fixtures (default 0)")
    parser.add_argument("--jobs", type=int, metavar="N", help="worker processes (default: one for each processor)")
    parser.add_argument("--out", type=Path, metavar="FILE", help="also record the audit here, as JSON")
    parser.add_argument("--python", metavar="PATH", help="audit with the MuJoCo of another Python environment")
    parser.add_argument(
        "--diff", nargs=2, type=Path, metavar=("A", "B"), help="compare two recorded audits instead of making one"
    )
    kept = parser.add_mutually_exclusive_group()
    kept.add_argument(
        "--cache", type=Path, metavar="FOLDER", help="where audited tasks are kept (default: the user's cache)"
    )
    kept.add_argument("--no-cache", action="store_true", help="audit every task anew, and keep nothing")
    add_ontology(parser)
    add_format(parser)


def _run(options: argparse.Namespace) -> int:
    for name in ("states", "tasks", "jobs"):
        number = getattr(options, name)
        if number is not None and number < 1:
            raise OntoError.of("CLI002", f"--{name} must be at least 1, and is {number}", "leave it out for all")
    if options.diff is not None:
        return _diff(options)
    if options.python is not None:
        from runtime.worlds.libero.audit.interpreter import run_elsewhere  # noqa: PLC0415 - as below

        return run_elsewhere(options.python, _arguments(options))
    audit = _audit(options)
    if options.format == "json":
        print_json(audit.as_dict())
    else:
        from runtime.worlds.libero.audit.render import audit_text  # noqa: PLC0415 - as below

        sys.stdout.write(audit_text(audit))
    if options.out is not None:
        from runtime.worlds.libero.audit.records import write_audit  # noqa: PLC0415 - as below

        write_audit(options.out, audit)
    return CLEAN if audit.clean else FINDINGS


def _audit(options: argparse.Namespace) -> Audit:
    from rich.console import Console  # noqa: PLC0415 - heavy imports wait for the command to run
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn  # noqa: PLC0415

    from onto_compiler.batch import available_jobs  # noqa: PLC0415
    from onto_compiler.cache import cache_folder  # noqa: PLC0415
    from runtime.worlds.libero.audit.fan_out import AuditPlan, run_audit  # noqa: PLC0415

    refs = _refs(options)
    folder = None if options.no_cache else options.cache or cache_folder()
    plan = AuditPlan(options.states, options.seed, tuple(map(str, options.ontology)), folder)
    columns = (TextColumn("audit"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as progress:
        bar = progress.add_task("audit", total=len(refs))
        return run_audit(refs, plan, options.jobs or available_jobs(), lambda _: progress.advance(bar))


def _refs(options: argparse.Namespace) -> list[TaskRef]:
    from runtime.worlds.libero.simulator.assets import TaskRef, find_task, suites, tasks  # noqa: PLC0415 - as above

    suite: str | None = options.suite
    if suite is not None and suite.endswith(".bddl") and options.task is None:
        path = Path(suite)
        return [TaskRef("", 0, path.stem, path, Path())]
    if suite is not None and options.task is None:
        suite, _, options.task = suite.partition("/")
    if suite == "all" and options.task:
        raise OntoError.of(
            "CLI002", f"`all` suites have no task `{options.task}` in common", "name one suite, or use --tasks"
        )
    if suite is not None and options.task:
        return [find_task(suite, int(options.task) if options.task.isdigit() else options.task)]
    chosen = LIBERO if suite is None else suites() if suite == "all" else (suite,)
    return [ref for name in chosen for ref in tasks(name)[: options.tasks]]


def _arguments(options: argparse.Namespace) -> list[str]:
    """The command line for the same audit in another interpreter."""
    words = ["audit", *(word for word in (options.suite, options.task) if word is not None)]
    for name in ("states", "tasks", "seed", "jobs", "out", "cache", "format"):
        value = getattr(options, name)
        if value is not None:
            words += [f"--{name}", str(value)]
    words += ["--no-cache"] if options.no_cache else []
    return [*words, *(["--ontology", *map(str, options.ontology)] if options.ontology else [])]


def _diff(options: argparse.Namespace) -> int:
    from runtime.worlds.libero.audit.compare import compare  # noqa: PLC0415 - as above
    from runtime.worlds.libero.audit.records import read_audit  # noqa: PLC0415
    from runtime.worlds.libero.audit.render import changes_text  # noqa: PLC0415

    first, second = map(read_audit, options.diff)
    changes = compare(first, second)
    if options.format == "json":
        versions = [dict(first.versions), dict(second.versions)]
        print_json({"versions": versions, "changes": [asdict(change) for change in changes]})
    else:
        sys.stdout.write(changes_text(changes, first, second))
    return FINDINGS if changes else CLEAN


AUDIT = Command(
    name="audit",
    help="Check whether each scene matches its task: initial facts, goal, motion while settling, overlap.",
    example="onto audit libero_spatial 5 --states 10",
    configure=_configure,
    run=_run,
)
