"""Processes of their own for what a process that is warm cannot show: a cold start, memory, two at once.

``python -m benchmarks.simulator_processes COMMAND SUITE TASK ...`` prints one line of JSON. Commands that are timed
side by side print ``ready``, and go on when they read a line.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from benchmarks.memory import held_mib
from benchmarks.simulator_task import digest, made, random_actions, rolled_out
from runtime.loop.faults import RunFault

__all__ = ["in_process", "main", "together"]

Found = dict[str, Any]


def in_process(*command: str) -> Found:
    """What ``command`` prints in a fresh process, and ``wall_s`` from its start to that line."""
    started = time.perf_counter()
    process = _start(command)
    line = process.stdout.readline() if process.stdout else ""
    wall = time.perf_counter() - started
    _end(process)
    return {"wall_s": wall, **json.loads(line)}


def together(many: int, *command: str) -> list[Found]:
    """What ``command`` prints in each of ``many`` processes that begin their timed part at the same moment."""
    processes = [_start(command) for _ in range(many)]
    for process in processes:
        if process.stdout:
            process.stdout.readline()
    for process in processes:
        if process.stdin:
            process.stdin.write("go\n")
            process.stdin.flush()
    lines = [process.stdout.readline() if process.stdout else "" for process in processes]
    for process in processes:
        _end(process)
    return [json.loads(line) for line in lines]


def _start(command: tuple[str, ...]) -> subprocess.Popen[str]:
    return subprocess.Popen(  # noqa: S603 - this module, by this interpreter
        [sys.executable, "-m", "benchmarks.simulator_processes", *command],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def _end(process: subprocess.Popen[str]) -> None:
    process.communicate()
    if process.returncode:
        raise RuntimeError(f"a measuring process ended with {process.returncode}")


def _first_step(suite: str, task: str) -> Found:
    simulation, states = made(suite, int(task))
    simulation.reset_to(states[0])
    simulation.step(np.zeros(7))
    return {"digest": digest(simulation)}


def _digest(suite: str, task: str, actions: str) -> Found:
    return {"digest": rolled_out(suite, int(task), int(actions))}


def _loop(suite: str, task: str, steps: str) -> Found:
    simulation, states = made(suite, int(task))
    actions = random_actions(int(steps))
    simulation.reset_to(states[0])
    simulation.rollout(actions[:20])
    _wait()
    started = time.perf_counter()
    for first in range(0, len(actions), 100):
        simulation.reset_to(states[0])
        simulation.rollout(actions[first : first + 100])
    return {"wall_s": time.perf_counter() - started}


def _physics(suite: str, task: str, steps: str) -> Found:
    import mujoco  # noqa: PLC0415 - here, so that a cold start shows what its own commands import

    simulation, states = made(suite, int(task))
    simulation.reset_to(states[0])
    simulation.rollout(random_actions(20))
    model, data, substeps = simulation.model, simulation.data, simulation.scene.substeps
    saved = simulation.snapshot()
    _wait()
    started = time.perf_counter()
    for first in range(0, int(steps), 100):
        simulation.restore(saved)
        for _ in range(min(100, int(steps) - first)):
            mujoco.mj_step(model, data, substeps)
    return {"wall_s": time.perf_counter() - started}


def _memory(suite: str, task: str, resets: str, steps: str) -> Found:
    simulation, states = made(suite, int(task))
    each = int(steps) // int(resets)
    actions = random_actions(each)
    faults, before, number = 0, 0.0, 0
    started = time.perf_counter()
    for number in range(1, int(resets) + 1):
        simulation.reset_to(states[number % len(states)])
        try:
            simulation.rollout(actions)
        except RunFault:
            faults += 1
        if number == max(1, int(resets) // 10):
            before = held_mib()
    return {
        "digest": digest(simulation),
        "resets": number,
        "steps": number * each,
        "faults": faults,
        "before_mib": before,
        "after_mib": held_mib(),
        "wall_s": time.perf_counter() - started,
    }


def _wait() -> None:
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    sys.stdin.readline()


_COMMANDS: Mapping[str, Callable[..., Found]] = {
    "first-step": _first_step,
    "digest": _digest,
    "loop": _loop,
    "physics": _physics,
    "memory": _memory,
}


def main(arguments: list[str]) -> None:
    """Run one command."""
    name, *given = arguments
    sys.stdout.write(json.dumps(_COMMANDS[name](*given)) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
