"""The protocol of a world, which is the tasks of one simulator, and the worlds that are installed.

A world is an entry point of the group ``onto_evwm.worlds``. Nothing here imports a simulator: a world is loaded to list
its suites, its simulator only when a task is opened. A world that cannot be loaded does not affect the others.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from onto_compiler.bddl.parse import parse_file
from onto_compiler.problems import OntoError, near

if TYPE_CHECKING:
    from onto_compiler.required import RequiredABox
    from onto_compiler.schema import Schema
    from runtime.loop.proposer import Proposer
    from runtime.worlds.environment import TaskEnvironment

__all__ = [
    "ANY_DOMAIN",
    "GROUP",
    "TaskRef",
    "World",
    "find_task",
    "named_task",
    "suites",
    "task_named",
    "world_named",
    "world_of",
]

GROUP = "onto_evwm.worlds"
ANY_DOMAIN = "*"


@dataclass(frozen=True, slots=True)
class TaskRef:
    """One task: ``index`` counts from 0 in the suite's official order; ``suite`` is empty for your own task file.

    ``initial_states`` is the file of official initial states, where the suite ships one.
    """

    suite: str
    index: int
    name: str
    bddl: Path
    initial_states: Path = Path()


class World(Protocol):
    """The tasks of one simulator."""

    name: str
    """The name of its entry point."""
    title: str
    """Its name in text."""
    level: str
    """The level at which its failures are corrected: ``state``, or ``plan`` for a world with planners."""
    domains: Sequence[str]
    """The BDDL domains of its task files; :data:`ANY_DOMAIN` for domains that no world names."""

    def suites(self) -> Sequence[str]:
        """Its suites, in their official order; raises ``SIM010`` if the simulator is not installed."""
        ...

    def tasks(self, suite: str) -> Sequence[TaskRef]:
        """The tasks of one of its suites, in their official order."""
        ...

    def initial_states(self, ref: TaskRef) -> int:
        """How many initial states a task has; they are numbered from 0."""
        ...

    def horizon(self, ref: TaskRef) -> int:
        """Control steps that an episode may take."""
        ...

    def prepare(self, ref: TaskRef, imports: Sequence[str]) -> None:
        """Import the user's modules that register what the task needs; raises ``SIM024``."""
        ...

    def open(self, ref: TaskRef, required: RequiredABox, schema: Schema, seed: int) -> TaskEnvironment:
        """Build the scene of a task, judged by the simulator's own success; raises ``SIM`` problems.

        ``seed`` determines what an initial state does not.
        """
        ...

    def proposers(self, schema: Schema, chosen: Mapping[str, str] | None = None) -> Mapping[str, Proposer]:
        """The proposers of states, by the notation of their route; ``chosen`` has names by route.

        Raises ``RUN010``, and ``RUN005``, ``RUN006`` or ``RUN008`` if the choice is not clear.
        """
        ...

    def skills(self, schema: Schema) -> Mapping[str, Any]:
        """The skills by the local name of their route; empty if the world has none. Raises ``RUN011``."""
        ...


def named_task(text: str) -> tuple[World, TaskRef]:
    """The task that ``text`` names, ``SUITE/INDEX``, ``SUITE/NAME`` or the path of a task file, and its world.

    Raises:
        OntoError: ``CLI004`` for a text of neither form, ``SIM011`` for an unknown suite, ``SIM012`` for an unknown
            task, ``RUN015`` if the world that is asked for cannot be loaded.
    """
    ref = task_named(text, suites, lambda suite: world_of(suite).tasks(suite))
    return (world_of(ref.suite) if ref.suite else _world_of_file(ref.bddl)), ref


def task_named(text: str, known: Callable[[], Sequence[str]], tasks: Callable[[str], Sequence[TaskRef]]) -> TaskRef:
    """The task that ``text`` names among the suites ``known`` and their ``tasks``; raises as :func:`named_task`."""
    path = Path(text)
    if path.suffix == ".bddl":
        # Only official tasks have official initial states; any other starts from a seeded reset.
        return TaskRef("", 0, path.stem, path)
    suite, slash, name = text.partition("/")
    if not slash or not name or path.parent.suffix == ".bddl":
        if suite in known():
            hint = f"`{suite}` is a suite of {len(tasks(suite))} tasks: write {suite}/0 for the first"
        else:
            hint = near(suite, known()) or "write SUITE/INDEX, such as libero_goal/8, or the path of a task file"
        raise OntoError.of("CLI004", f"`{text}` names no task", hint)
    return find_task(suite, tasks(suite), int(name) if name.isdigit() else name)


def find_task(suite: str, tasks: Sequence[TaskRef], task: int | str) -> TaskRef:
    """That of the ``tasks`` of ``suite`` with an index or a name; raises ``SIM012``."""
    for ref in tasks:
        if task in (ref.index, ref.name):
            return ref
    hint = near(task, [r.name for r in tasks]) if isinstance(task, str) else ""
    hint = hint or f"it has {len(tasks)} tasks, from 0"
    raise OntoError.of("SIM012", f"suite `{suite}` has no task `{task}`", hint)


def suites() -> tuple[str, ...]:
    """The suites of every world that can be loaded, world by world."""
    return tuple(suite for name in _installed() for suite in _suites_of(name))


def world_of(suite: str) -> World:
    """The world that has ``suite``.

    Raises:
        OntoError: ``SIM011``, which lists the known suites; ``RUN015`` or ``SIM010`` if the suite is named like a
        world that cannot be loaded or whose simulator is not installed.
    """
    for name in _installed():
        if suite in _suites_of(name):
            return world_named(name)
    for name in _installed():
        if suite == name or suite.startswith(f"{name}_"):
            world_named(name).suites()
    hint = "; ".join(filter(None, (near(suite, suites()), *map(_listed, _installed()))))
    raise OntoError.of("SIM011", f"no world has a suite `{suite}`", hint)


def _world_of_file(path: Path) -> World:
    """The world whose domain the task file at ``path`` names."""
    try:
        domain = parse_file(path).domain.lower()
    except OntoError:
        domain = ANY_DOMAIN  # opening the task reports what is wrong
    worlds: list[World] = []
    for name in _installed():
        with suppress(OntoError):  # another world may play it
            worlds.append(world_named(name))
    for wanted in (domain, ANY_DOMAIN):
        for world in worlds:
            if wanted in world.domains:
                return world
    hint = "; ".join(map(_listed, _installed())) or "install one"
    raise OntoError.of("SIM011", f"no world has tasks of the domain `{domain}`", hint, str(path))


def _suites_of(name: str) -> Sequence[str]:
    """The suites of a world; none where it cannot be loaded, or lacks its simulator."""
    try:
        return world_named(name).suites()
    except OntoError:
        return ()


def _listed(name: str) -> str:
    """A world with its suites, or with the reason why they cannot be listed."""
    try:
        return f"{name}: {', '.join(world_named(name).suites())}"
    except OntoError as error:
        return f"{name}: {'; '.join(problem.message for problem in error.problems)}"


@cache
def _installed() -> tuple[str, ...]:
    return tuple(sorted(entry.name for entry in entry_points(group=GROUP)))


@cache
def world_named(name: str) -> World:
    """The world registered as ``name``; raises ``RUN015`` with the reason where it cannot be loaded."""
    (entry, *_) = (entry for entry in entry_points(group=GROUP) if entry.name == name)
    try:
        world: World = entry.load()
    except Exception as error:  # whatever another package's import raises, the other worlds work
        message = f"the world `{name}` cannot be loaded from `{entry.value}`: {type(error).__name__}: {error}"
        raise OntoError.of("RUN015", message, "install what it needs, or the package that declares it") from error
    return world
