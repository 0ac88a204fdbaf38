"""The task of an environment, and the horizon of its episodes."""

from __future__ import annotations

from collections.abc import Mapping

from onto_compiler.problems import OntoError
from runtime.worlds.libero.simulator.assets import TaskRef, find_task, named_task

__all__ = ["HORIZONS", "chosen_task", "horizon_of"]

HORIZONS: Mapping[str, int] = {
    "libero_spatial": 220,
    "libero_object": 280,
    "libero_goal": 300,
    "libero_10": 520,
    "libero_90": 400,
}
"""Control steps of an episode by suite, as in published evaluations; derived suites use that of their original."""
_OTHER = 600  # LIBERO's own ``max_steps`` (``libero/configs/eval/default.yaml``)


def chosen_task(task: str | None, suite: str | None, index: int | str | None) -> TaskRef:
    """The task that either ``task`` names (``SUITE/INDEX``, ``SUITE/NAME``, a path) or ``suite`` and ``index``.

    Raises ``SIM030`` unless exactly one of the two is given, and otherwise as
    :func:`~runtime.worlds.libero.simulator.assets.named_task`.
    """
    if (task is None) == (suite is None) or (suite is None) != (index is None):
        raise OntoError.of(
            "SIM030",
            "an environment is of one task",
            'give task="libero_goal/8", or suite="libero_goal" with index=8 (or the task\'s name)',
        )
    if task is not None:
        return named_task(task)
    return find_task(str(suite), index if index is not None else "")


def horizon_of(suite: str) -> int:
    """Control steps of an episode, without those for settling."""
    fitting = [name for name in HORIZONS if suite == name or suite.startswith(f"{name}_")]
    return HORIZONS[max(fitting, key=len)] if fitting else _OTHER
