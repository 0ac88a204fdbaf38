"""Why a window fails: what of the recorded state has to be restored for it to succeed."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

from runtime.worlds.libero.demos.records import lacking
from runtime.worlds.libero.windows.replay import PARTS, recorded_state, replay_recorded, replay_window
from runtime.worlds.libero.windows.scene import WindowScene
from runtime.worlds.libero.windows.window import Window

__all__ = ["FailureLabel", "label"]


@dataclass(frozen=True, slots=True)
class FailureLabel:
    """Why the replay of ``window`` from LIBERO's flat state fails.

    ``rescues`` are the smallest sets of parts whose restoration makes it succeed: if single parts do, all that do, or
    else all pairs, or else all three. It is empty if none does. ``whole``: it succeeds from the whole recorded state,
    which also holds the warm start. ``recorded``: the goal was true at the window's end when it was recorded.
    """

    window: Window
    rescues: tuple[tuple[str, ...], ...]
    whole: bool
    recorded: bool

    @property
    def faulty(self) -> bool:
        """Whether the whole state did not repeat what was recorded: the replay is at fault, and not the flat state."""
        return self.whole != self.recorded

    def __str__(self) -> str:
        if self.rescues:
            return " or ".join(" and ".join(parts) for parts in self.rescues)
        if self.faulty:
            return "the whole recorded state does not repeat the recording"
        return "warm start or contact drift" if self.whole else "not true when it was recorded"


def label(scene: WindowScene, window: Window) -> FailureLabel:
    """Say why ``window``, whose replay fails, does so. Some eight replays.

    Raises:
        OntoError: ``DEM007`` if its demonstration keeps no hidden states, and as
            :func:`~runtime.worlds.libero.windows.replay.replay_window`.
    """
    demo = scene.demonstration(window)
    recorded_state(scene, demo, window.start)
    if demo.truth is None:
        raise lacking(demo, "truth", file=scene.file.path)
    recorded = bool(demo.truth[window.stop - 1].all())
    whole = replay_recorded(scene, window).success
    rescues: tuple[tuple[str, ...], ...] = ()
    for size in range(1, len(PARTS) + 1):
        tried = combinations(PARTS, size)
        rescues = tuple(parts for parts in tried if replay_window(scene, window, parts).success)
        if rescues:
            break
    return FailureLabel(window, rescues, whole, recorded)
