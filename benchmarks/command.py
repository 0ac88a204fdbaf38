"""``onto bench``: run a protocol, keep its rows, write its result."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

from benchmarks.protocol import Protocol, Row, load_protocols, protocol_named, registered_protocols
from onto_compiler.command import CLEAN, FINDINGS, Command, add_format, print_json
from onto_compiler.problems import OntoError

__all__ = ["BENCH"]


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", help="a protocol, `all`, or `list`")
    parser.add_argument("folder", nargs="?", type=Path, help="what `corpora` checks: a folder of checkouts")
    parser.add_argument("--full", action="store_true", help="the published size; the result goes to benchmarks/results")
    parser.add_argument("--out", type=Path, default=Path("out/bench"), help="where rows are kept (default out/bench)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes (default: one per core)")
    parser.add_argument(
        "--part", action="append", default=[], help="run only this part (a suite) and keep the result's other parts"
    )
    add_format(parser)


def _run(options: argparse.Namespace) -> int:
    if options.name == "list":
        helps = {name: _help(point) for name, point in registered_protocols().items()}
        if options.format == "json":
            print_json(helps)
        else:
            sys.stdout.write("".join(f"{name:<20}{text}\n" for name, text in helps.items()))
        return CLEAN
    if options.name == "all":
        chosen = [protocol for protocol in load_protocols().values() if protocol.of_folder is None]
    else:
        chosen = [protocol_named(options.name)]
    for protocol in chosen:
        if (protocol.of_folder is None) != (options.folder is None):
            wrong = "takes no folder" if protocol.of_folder is None else "needs a folder"
            hint = f"write `onto bench {protocol.name}{' FOLDER' if protocol.of_folder else ''}`"
            raise OntoError.of("CLI002", f"the protocol `{protocol.name}` {wrong}", hint)
    crashed = 0.0
    records = {}
    for protocol in chosen:
        records[protocol.name] = record = _measure(protocol, options)
        crashed += record["metrics"].get("crashed", 0)
    if options.format == "json":
        print_json({name: record["metrics"] for name, record in records.items()})
    else:
        for name, record in records.items():
            lines = [f"  {metric:<52}{value:>12.4g}" for metric, value in record["metrics"].items()]
            sys.stdout.write("\n".join([name, *lines]) + "\n")
    return FINDINGS if crashed else CLEAN


def _help(point: EntryPoint) -> str:
    """What a protocol measures, or what must be installed before it can be imported."""
    try:
        protocol: Protocol = point.load()
    except ImportError as error:
        return f"not available, as `{error.name}` is not installed"
    return protocol.help


def _measure(protocol: Protocol, options: argparse.Namespace) -> dict[str, Any]:
    from rich.console import Console  # noqa: PLC0415 - heavy imports wait for the run
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn  # noqa: PLC0415

    from benchmarks.engine import run_protocol  # noqa: PLC0415
    from benchmarks.parts import chosen_trials, joined  # noqa: PLC0415
    from benchmarks.results import RESULTS, changed, git, made_by, processors, read_result, write_result  # noqa: PLC0415

    size = "full" if options.full else "small"
    # Rows are resumed only where the code that made them is the code that runs now.
    commit = git("rev-parse", "--short=12", "HEAD") or "unversioned"
    rows_file = options.out / f"{protocol.name}.{size}.{commit}.jsonl"
    if changed():
        rows_file.unlink(missing_ok=True)
    every = protocol.trials(options.full) if protocol.of_folder is None else protocol.of_folder(options.folder)
    trials = chosen_trials(protocol, every, options.part)
    columns = (TextColumn(protocol.name), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as progress:
        bar = progress.add_task(protocol.name, total=len(trials))
        rows: Sequence[Row] = run_protocol(protocol, trials, rows_file, options.jobs, lambda: progress.advance(bar))
    named = "".join(f" --part {name}" for name in options.part)
    command = f"onto bench {protocol.name}{' --full' if options.full else ''}{named}"
    folder = RESULTS if options.full else options.out
    parts = None
    if protocol.parts:
        made = made_by(command) | processors()
        rows, parts = joined(folder / protocol.file, protocol, every, rows, made)
    path = write_result(folder, protocol, rows, command, parts=parts)
    sys.stderr.write(f"wrote {path}\n")
    return read_result(path)


BENCH = Command(
    name="bench",
    help="Run a measurement protocol and write its result with how it was made.",
    example="onto bench state_repair",
    configure=_configure,
    run=_run,
)
