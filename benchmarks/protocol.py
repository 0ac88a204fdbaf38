"""What a protocol is: trials, how one is run, and the metrics that its rows give."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any

from onto_compiler.problems import OntoError, near

__all__ = [
    "GROUP",
    "Protocol",
    "Row",
    "Trial",
    "alone",
    "load_protocols",
    "protocol_named",
    "registered_protocols",
    "untimed",
]

GROUP = "onto_evwm.protocols"
Row = dict[str, Any]
Trial = Mapping[str, Any]  # must be picklable, and its ``key`` unique within the protocol


def _together(_trial: Trial) -> bool:
    """What most trials are: none of them minds the others."""
    return False


def alone(_trial: Trial) -> bool:
    """What each trial of a protocol is that times everything it runs."""
    return True


@dataclass(frozen=True, slots=True)
class Protocol:
    """``trials(full)`` lists what to run; ``run`` runs one in a worker process; ``metrics`` is a pure function of rows.

    ``run`` is called by name in a fresh process, so it is a module-level function; most trials give one row. Each row
    holds its ``mode`` (``none``, ``state`` or ``controller``) and what it ``sees``; the engine adds the trial to it.
    Trials that are timed run ``alone``: in this process, one after another, when all others are done, however many
    processes there might be. ``parts`` names the field of a trial by whose values the protocol can be run part by part
    (``onto bench NAME --part VALUE``). ``arms`` names the field that says which of the compared methods a trial is of:
    a sample of the published rows takes them in turn. ``timed`` names the fields of a row that differ from run to run:
    times and memory. ``of_tree`` names those that follow from this tree's own ontology and examples, which the trials
    take as their input: another commit has others. ``of_processor`` names those whose last digits depend on the
    processor, for which a numerical library or a driver that draws chooses its code. ``result`` is the name of the
    published file, if not the protocol's. ``of_folder`` lists the trials instead, where they need a folder that a
    person names (``onto bench NAME FOLDER``); such a protocol is neither part of ``all`` nor replayed.
    """

    name: str
    help: str
    seeds: tuple[int, ...]
    trials: Callable[[bool], Sequence[Trial]]
    run: Callable[[Trial], Sequence[Row]]
    metrics: Callable[[Sequence[Row]], Mapping[str, float]]
    alone: Callable[[Trial], bool] = _together
    parts: str = ""
    arms: str = ""
    timed: frozenset[str] = frozenset()
    of_tree: frozenset[str] = frozenset()
    of_processor: frozenset[str] = frozenset()
    result: str = ""
    of_folder: Callable[[Path], Sequence[Trial]] | None = None

    @property
    def file(self) -> str:
        """Name of the file that is published, without its folder."""
        return f"{self.result or self.name}.json"


def untimed(protocol: Protocol, rows: Sequence[Row]) -> list[Row]:
    """``rows`` without what was timed: what two runs of the same trials have to agree on."""
    left_out = {*protocol.timed, "seconds"}
    return [{name: value for name, value in row.items() if name not in left_out} for row in rows]


def registered_protocols() -> dict[str, EntryPoint]:
    """The entry point of every protocol by name, none of them imported yet; in alphabetical order."""
    return {point.name: point for point in sorted(entry_points(group=GROUP), key=lambda point: point.name)}


def load_protocols() -> dict[str, Protocol]:
    """Every registered protocol by name, in the order of their names."""
    return {name: point.load() for name, point in registered_protocols().items()}


def protocol_named(name: str) -> Protocol:
    """The protocol called ``name``.

    Raises:
        OntoError: BEN001 if none is called so.
    """
    known = registered_protocols()
    if name not in known:
        raise OntoError.of(
            "BEN001",
            f"`{name}` is no protocol",
            near(name, known) or f"one of: {', '.join(known) or 'none is installed'}",
        )
    protocol: Protocol = known[name].load()
    return protocol
