"""Which windows of the demonstrations are replayed: a pure function of the file and a seed.

The rules are those of docs/protocols/libero-goal.md.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from onto_compiler.problems import OntoError
from onto_compiler.wording import counted
from runtime.worlds.libero.demos.records import DemoFile, Demonstration, lacking

__all__ = [
    "COUNT",
    "DEMONSTRATIONS",
    "FIXTURE_SEEDS",
    "FOLDS",
    "LENGTH",
    "PUBLISHED",
    "RULES",
    "StartRule",
    "Window",
    "draw_windows",
]

LENGTH = 25
"""H, in control steps of 1/20 s."""
COUNT = 50
"""Windows of each task and sampling seed."""
DEMONSTRATIONS = 40
"""The first so many demonstrations of a file are used."""
FOLDS = 4
FIXTURE_SEEDS = (1, 2, 3, 4, 5)
"""Seeds of LIBERO's reset; demonstrations are recorded with the fixtures of seed 0."""

StartRule = Callable[[Demonstration], range]
"""The first steps that a window of a demonstration may have."""


@dataclass(frozen=True, slots=True, order=True)
class Window:
    """:data:`LENGTH` recorded actions of a demonstration, from step ``start`` (from 0) on.

    ``task`` is SUITE/NAME, ``demo`` the position in its file. The fixtures stand where a reset with ``fixtures_seed``
    puts them. A window of a ``fold`` is corrected by what was trained on the demonstrations of the other folds.
    """

    task: str
    demo: int
    start: int
    fixtures_seed: int
    sampling_seed: int
    fold: int

    @property
    def stop(self) -> int:
        """The number of actions of the demonstration up to the window's end."""
        return self.start + LENGTH


def _before_the_end(most: int, demo: Demonstration) -> range:
    """Windows that begin at most ``most`` steps before the end, and lie within the demonstration."""
    return range(max(0, len(demo) - most), len(demo) - LENGTH + 1)


def _holding_the_onset(demo: Demonstration) -> range:
    """Windows in which the task becomes true for good."""
    if demo.truth is None:
        raise lacking(demo, "truth")
    if demo.onset is None:
        return range(0)
    return range(max(0, demo.onset - LENGTH), min(demo.onset, len(demo) - LENGTH + 1))


PUBLISHED = "n-33..n-25"
RULES: Mapping[str, StartRule] = {
    PUBLISHED: partial(_before_the_end, 33),
    "n-37..n-25": partial(_before_the_end, 37),
    "n-30..n-25": partial(_before_the_end, 30),
    "holding the lasting onset": _holding_the_onset,
}
"""By name, the rule that the protocol publishes and those that it reports beside it; n counts the recorded steps."""


def draw_windows(
    file: DemoFile, sampling_seed: int, *, count: int = COUNT, rule: StartRule = RULES[PUBLISHED]
) -> tuple[Window, ...]:
    """``count`` windows of the first :data:`DEMONSTRATIONS` of ``file``, none of them twice, in the order of the file.

    Each pair of a demonstration and a start that ``rule`` allows is as likely as any other, and so is each of the
    fixtures' seeds.

    Raises:
        OntoError: ``DEM008`` if a demonstration is shorter than a window, or there are fewer windows than ``count``;
            ``DEM007`` if ``rule`` asks for a truth that is not recorded.
    """
    demos = file.demos[:DEMONSTRATIONS]
    for demo in demos:
        if len(demo) < LENGTH:
            message = f"`{demo.name}` has {counted(len(demo), 'step')}, and a window {LENGTH}"
            raise OntoError.of("DEM008", message, "leave it out, or collect others", file.path)
    allowed = [(number, start) for number, demo in enumerate(demos) for start in rule(demo)]
    if len(allowed) < count:
        has = f"{counted(len(demos), 'demonstration')} {'has' if len(demos) == 1 else 'have'}"
        message = f"{has} {counted(len(allowed), 'window')} by this rule, and {count} were asked for"
        raise OntoError.of("DEM008", message, "collect more demonstrations, or ask for fewer windows", file.path)
    task = f"{file.suite}/{file.task}"
    random = np.random.default_rng([sampling_seed, zlib.crc32(task.encode())])
    chosen = sorted(random.choice(len(allowed), size=count, replace=False).tolist())
    fixtures = random.choice(FIXTURE_SEEDS, size=count).tolist()
    return tuple(
        Window(task, demo, start, seed, sampling_seed, demo % FOLDS)
        for (demo, start), seed in zip((allowed[index] for index in chosen), fixtures, strict=True)
    )
