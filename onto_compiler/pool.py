"""Spread a function over processes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from typing import TypeVar

from onto_compiler.problems import OntoError

__all__ = ["map_over_processes"]

Item = TypeVar("Item")
Result = TypeVar("Result")


def map_over_processes(
    function: Callable[[Item], Result], items: Sequence[Item], jobs: int
) -> Iterator[tuple[Item, Result]]:
    """Each of ``items`` with what the module-level ``function`` gives for it, as they are done.

    Raises ``DEM007`` where a process died; what was written until then is kept.
    """
    if jobs <= 1 or len(items) <= 1:
        yield from ((item, function(item)) for item in items)
        return
    # spawn: MuJoCo and Oxigraph hold threads, which a fork would cut in half.
    with ProcessPoolExecutor(max_workers=min(jobs, len(items)), mp_context=get_context("spawn")) as pool:
        pending = {pool.submit(function, item): item for item in items}
        try:
            for future in as_completed(pending):
                yield pending[future], future.result()
        except BrokenProcessPool as error:
            message = "a process died, out of memory perhaps"
            raise OntoError.of("DEM007", message, "run the same command again; it goes on where it stopped") from error
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
