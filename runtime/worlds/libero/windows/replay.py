"""Execute a window again: from LIBERO's flat state, with some or none of the parts restored that it leaves out."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from runtime.loop.faults import RunFault
from runtime.worlds.fixtures import FixturePoses
from runtime.worlds.libero.demos.records import Demonstration, lacking
from runtime.worlds.libero.windows.scene import WindowScene
from runtime.worlds.libero.windows.window import LENGTH, Window
from runtime.worlds.snapshot import Snapshot

__all__ = [
    "CONTROLLER",
    "FIXTURES",
    "GRIPPER",
    "PARTS",
    "WindowResult",
    "recorded_state",
    "replay_recorded",
    "replay_window",
]

CONTROLLER, GRIPPER, FIXTURES = "controller", "gripper", "fixtures"
PARTS = (CONTROLLER, GRIPPER, FIXTURES)
"""What the flat state leaves out: the controller's goal and freshness, the gripper's current action, the fixtures."""


@dataclass(frozen=True, slots=True, eq=False)
class WindowResult:
    """The replay of ``window``.

    ``success`` is LIBERO's verdict at its end, after a forward pass; ``truth`` (25, k) says which facts of the goal
    hold after each action, and ``final`` is the whole state at the end. Where the state ``diverged``, the window has
    failed, ``final`` is the last good state, and nothing counts as true from there on.
    """

    window: Window
    success: bool
    truth: NDArray[np.bool_]
    final: Snapshot
    diverged: bool = False

    @property
    def true_at_any_step(self) -> bool:
        """Whether all facts hold after one of the actions, or more."""
        return bool(self.truth.all(axis=1).any())


def replay_window(scene: WindowScene, window: Window, restored: Collection[str] = ()) -> WindowResult:
    """Execute ``window`` from LIBERO's flat state with the fixtures of its seed.

    ``restored`` are those of :data:`PARTS` that are as they were recorded instead.

    Raises:
        OntoError: ``DEM008`` if the window is not of the scene's file; ``DEM007`` if parts are to be restored that
            are not recorded; ``SIM003``, ``SIM004`` for a state that is not of this scene.
    """
    if unknown := sorted(set(restored) - set(PARTS)):
        raise ValueError(f"there is no part `{unknown[0]}` of a state, only {', '.join(PARTS)}")
    demo, home, simulation = scene.demonstration(window), scene.home(window.fixtures_seed), scene.simulation
    recorded = recorded_state(scene, demo, window.start) if restored else None
    if recorded is not None and FIXTURES in restored:
        home = home.placed(FixturePoses(recorded.body_pos, recorded.body_quat))
    simulation.reset_from(home, demo.states[window.start])
    if recorded is not None:
        state = simulation.snapshot()
        if CONTROLLER in restored:
            state = replace(state, controller=recorded.controller)
        if GRIPPER in restored:
            state = replace(state, gripper_action=recorded.gripper_action)
        simulation.restore(state)
    return _execute(scene, window, demo)


def replay_recorded(scene: WindowScene, window: Window) -> WindowResult:
    """Execute ``window`` from the whole recorded state: as it was. Raises as :func:`replay_window`."""
    demo = scene.demonstration(window)
    scene.simulation.restore(recorded_state(scene, demo, window.start))
    return _execute(scene, window, demo)


def recorded_state(scene: WindowScene, demo: Demonstration, step: int) -> Snapshot:
    """The recorded state before ``step``; raises ``DEM007``, naming the file, if it is not recorded."""
    if demo.hidden is None:
        raise lacking(demo, "hidden state", ", so that nothing says why a window of it fails", scene.file.path)
    return demo.snapshot(step)


def _execute(scene: WindowScene, window: Window, demo: Demonstration) -> WindowResult:
    simulation = scene.simulation
    truth = np.zeros((LENGTH, len(scene.required.facts)), dtype=np.bool_)
    try:
        for row, action in zip(truth, demo.actions[window.start : window.stop], strict=True):
            simulation.step(action)
            row[:] = scene.holds(simulation.data)
    except RunFault:
        return WindowResult(window, False, truth, simulation.snapshot(), diverged=True)
    final = simulation.snapshot()
    return WindowResult(window, scene.success(final), truth, final)
