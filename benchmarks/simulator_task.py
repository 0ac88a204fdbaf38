"""One task's figures: loops beside the native environment on the same actions, and what they agree on."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks.protocol import Row
from runtime.worlds.libero.simulator.assets import find_task, initial_states
from runtime.worlds.libero.simulator.compiled import compile_scene
from runtime.worlds.libero.simulator.simulation import Simulation
from runtime.worlds.native_import import quiet
from runtime.worlds.snapshot import FULL, Snapshot

if TYPE_CHECKING:
    from benchmarks.simulator_goal import NativeGoal
    from runtime.worlds.libero.simulator.native import NativeTask

__all__ = ["digest", "made", "measure_task", "random_actions", "rolled_out"]

SEED = 0
STATE = 0  # the official initial state that everything starts from
SETTLE = 10
EVERY = 10  # control steps between two states in which facts are grounded

Floats = NDArray[np.float64]


def made(suite: str, task: int, *, exact: bool = False) -> tuple[Simulation, Floats]:
    """A simulation of the task's cached scene, and the official initial states."""
    ref = find_task(suite, task)
    return Simulation(compile_scene(ref.bddl, SEED), exact=exact), initial_states(ref)


def random_actions(many: int) -> Floats:
    """Uniform OSC_POSE actions (many, 7), always the same."""
    return np.random.default_rng(SEED).uniform(-1.0, 1.0, (many, 7))


def digest(simulation: Simulation) -> str:
    """A SHA-256 over the whole present state."""
    saved = simulation.snapshot()
    total = hashlib.sha256(saved.integration.tobytes() + saved.body_pos.tobytes() + saved.body_quat.tobytes())
    total.update(saved.gripper_action.tobytes())
    return total.hexdigest()


def rolled_out(suite: str, task: int, many: int) -> str:
    """The digest after ``many`` random actions from a settled initial state."""
    simulation, states = made(suite, task)
    simulation.reset_to(states[STATE])
    simulation.settle(SETTLE)
    simulation.rollout(random_actions(many))
    return digest(simulation)


def measure_task(suite: str, task: int, many: int, rounds: int, resets: int) -> Row:
    """The task's row: see :mod:`benchmarks.simulator`. ``many`` random actions, timed in ``rounds`` turns."""
    from benchmarks.simulator_goal import NativeGoal  # noqa: PLC0415 - a cold start does not ground
    from benchmarks.simulator_grasp import grasp_actions  # noqa: PLC0415 - nor grasp
    from runtime.worlds.libero.simulator.native import NativeTask  # noqa: PLC0415 - LIBERO takes a second to import

    ref = find_task(suite, task)
    compiled, states = made(suite, task)
    exact, _ = made(suite, task, exact=True)
    random = random_actions(many)
    with NativeTask.open(ref, SEED) as native:
        goal = NativeGoal(ref, native)
        actions, held = grasp_actions(exact, states[STATE], goal.movable)
        actions = np.vstack([actions, random])
        native_path, mismatches, visited = _native_path(native, goal, states[STATE], actions)
        row = {
            "parity_max_qpos_error": _error(native, compiled, states[STATE], random),
            "exact_max_qpos_error": float(np.abs(_path(exact, states[STATE], actions) - native_path).max()),
            "exact_steps": len(actions),
            "held_steps": held,
            "success_compared": len(visited),
            "success_mismatches": mismatches,
            "digest": digest(compiled),
        }
        timing = _rates(native, compiled, exact, states[STATE], random, rounds)
        timing["setup_ms"] = 1e3 * float(np.median([_wall(partial(compiled.reset_to, s)) for s in states]))
        timing |= goal.microseconds(native, visited)
        # Last, since LIBERO's reset places the fixtures again.
        timing["native_setup_ms"] = 1e3 * float(
            np.median([_wall(partial(native.reset_as_evaluations_do, states[STATE])) for _ in range(resets)])
        )
    return {**row, "timing": timing}


def _path(simulation: Simulation, state: Floats, actions: Floats) -> Floats:
    """``qpos`` after every action, shape (n, nq)."""
    simulation.reset_to(state)
    path = []
    for action in actions:
        simulation.step(action)
        path.append(simulation.data.qpos.copy())
    return np.array(path)


def _native_path(
    native: NativeTask, goal: NativeGoal, state: Floats, actions: Floats
) -> tuple[Floats, int, list[Snapshot]]:
    """``qpos`` after every action; how often our verdict differs from the native one; and some states on the way."""
    native.reset_to(state)
    path, visited, mismatches = [], [], 0
    for step, action in enumerate(actions):
        native.step(action)
        path.append(native.data.qpos.copy())
        if step % EVERY == 0:
            visited.append(native.snapshot())
            mismatches += goal.holds(native) != native.success()
    return np.array(path), mismatches, visited


def _error(native: NativeTask, compiled: Simulation, state: Floats, actions: Floats) -> float:
    """The largest difference in ``qpos`` between the native environment and the compiled loop."""
    native.reset_to(state)
    path = []
    for action in actions:
        native.step(action)
        path.append(native.data.qpos.copy())
    return float(np.abs(_path(compiled, state, actions) - np.array(path)).max())


def _rates(
    native: NativeTask, compiled: Simulation, exact: Simulation, state: Floats, actions: Floats, rounds: int
) -> dict[str, float]:
    """Control steps a second of processor time, each the median of ``rounds`` that take turns."""
    found: dict[str, list[float]] = {name: [] for name in ("compiled", "exact", "native", "physics")}
    bare = _visited(compiled, state, actions)

    def native_rollout() -> None:
        for action in actions:
            native.env.step(action)

    for _ in range(rounds):
        for name, simulation in (("compiled", compiled), ("exact", exact)):
            simulation.reset_to(state)
            simulation.settle(SETTLE)
            found[name].append(_seconds(partial(simulation.rollout, actions)))
        native.reset_to(state)
        native.settle(SETTLE)
        with quiet():
            found["native"].append(_seconds(native_rollout))
        found["physics"].append(_bare(compiled, bare))
    return {f"{name}_steps_s": len(actions) / float(np.median(seconds)) for name, seconds in found.items()}


def _visited(simulation: Simulation, state: Floats, actions: Floats) -> list[tuple[Floats, Floats]]:
    """Before every control step the whole state of MuJoCo, and the controls at its end."""
    simulation.reset_to(state)
    simulation.settle(SETTLE)
    found = []
    for action in actions:
        before = simulation.snapshot().integration
        simulation.step(action)
        found.append((before, simulation.data.ctrl.copy()))
    return found


def _bare(simulation: Simulation, visited: Sequence[tuple[Floats, Floats]]) -> float:
    """Seconds that MuJoCo alone takes for a control step from each of the states; writing them is not counted."""
    model, data, substeps = simulation.model, simulation.data, simulation.scene.substeps
    total = 0.0
    for state, torques in visited:
        mujoco.mj_setState(model, data, state, FULL)
        data.ctrl[:] = torques
        total += _seconds(partial(mujoco.mj_step, model, data, substeps))
    return total


def _seconds(call: Callable[[], object]) -> float:
    """Processor time of this thread."""
    started = time.thread_time()
    call()
    return time.thread_time() - started


def _wall(call: Callable[[], object]) -> float:
    started = time.perf_counter()
    call()
    return time.perf_counter() - started
