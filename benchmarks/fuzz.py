"""A hundred thousand damaged BDDL and Turtle files, each put through what a person's file goes through.

Counted are exceptions other than the one that carries problems, inputs that take more than two seconds of a processor's
time, problems that do not say where they are, and printed tasks that read back as another task.
"""

from __future__ import annotations

import base64
import signal
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import FrameType
from typing import Any

from pyoxigraph import Store

from benchmarks.fuzz_inputs import FuzzInput, fuzz_input, past_the_lexer
from benchmarks.fuzz_seeds import BDDL
from benchmarks.memory import peak_mib
from benchmarks.protocol import Protocol, Row, Trial
from onto_compiler.bddl import lift, parse, parse_file
from onto_compiler.bddl.layout import format_text
from onto_compiler.bddl.printer import format_task
from onto_compiler.check.run import check
from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import OntoError, Problem, render
from onto_compiler.schema import Schema
from onto_compiler.sources import read_into
from onto_compiler.turtle.source_map import read_map

__all__ = ["FUZZ", "Outcome", "put_through"]

BLOCK = 1000
BLOCKS = {True: 100, False: 1}
HANG_S = 2.0
CHECKED = 20  # every twentieth Turtle file is checked whole


@dataclass(slots=True)
class Outcome:
    """What became of one input; ``fault`` is empty if nothing was wrong with us."""

    problems: tuple[Problem, ...] = ()
    past_lexer: bool = False
    checked: bool = False
    seconds: float = 0.0
    fault: str = ""  # "traceback", "hang", "unplaced" or "round trip"
    detail: str = ""


@dataclass(slots=True)
class _Block:
    counts: Counter[str] = field(default_factory=Counter)
    codes: Counter[str] = field(default_factory=Counter)
    worst: tuple[float, int] = (0.0, 0)
    offender: dict[str, Any] | None = None


class _Hang(BaseException):
    """Not an Exception, so that nothing on the way catches it."""


def put_through(one: FuzzInput, folder: Path, *, whole: bool = False) -> Outcome:
    """Write the input to a file below ``folder`` and read it as the commands do; ``whole`` runs every check."""
    path = folder / f"input.{one.language}"
    path.write_bytes(one.data)
    outcome = Outcome(past_lexer=past_the_lexer(one.data, one.language), checked=whole)
    started = time.process_time()
    try:
        with _alarm(HANG_S):
            outcome.problems, same = _bddl(path) if one.language == BDDL else _turtle(path, whole=whole)
            text = one.data.decode("utf-8", errors="replace")
            for problem in outcome.problems:
                render(problem, text)
    except _Hang:
        outcome.fault = "hang"
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # noqa: BLE001 - Oxigraph's panics are BaseExceptions, and all of them count
        outcome.fault, outcome.detail = "traceback", _error_line(error)
    else:
        lost = next((problem for problem in outcome.problems if problem.line < 1 or problem.column < 1), None)
        if lost is not None:
            outcome.fault, outcome.detail = "unplaced", f"{lost.code}: {lost.message}"
        elif not same:
            outcome.fault = "round trip"
    outcome.seconds = time.process_time() - started
    if outcome.seconds > HANG_S and not outcome.fault:
        outcome.fault = "hang"  # in native code, which no alarm interrupts
    return outcome


def _bddl(path: Path) -> tuple[tuple[Problem, ...], bool]:
    """Parse, lift, lint, lay out and read again; the second value says that the layout is the same task, and stays."""
    try:
        spec = parse_file(path)
    except OntoError as error:
        return error.problems, True
    # What readers pass over would be lost in the layout that keeps comments, which therefore refuses it.
    layout = format_text if not spec.passed_over else lambda text: format_task(parse(text))
    try:
        printed = layout(path.read_bytes().decode("utf-8"))
        same = parse(printed, spec.file) == spec and layout(printed) == printed
    except OntoError:
        same = False
    try:
        _, problems = lift(spec, _schema(), path.stem)
    except OntoError as error:
        problems = error.problems
    return problems, same


def _turtle(path: Path, *, whole: bool) -> tuple[tuple[Problem, ...], bool]:
    """Load, and locate every triple; or all of ``onto check``."""
    problems = tuple(read_into(Store(), path))
    if whole:
        problems += check([path]).problems
    if all(problem.code != "TTL002" for problem in problems):
        read_map(path)
    return problems, True


@cache
def _schema() -> Schema:
    return load_schema()


@contextmanager
def _alarm(seconds: float) -> Iterator[None]:
    """Interrupt what uses more processor time than this; what else the machine does must not decide."""

    def ring(_signal: int, _frame: FrameType | None) -> None:
        raise _Hang

    before = signal.signal(signal.SIGPROF, ring)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def _error_line(error: BaseException) -> str:
    """The error and the line of ours that it came from."""
    place, step = "", error.__traceback__
    while step is not None:
        name = Path(step.tb_frame.f_code.co_filename)
        if name.parent.name in {"onto_compiler", "bddl", "turtle", "check", "shacl"}:
            place = f"{name.parent.name}/{name.name}:{step.tb_lineno}"
        step = step.tb_next
    return f"{type(error).__name__}: {str(error)[:200]} ({place})"


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """Blocks of a thousand inputs, each of which is made from its number."""
    starts = [BLOCK * number for number in range(BLOCKS[full])]
    return [{"key": f"{start}", "first": start, "last": start + BLOCK - 1} for start in starts]


def run(trial: Trial) -> list[Row]:
    """One block as one row."""
    _schema()  # not on the clock of the first input
    block = _Block()
    with tempfile.TemporaryDirectory() as folder:
        for number in range(trial["first"], trial["last"] + 1):
            one = fuzz_input(number)
            whole = one.language != BDDL and number // 2 % CHECKED == 0
            _add(block, one, put_through(one, Path(folder).resolve(), whole=whole))
    row: Row = {
        "mode": "none",
        "sees": "none",
        "inputs": trial["last"] - trial["first"] + 1,
        **{name: block.counts[name] for name in COUNTED},
        "codes": dict(sorted(block.codes.items())),
        "worst_ms": round(1000 * block.worst[0], 1),
        "worst_input": block.worst[1],
        "peak_mib": round(peak_mib(), 1),
    }
    return [row | {"offender": block.offender} if block.offender else row]


COUNTED = ("bddl", "past_lexer", "checked", "clean", "problems", "traceback", "hang", "unplaced", "round trip")


def _add(block: _Block, one: FuzzInput, outcome: Outcome) -> None:
    block.counts["bddl"] += one.language == BDDL
    block.counts["past_lexer"] += outcome.past_lexer
    block.counts["checked"] += outcome.checked
    block.counts["clean"] += not outcome.problems
    block.counts["problems"] += len(outcome.problems)
    block.codes.update(problem.code for problem in outcome.problems)
    block.worst = max(block.worst, (outcome.seconds, one.number))
    if outcome.fault:
        block.counts[outcome.fault] += 1
        if block.offender is None:
            shown = one.data if len(one.data) < 20_000 else b""  # a longer one is made again from its number
            block.offender = {
                "number": one.number,
                "how": list(one.how),
                "fault": outcome.fault,
                "detail": outcome.detail,
                "base64": base64.b64encode(shown).decode(),
            }


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Sums over the blocks, the longest time and the largest memory of any."""
    done = [row for row in rows if "crashed" not in row]
    inputs = sum(row["inputs"] for row in done)
    codes = {code for row in done for code in row["codes"]}
    return {
        "inputs": inputs,
        "bddl": sum(row["bddl"] for row in done),
        "past_lexer_share": round(sum(row["past_lexer"] for row in done) / max(inputs, 1), 4),
        "checked": sum(row["checked"] for row in done),
        "clean": sum(row["clean"] for row in done),
        "problems": sum(row["problems"] for row in done),
        "codes": len(codes),
        "tracebacks": sum(row["traceback"] for row in done),
        "hangs": sum(row["hang"] for row in done),
        "unplaced": sum(row["unplaced"] for row in done),
        "round_trip_failures": sum(row["round trip"] for row in done),
        "worst_ms": max((row["worst_ms"] for row in done), default=0.0),
        "peak_mib": max((row["peak_mib"] for row in done), default=0.0),
        "seconds": round(sum(row["seconds"] for row in rows), 1),
        "crashed": len(rows) - len(done),
    }


FUZZ = Protocol(
    name="fuzz",
    help="tracebacks, hangs and memory over damaged BDDL and Turtle files",
    seeds=(0,),
    trials=trials,
    run=run,
    metrics=metrics,
    timed=frozenset({"worst_ms", "worst_input", "peak_mib"}),
    of_tree=frozenset({"past_lexer", "checked", "clean", "problems", "codes"}),
)
