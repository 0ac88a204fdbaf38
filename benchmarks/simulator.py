"""The simulator beside the native environment: speed, what it agrees on bit for bit, memory, and repetition.

Two tasks of each suite, the same actions for all: the compiled loop, the exact loop, the native environment, and bare
``mj_step`` on the states of the compiled loop. Times of loops are processor time of their thread, so that a
neighbour's load is not charged to them; every time stands in a row's ``timing``, and without it equal runs give equal
rows.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from benchmarks.protocol import Protocol, Row, Trial, alone
from benchmarks.simulator_processes import in_process, together
from benchmarks.simulator_task import measure_task, rolled_out

__all__ = ["SIMULATOR", "TASKS"]

TASKS = (
    ("libero_spatial", 3),
    ("libero_spatial", 5),  # the bowl lies on a ramekin
    ("libero_object", 0),
    ("libero_object", 6),
    ("libero_goal", 0),  # a drawer to open
    ("libero_goal", 8),
    ("libero_10", 2),  # two facts: a knob, and a pot on the burner
    ("libero_10", 9),  # a microwave that stands open
    ("libero_90", 10),
    ("libero_90", 76),  # right of the caddy
)
ACTIONS, ROUNDS, NATIVE_RESETS = 200, 3, 3  # of each task
PROCESS_STARTS = 5
SCALING_STEPS, SCALING_ROUNDS = 1500, 5
MEMORY_RESETS, MEMORY_STEPS = 200, 100_000
SCALED = ("libero_goal", 8)  # the scene of what runs in processes of its own


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """Two tasks of each suite, then what has processes of its own; small: two tasks, and little of the rest."""
    chosen = TASKS if full else (TASKS[2], TASKS[4])
    sizes = {"actions": ACTIONS, "rounds": ROUNDS if full else 1, "resets": NATIVE_RESETS if full else 1}
    tasks: list[Trial] = [{"key": f"{s}/{t}", "kind": "task", "suite": s, "task": t, **sizes} for s, t in chosen]
    suite, task = SCALED
    where = {"suite": suite, "task": task}
    resets, steps = (MEMORY_RESETS, MEMORY_STEPS) if full else (20, 1000)
    rounds, many = (SCALING_ROUNDS, SCALING_STEPS) if full else (1, 200)
    return [
        *tasks,
        {"key": "first_step", "kind": "first_step", **where, "starts": PROCESS_STARTS if full else 2},
        {"key": "scaling", "kind": "scaling", **where, "rounds": rounds, "steps": many},
        {"key": "memory", "kind": "memory", **where, "resets": resets, "steps": steps},
        *({"key": f"again/{s}/{t}", "kind": "again", "suite": s, "task": t, "actions": ACTIONS} for s, t in chosen),
    ]


def run(trial: Trial) -> list[Row]:
    """One row."""
    return [{"mode": "controller", "sees": "privileged-state", **_RUN[trial["kind"]](trial)}]


def _task(trial: Trial) -> Row:
    return measure_task(trial["suite"], trial["task"], trial["actions"], trial["rounds"], trial["resets"])


def _first_step(trial: Trial) -> Row:
    """Wall time from the start of a process to the end of its first control step, the scene being cached."""
    command = ("first-step", trial["suite"], str(trial["task"]))
    in_process(*command)  # fills the caches
    found = [in_process(*command) for _ in range(trial["starts"])]
    return {
        "digest": found[0]["digest"],
        "same": len({one["digest"] for one in found}) == 1,
        "timing": {"first_step_s": [one["wall_s"] for one in found]},
    }


def _scaling(trial: Trial) -> Row:
    """Steps a second of one process and of two at once, of the compiled loop and of bare ``mj_step``, in turns."""
    timing: dict[str, list[float]] = {"loop_1": [], "loop_2": [], "physics_1": [], "physics_2": []}
    for _ in range(trial["rounds"]):
        for kind in ("loop", "physics"):
            for many in (1, 2):
                command = (kind, trial["suite"], str(trial["task"]), str(trial["steps"]))
                found = together(many, *command)
                timing[f"{kind}_{many}"].append(sum(trial["steps"] / one["wall_s"] for one in found))
    return {"timing": timing}


def _memory(trial: Trial) -> Row:
    """What a process grows by from the first tenth of its resets and steps to the last."""
    command = ("memory", trial["suite"], str(trial["task"]), str(trial["resets"]), str(trial["steps"]))
    found = in_process(*command)
    return {
        "digest": found["digest"],
        "done_resets": found["resets"],
        "done_steps": found["steps"],
        "faults": found["faults"],
        "timing": {"before_mib": found["before_mib"], "after_mib": found["after_mib"], "wall_s": found["wall_s"]},
    }


def _again(trial: Trial) -> Row:
    """The same actions once here and once in a fresh process: equal to the last bit, or not."""
    command = ("digest", trial["suite"], str(trial["task"]), str(trial["actions"]))
    here = rolled_out(trial["suite"], trial["task"], trial["actions"])
    return {"digest": here, "same": in_process(*command)["digest"] == here}


_RUN: Mapping[str, Callable[[Trial], Row]] = {
    "task": _task,
    "first_step": _first_step,
    "scaling": _scaling,
    "memory": _memory,
    "again": _again,
}


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Medians over the tasks; ``min`` and ``max`` are the worst task's."""
    whole = [row for row in rows if "crashed" not in row]
    found: dict[str, float] = {"crashed": len(rows) - len(whole)}
    by_kind = {kind: [row for row in whole if row["kind"] == kind] for kind in _RUN}
    if by_kind["task"]:
        found |= _of_tasks(by_kind["task"])
    for row in by_kind["first_step"]:
        found["first_step_s"] = float(np.median(row["timing"]["first_step_s"]))
    for row in by_kind["scaling"]:
        medians = {name: float(np.median(values)) for name, values in row["timing"].items()}
        loop, physics = (medians[f"{kind}_2"] / medians[f"{kind}_1"] for kind in ("loop", "physics"))
        found |= {"scaling_2": loop / physics, "loop_2": loop / 2, "physics_2": physics / 2}
    for row in by_kind["memory"]:
        timing = row["timing"]
        found |= {"memory_resets": row["done_resets"], "memory_steps": row["done_steps"], "faults": row["faults"]}
        found["memory_growth_mib"] = timing["after_mib"] - timing["before_mib"]
    again = [*by_kind["again"], *by_kind["first_step"]]
    found["repeated_unequal"] = sum(not row["same"] for row in again)
    return found


def _of_tasks(rows: Sequence[Row]) -> dict[str, float]:
    def per_task(ratio: Callable[[Mapping[str, Any]], float]) -> list[float]:
        return [ratio(row["timing"]) for row in rows]

    loop = per_task(lambda t: t["compiled_steps_s"] / t["native_steps_s"])
    exact = per_task(lambda t: t["exact_steps_s"] / t["native_steps_s"])
    physics = per_task(lambda t: t["compiled_steps_s"] / t["physics_steps_s"])
    share = per_task(lambda t: t["grounding_us"] * t["compiled_steps_s"] / 1e6)
    margins = per_task(lambda t: t["margins_us"] * t["compiled_steps_s"] / 1e6)
    native = per_task(lambda t: t["grounding_us"] / t["check_success_us"])
    return {
        "tasks": len(rows),
        "steps_ratio": float(np.median(loop)),
        "steps_ratio.min": min(loop),
        "exact_ratio": float(np.median(exact)),
        "compiled_steps_s": float(np.median(per_task(lambda t: t["compiled_steps_s"]))),
        "native_steps_s": float(np.median(per_task(lambda t: t["native_steps_s"]))),
        "physics_share": float(np.median(physics)),
        "physics_share.min": min(physics),
        "setup_ms": float(np.median(per_task(lambda t: t["setup_ms"]))),
        "setup_ms.max": max(per_task(lambda t: t["setup_ms"])),
        "setup_ratio": float(np.median(per_task(lambda t: t["native_setup_ms"] / t["setup_ms"]))),
        "grounding_us": float(np.median(per_task(lambda t: t["grounding_us"]))),
        "grounding_share": float(np.median(share)),
        "grounding_share.max": max(share),
        "margins_us": float(np.median(per_task(lambda t: t["margins_us"]))),
        "margins_share": float(np.median(margins)),
        "margins_share.max": max(margins),
        "grounding_vs_native": float(np.median(native)),
        "grounding_vs_native.max": max(native),
        "parity_max_qpos_error": max(row["parity_max_qpos_error"] for row in rows),
        "exact_max_qpos_error": max(row["exact_max_qpos_error"] for row in rows),
        "exact_steps_compared": sum(row["exact_steps"] for row in rows),
        "exact_held_steps": sum(row["held_steps"] for row in rows),
        "success_compared": sum(row["success_compared"] for row in rows),
        "success_mismatches": sum(row["success_mismatches"] for row in rows),
    }


SIMULATOR = Protocol(
    name="simulator",
    help="control steps, set-up, grounding and agreement of the simulator, beside the native environment",
    seeds=(0,),
    trials=trials,
    run=run,
    metrics=metrics,
    alone=alone,
    timed=frozenset({"timing"}),
    of_processor=frozenset({"parity_max_qpos_error"}),  # the native environment multiplies matrices by BLAS
)
