"""Apply a function to many items in several processes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from typing import TypeVar

from onto_compiler.problems import OntoError

__all__ = ["WorkerDiedError", "map_over_processes"]

Item = TypeVar("Item")
Result = TypeVar("Result")


class WorkerDiedError(OntoError):
    """A process ended before its function did, and with it the processes beside it; the code is ``CLI007``."""


def map_over_processes(
    function: Callable[[Item], Result], items: Sequence[Item], jobs: int, *, apart: bool = False
) -> Iterator[tuple[Item, Result]]:
    """Each of ``items`` with what the module-level ``function`` gives for it, in the order in which they finish.

    Where one process is enough it is this one, unless ``function`` must run ``apart``: in a process of its own, whose
    death this one survives. Items that have not begun when the caller stops are dropped.

    Raises:
        WorkerDiedError: if a process was killed, for example out of memory; results yielded before are valid.
    """
    if not items:
        return
    workers = min(jobs, len(items))
    if workers <= 1 and not apart:
        yield from ((item, function(item)) for item in items)
        return
    # spawn: MuJoCo and Oxigraph hold threads, which a fork would cut in half.
    with ProcessPoolExecutor(max(workers, 1), mp_context=get_context("spawn")) as pool:
        try:
            pending = {pool.submit(function, item): item for item in items}
            for future in as_completed(pending):
                yield pending[future], future.result()
        except BrokenProcessPool as error:
            message = "a worker process was ended from outside, perhaps for want of memory"
            hint = "run the command again with fewer processes (--jobs)"
            raise WorkerDiedError.of("CLI007", message, hint) from error
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
