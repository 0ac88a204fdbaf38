"""A bar on standard error for checks that take long: from the third second on, and only where a person looks on."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from threading import Lock, Timer
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from rich.progress import Progress

__all__ = ["Step", "progress", "silent"]

Step = Callable[[str, int, int], None]
"""What is done now, how many parts are done, and how many there are."""
_PATIENCE = 2.0


def silent(doing: str, done: int, parts: int) -> None:
    """Show nothing."""


@dataclass
class _Bar:
    stream: TextIO
    state: tuple[str, int, int | None] = ("checking", 0, None)
    bar: Progress | None = None
    lock: Lock = field(default_factory=Lock)
    over: bool = False

    def step(self, doing: str, done: int, parts: int) -> None:
        with self.lock:
            self.state = (doing, done, parts)
            self._update()

    def start(self) -> None:
        from rich.console import Console  # noqa: PLC0415 - most checks end before
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn  # noqa: PLC0415

        with self.lock:
            if not self.over:
                columns = (BarColumn(), TimeElapsedColumn(), TextColumn("{task.description}"))
                self.bar = Progress(*columns, console=Console(file=self.stream), transient=True)
                self.bar.add_task("", total=None)
                self._update()
                self.bar.start()

    def stop(self) -> None:
        with self.lock:
            self.over = True
            if self.bar is not None:
                self.bar.stop()

    def _update(self) -> None:
        if self.bar is not None:
            doing, done, parts = self.state
            self.bar.update(self.bar.task_ids[0], description=doing, completed=done, total=parts)


@contextmanager
def progress(stream: TextIO | None = None, patience: float = _PATIENCE) -> Iterator[Step]:
    """Yield what shows each step on ``stream``, after ``patience`` seconds; nothing where it is no terminal."""
    target = sys.stderr if stream is None else stream
    if not target.isatty():
        yield silent
        return
    bar = _Bar(target)
    timer = Timer(patience, bar.start)
    timer.daemon = True
    timer.start()
    try:
        yield bar.step
    finally:
        timer.cancel()
        bar.stop()
