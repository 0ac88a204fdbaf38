"""Do the skills reach the goal? Played under dynamics, and every episode replayed in LIBERO's own environment.

Two ways to play, see :mod:`runtime.worlds.libero.skills.play`: ``reactive``, and ``lookahead``, whose candidates are
rehearsed in a fork of the simulation. The baseline lies within the reactive episode: until its first retry it is what
playing without retries would be, so the episode is cut there and judged once more (``first_try``). States 0 to 39 of
each task served to develop the skills; the full protocol takes the ten that did not. Mode ``controller``; the skills
see privileged simulator state, and look-ahead steps the true dynamics.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from itertools import product

from numpy.typing import ArrayLike

from benchmarks.intervals import wilson
from benchmarks.protocol import Protocol, Row, Trial
from benchmarks.skills_replay import SETTLE, ReplayJudge, ReplayVerdict
from onto_compiler.knowledge import load_knowledge
from runtime.worlds.libero.scene.horizons import horizon_of
from runtime.worlds.libero.simulator.assets import find_task, initial_states, tasks
from runtime.worlds.libero.simulator.compiled import compile_scene
from runtime.worlds.libero.simulator.simulation import Simulation
from runtime.worlds.libero.skills.play import PlayedEpisode, Player, SkillAttempt
from runtime.worlds.required import required_of

__all__ = ["FIRST_TRY", "PLAYS", "SKILLS", "SUITES", "before_retry", "succeeded"]

SEED = 0  # places the fixtures, which official initial states leave out
SUITES = ("libero_spatial", "libero_object", "libero_goal", "libero_10", "libero_90")
PLAYS = ("reactive", "lookahead")
FIRST_TRY = "first_try"
HELD_OUT = range(40, 50)
SMALL = (0,)  # a state that the skills were developed on, of the first task of each suite


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """Each way to play on each of a task's states, task by task."""
    return [
        {"key": f"{suite}/{ref.index}/{state}/{play}", "suite": suite, "task": ref.index, "state": state, "play": play}
        for suite in SUITES
        for ref in (tasks(suite) if full else tasks(suite)[:1])
        for state, play in product(HELD_OUT if full else SMALL, PLAYS)
    ]


def run(trial: Trial) -> list[Row]:
    """One episode, with its replay; of a reactive one also the replay of what came before its first retry."""
    return [_bench(trial["suite"], trial["task"]).row(trial["state"], trial["play"])]


class _Clocked(Simulation):
    """The exact simulation of an episode, which keeps how long it stepped: the rest of the time went into planning."""

    stepping_s = 0.0

    def step(self, action: ArrayLike, before_last_substep: Callable[[], object] | None = None) -> None:
        """As :meth:`Simulation.step`."""
        started = time.perf_counter()
        super().step(action, before_last_substep)
        self.stepping_s += time.perf_counter() - started


class _Bench:
    """A task's scene, player and judge, kept while trials of the task come."""

    def __init__(self, suite: str, task: int) -> None:
        knowledge = load_knowledge()
        ref = find_task(suite, task)
        required = required_of(ref, knowledge, ordered=True)
        scene = compile_scene(ref.bddl, SEED)
        self.name, self.horizon, self.states = ref.name, horizon_of(suite), initial_states(ref)
        self.player = Player(scene, required, knowledge)
        self.sim = _Clocked(scene, exact=True)
        self.native = ReplayJudge(ref, required, knowledge, SEED)

    def row(self, state: int, play: str) -> Row:
        start = self.states[state]
        self.sim.reset_to(start)
        self.sim.settle(SETTLE)
        self.sim.stepping_s = 0.0
        playing = time.perf_counter()
        played: PlayedEpisode = getattr(self.player, play)(self.sim, self.horizon)
        final = self.sim.data.qpos.copy()
        judging = time.perf_counter()
        verdict = self.native.run(start, played.actions, final)
        row = {
            "name": self.name,
            "mode": "controller",
            "sees": "privileged-state" if play == "reactive" else "privileged-state, true-dynamics",
            "horizon": self.horizon,
            "steps": len(played.actions),
            "rehearsed": played.rehearsed,
            **_verdict_fields(verdict),
            "premise_holds": verdict.premise_holds,
            "initially_true": verdict.initially_true,
            "replayed_same": verdict.same,
            "grounded": played.holds,
            "tries": [asdict(each) for each in played.tries],
        }
        if play == "reactive":
            row[FIRST_TRY] = self._first_try(state, played, row)
        row["timing"] = {
            "planning_s": judging - playing - self.sim.stepping_s,
            "stepping_s": self.sim.stepping_s,
            "judging_s": time.perf_counter() - judging,
        }
        return row

    def _first_try(self, state: int, played: PlayedEpisode, row: Row) -> Row:
        """The episode until its first retry; where there is none, the episode."""
        steps = before_retry(played.tries)
        if steps is None:
            return {name: row[name] for name in ("steps", "success", "outcome", "success_step", "failures")}
        verdict = self.native.run(self.states[state], played.actions[:steps], self.sim.data.qpos)
        fields = _verdict_fields(verdict)
        return {"steps": steps, **{name: fields[name] for name in ("success", "outcome", "success_step", "failures")}}


_KEPT: dict[tuple[str, int], _Bench] = {}  # what this process works on; trials come task by task


def _bench(suite: str, task: int) -> _Bench:
    if (suite, task) not in _KEPT:
        for other in _KEPT.values():
            other.native.close()
        _KEPT.clear()
        _KEPT[suite, task] = _Bench(suite, task)
    return _KEPT[suite, task]


def _verdict_fields(verdict: ReplayVerdict) -> Row:
    return {
        "success": verdict.outcome == "success",
        "outcome": verdict.outcome,
        "accepted": verdict.accepted,
        "settled": verdict.settled,
        "success_step": verdict.success_step,
        "failures": list(verdict.failures),
    }


def before_retry(tries: Sequence[SkillAttempt]) -> int | None:
    """Control steps until a fact is tried for the second time; None if none is."""
    steps, seen = 0, set()
    for each in tries:
        if each.fact in seen:
            return steps
        seen.add(each.fact)
        steps += each.steps
    return None


def succeeded(row: Row, play: str) -> bool:
    """Whether the row's episode succeeded, or with ``first_try`` the part before its first retry."""
    return bool(row.get(FIRST_TRY, {}).get("success") if play == FIRST_TRY else row.get("success"))


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Rates of the suites that were run, with Wilson intervals; a crashed trial is a failure and is counted apart."""
    whole = [row for row in rows if "crashed" not in row]
    states: dict[tuple[str, int], set[int]] = {}
    for row in rows:
        states.setdefault((row["suite"], row["task"]), set()).add(row["state"])
    found: dict[str, float] = {
        "trials": len(rows),
        "crashed": len(rows) - len(whole),
        "tasks": len(states),
        "states_per_task": min(map(len, states.values()), default=0),
        "replayed_same": sum(row["replayed_same"] for row in whole),
        "disagreements": sum(row["grounded"] != row["accepted"] for row in whole),
        "premise_false": sum(not row["premise_holds"] for row in whole if row["play"] == "reactive"),
        "initially_true": sum(row["initially_true"] for row in whole if row["play"] == "reactive"),
    }
    for suite, play in product(SUITES, (*PLAYS, FIRST_TRY)):
        chosen = [row for row in rows if row["suite"] == suite and row["play"] == (_PLAYED.get(play, play))]
        if not chosen:
            continue
        hits = sum(succeeded(row, play) for row in chosen)
        name = f"{play}_{suite}"
        found[name] = hits / len(chosen)
        found[f"{name}.low"], found[f"{name}.high"] = wilson(hits, len(chosen))
        found[f"{name}.n"] = len(chosen)
        steps = [
            row[FIRST_TRY]["steps"] if play == FIRST_TRY else row["steps"] for row in chosen if succeeded(row, play)
        ]
        if steps:
            found[f"{name}.steps"] = statistics.median(steps)
    return found


_PLAYED = {FIRST_TRY: "reactive"}

SKILLS = Protocol(
    name="skills",
    help="skills under dynamics from official initial states, reactive and with look-ahead, replayed natively",
    seeds=(SEED,),
    trials=trials,
    run=run,
    metrics=metrics,
    parts="suite",
    timed=frozenset({"timing"}),
)
