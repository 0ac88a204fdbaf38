"""``onto plan pointmaze``: trials played row by row, a line for each, and a summary."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch

from grounding.world_model.checkpoint import read_card
from grounding.world_model.model import FILES
from onto_compiler.command import CLEAN, FINDINGS, print_json
from onto_compiler.knowledge import Knowledge, load_knowledge
from onto_compiler.problems import OntoError, near
from onto_compiler.schema import local_name
from onto_compiler.versions import version_of
from onto_compiler.wording import counted
from runtime.loop.diagnosis import unmet
from runtime.loop.records import Episode
from runtime.trace.file import require_format, write_trace
from runtime.worlds.pointmaze.grounded import MazeFacts, required_facts
from runtime.worlds.pointmaze.maze import MACRO_STEPS, maze_named
from runtime.worlds.pointmaze.planning.figures import write_plans
from runtime.worlds.pointmaze.planning.models import SEEDS, shipped
from runtime.worlds.pointmaze.planning.mpc import Planner, TrialResult, play
from runtime.worlds.pointmaze.planning.rows import MAZE, ROWS, maze_rollout, planner
from runtime.worlds.pointmaze.planning.trace import SUITE, TrialRecorder
from runtime.worlds.pointmaze.trials import trial, trial_seed

__all__ = ["episodes", "generator", "numbers", "run"]

_RANGE = re.compile(r"(\d+)(?:-(\d+))?")
_MOST = 10_000
_HEADER = f"{'trial':>7}  {'plans':>5}  {'reached':<7}  {'distance':>8}  {'m':>6}  {'m/s':>6}  predicted to be unmet\n"


def run(options: argparse.Namespace) -> int:
    """Play every row on every trial; exit code 1 where one did not reach its target."""
    wanted = numbers(options.trials)
    folder = shipped(options.seed) if options.model is None else options.model
    _require(options, folder)
    torch.set_num_threads(1)
    knowledge = load_knowledge()
    facts = MazeFacts(maze_named(MAZE), required_facts(knowledge), knowledge)
    players = {name: planner(name, folder) for name in dict.fromkeys(options.row)}
    records, played = dict[str, list[dict[str, Any]]](), dict[str, list[TrialResult]]()
    for name, who in players.items():
        if options.format == "text":
            sys.stdout.write(f"{name}, which sees {ROWS[name].sees}\n{_HEADER}")
        records[name], played[name] = [], []
        for each in _played(who, wanted, options.seed):
            played[name].append(each)
            records[name].append(_record(each, facts))
            if options.format == "text":
                sys.stdout.write(_line(records[name][-1]))
                sys.stdout.flush()
        if options.format == "text":
            sys.stdout.write(_closing(summary(records[name])))
    if options.format == "json":
        print_json(_document(records, options.seed))
    if options.trace is not None:
        runs = [
            (f"{options.run or SUITE}-{name}", episodes(name, some, facts, knowledge, options.seed, folder))
            for name, some in played.items()
        ]
        write_trace(options.trace, runs, knowledge.schema, tags=options.tag)
    if options.picture is not None:
        write_plans(options.picture, played, facts, knowledge.schema)
    return CLEAN if all(row["success"] for rows in records.values() for row in rows) else FINDINGS


def numbers(text: str) -> tuple[int, ...]:
    """The trials that ``7``, ``0-49`` or ``0-9,20`` name, in that order; raises ``PMZ005`` for another text."""
    found = dict[int, None]()
    for part in text.split(","):
        match = _RANGE.fullmatch(part.strip())
        first, last = (int(match[1]), int(match[2] or match[1])) if match else (1, 0)
        if last < first or last - first >= _MOST:
            raise OntoError.of("PMZ005", f"`{part}` names no trials", "give numbers or ranges: 7, 0-49 or 0-9,20")
        trial_seed(last)
        found.update(dict.fromkeys(range(first, last + 1)))
    return tuple(found)


def generator(number: int, seed: int) -> torch.Generator:
    """The random generator of a trial's plans, the same as for the published rows."""
    return torch.Generator().manual_seed(number * len(SEEDS) + seed)


def episodes(
    name: str, played: Sequence[TrialResult], facts: MazeFacts, knowledge: Knowledge, seed: int, folder: Path
) -> list[Episode]:
    """The records of trials that the row ``name`` played with the world model in ``folder``."""
    about: dict[str, Any] = {each: version_of(each) for each in ("onto-evwm", "mujoco", "numpy", "torch")}
    about |= {"row": name, "sees": ROWS[name].sees}
    if ROWS[name].learned:
        card = read_card(folder / FILES["dynamics"])
        about |= {"model_command": card.command, "model_commit": card.commit, "model_seed": card.seed}
    recorder = TrialRecorder(facts, knowledge, name, seed, tuple(about.items()))
    return [recorder.episode(each) for each in played]


def summary(rows: Sequence[dict[str, Any]]) -> dict[str, float]:
    """The summary of a row's trials: rates and means."""
    parts = ("distance", "position", "velocity", "plans", "evaluations", "seconds")
    reached = sum(row["success"] for row in rows)
    return {"trials": len(rows), "reached": reached} | {
        part: float(np.mean([row[part] for row in rows])) for part in parts
    }


def _require(options: argparse.Namespace, folder: Path) -> None:
    """Check the options before anything is played."""
    for name in options.row:
        if name not in ROWS:
            raise OntoError.of("PMZ008", f"`{name}` is not a row", near(name, ROWS) or f"rows: {', '.join(ROWS)}")
    if options.seed < 0 or (options.model is None and options.seed not in SEEDS):
        hint = f"models ship for {', '.join(map(str, SEEDS))}; with another seed from 0, name a --model"
        raise OntoError.of("PMZ008", f"no model ships for seed {options.seed}", hint)
    missing = next((folder / file for file in FILES.values() if not (folder / file).is_file()), None)
    if missing is not None and any(ROWS[name].learned for name in options.row):
        hint = f"train one with `onto train pointmaze --seed {options.seed}`, and give its folder with --model"
        raise OntoError.of("WM001", "there is no checkpoint here", hint, str(missing))
    if options.trace is not None:
        require_format(options.trace)
    if options.picture is not None and options.picture.suffix.lower() != ".html":
        raise OntoError.of(
            "TRC001", f"`{options.picture}` is not an HTML page", "end its name in .html", str(options.picture)
        )


def _played(who: Planner, wanted: Sequence[int], seed: int) -> Iterator[TrialResult]:
    for number in wanted:
        yield play(trial(number), who, maze_rollout(), generator(number, seed), MACRO_STEPS)


def _record(played: TrialResult, facts: MazeFacts) -> dict[str, Any]:
    """A trial as plain values; ``unmet`` are the facts predicted to be unmet, or not observed, for the last plan."""
    seen = played.steps[-1].made.predicted
    lacking = None
    if seen is not None:
        names = [local_name(fact.predicate) for fact in facts.required.facts]
        lacking = [
            names[index] if seen.observed[index] else f"{names[index]} (not observed)"
            for index in unmet(facts.required, seen)
        ]
    return {"trial": played.trial.number, **played.figures, "unmet": lacking, "seconds": played.seconds}


def _line(row: dict[str, Any]) -> str:
    lacking = "nothing was predicted" if row["unmet"] is None else ", ".join(row["unmet"])
    numbers_ = f"{row['distance']:>8.3f}  {row['position']:>6.3f}  {row['velocity']:>6.3f}"
    reached = "yes" if row["success"] else "no"
    return f"{row['trial']:>7}  {row['plans']:>5}  {reached:<7}  {numbers_}  {lacking}".rstrip() + "\n"


def _closing(found: dict[str, float]) -> str:
    return (
        f"  {found['reached']:.0f} of {counted(int(found['trials']), 'trial')} reached; mean distance "
        f"{found['distance']:.3f}\n  ({found['position']:.3f} m, {found['velocity']:.3f} m/s) after "
        f"{found['plans']:.2f} plans, {found['evaluations']:,.0f} candidates, {found['seconds']:.1f} s\n"
    )


def _document(records: dict[str, list[dict[str, Any]]], seed: int) -> dict[str, Any]:
    rows = [
        {"row": name, "sees": ROWS[name].sees, "mode": "controller", "trials": some, "summary": summary(some)}
        for name, some in records.items()
    ]
    return {"seed": seed, "rows": rows}
