"""``onto demos``: collect demonstrations, replay them natively, and list the contents of a file."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from onto_compiler.command import CLEAN, FINDINGS, Command, add_format, print_json
from onto_compiler.problems import OntoError

if TYPE_CHECKING:
    from runtime.worlds.libero.demos.collect import CollectionRequest

__all__ = ["DEFAULT_FOLDER", "DEMOS", "SUITES"]

DEFAULT_FOLDER = Path("out/demos")
SUITES = ("libero_goal", "libero_spatial", "libero_object", "libero_10")
"""What ``--all`` collects."""


def _configure(parser: argparse.ArgumentParser) -> None:
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    collect = actions.add_parser("collect", help="make demonstrations with skills", description=_collect.__doc__)
    collect.add_argument("suite", nargs="?", metavar="SUITE", help="a suite, or SUITE/TASK")
    collect.add_argument("task", nargs="?", metavar="TASK", help="index or name of one task of the suite")
    collect.add_argument("--all", action="store_true", help=f"the suites {', '.join(SUITES)}")
    collect.add_argument("--count", type=int, metavar="N", help="per task (default: 50 in libero_goal, otherwise 10)")
    collect.add_argument("--seed", type=int, default=0, help="decides every trial (default 0)")
    collect.add_argument("--out", type=Path, default=DEFAULT_FOLDER, metavar="DIR", help="default: out/demos")
    collect.add_argument("--images", action="store_true", help="with pictures of both cameras, 128 x 128")
    _add_jobs(collect)
    replay = actions.add_parser("replay", help="execute demonstrations natively", description=_replay.__doc__)
    _add_files(replay)
    _add_jobs(replay)
    show = actions.add_parser("show", help="say what files hold", description=_show.__doc__)
    _add_files(show)
    for action in (collect, replay, show):
        add_format(action)


def _add_files(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", nargs="*", type=Path, metavar="FILE", help="files or folders (default: out/demos)")


def _add_jobs(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--jobs", type=int, metavar="N", help="worker processes (default: one for each processor)")


def _run(options: argparse.Namespace) -> int:
    actions = {"collect": _collect, "replay": _replay, "show": _show}
    return actions[options.action](options)


def _collect(options: argparse.Namespace) -> int:
    """Collect demonstrations from skills under seeded disturbances; resumes an interrupted run."""
    from runtime.worlds.libero.demos.collect import collect  # noqa: PLC0415 - heavy imports wait for the command to run
    from runtime.worlds.libero.demos.render import collected_text  # noqa: PLC0415

    orders = _orders(options)
    with _progress("tasks", len(orders)) as tick:
        found = collect(orders, _jobs(options), tick)
    if options.format == "json":
        print_json({"tasks": [{**asdict(one), "short": one.short} for one in found]})
    else:
        sys.stdout.write(collected_text(found))
    return FINDINGS if any(one.short for one in found) else CLEAN


def _orders(options: argparse.Namespace) -> list[CollectionRequest]:
    from runtime.worlds.libero.demos.collect import CollectionRequest, count_for  # noqa: PLC0415 - as above
    from runtime.worlds.libero.simulator.assets import find_task, tasks  # noqa: PLC0415

    if options.all == (options.suite is not None):
        raise OntoError.of("CLI002", "name a suite, or give --all", "such as `onto demos collect libero_goal 8`")
    if options.count is not None and options.count < 1:
        raise OntoError.of("CLI002", f"--count must be at least 1, and is {options.count}")
    if options.seed < 0:
        raise OntoError.of("CLI002", f"--seed must not be negative, and is {options.seed}")
    suite, task = options.suite or "", options.task
    if task is None:
        suite, _, task = suite.partition("/")
    if task:
        refs = [find_task(suite, int(task) if task.isdigit() else task)]
    else:
        refs = [ref for name in (SUITES if options.all else (suite,)) for ref in tasks(name)]
    return [
        CollectionRequest(ref, options.count or count_for(ref.suite), options.seed, options.out, images=options.images)
        for ref in refs
    ]


def _replay(options: argparse.Namespace) -> int:
    """Execute every demonstration in LIBERO's own environment, and report whether it succeeds at its recorded step."""
    from onto_compiler.pool import map_over_processes  # noqa: PLC0415
    from runtime.worlds.libero.demos.render import replays_text  # noqa: PLC0415 - as above
    from runtime.worlds.libero.demos.replay import replay_file  # noqa: PLC0415

    files = _files(options)
    found = {}
    with _progress("files", len(files)) as tick:
        for file, results in map_over_processes(replay_file, files, _jobs(options)):
            if isinstance(results, OntoError):
                raise results
            found[file] = results
            tick(file)
    replays = [replay for file in files for replay in found[file]]
    if options.format == "json":
        print_json({"demos": [{**asdict(one), "same": one.same} for one in replays]})
    else:
        sys.stdout.write(replays_text(replays))
    return CLEAN if all(one.same for one in replays) else FINDINGS


def _show(options: argparse.Namespace) -> int:
    """List each file's task, and each demonstration's length and origin."""
    from runtime.worlds.libero.demos.read import load  # noqa: PLC0415 - as above
    from runtime.worlds.libero.demos.render import file_record, file_text  # noqa: PLC0415

    records = [file_record(load(path)) for path in _files(options)]
    if options.format == "json":
        print_json({"files": records})
    else:
        sys.stdout.write("\n".join(map(file_text, records)))
    return CLEAN


def _files(options: argparse.Namespace) -> list[Path]:
    """The files that are named, and those in the folders that are; raises ``DEM001`` if there are none."""
    given: list[Path] = options.files or [DEFAULT_FOLDER]
    found = [file for path in given for file in (_inside(path) if path.is_dir() else [path])]
    if not found:
        message = f"there are no demonstrations in {', '.join(map(str, given))}"
        raise OntoError.of("DEM001", message, "`onto demos collect libero_goal 8 --count 1` makes one")
    return found


def _inside(folder: Path) -> Iterator[Path]:
    return (path for path in sorted(folder.rglob("*.hdf5")) if not path.parent.name.endswith(".parts"))


def _jobs(options: argparse.Namespace) -> int:
    from onto_compiler.batch import available_jobs  # noqa: PLC0415 - as above

    if options.jobs is not None and options.jobs < 1:
        raise OntoError.of("CLI002", f"--jobs must be at least 1, and is {options.jobs}", "leave it out for all")
    return options.jobs or available_jobs()


@contextmanager
def _progress(what: str, total: int) -> Iterator[Callable[[object], None]]:
    """A bar on standard error, and the function that moves it on."""
    from rich.console import Console  # noqa: PLC0415 - as above
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn  # noqa: PLC0415

    columns = (TextColumn(what), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as progress:
        bar = progress.add_task(what, total=total)
        yield lambda _: progress.advance(bar)


DEMOS = Command(
    name="demos",
    help="Collect demonstrations in LIBERO's HDF5 layout, replay them natively, and say what a file holds.",
    example="onto demos collect libero_goal 8 --count 1",
    configure=_configure,
    run=_run,
)
