"""The records of an audit: tasks, their initial states, readings and typed failures."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from onto_compiler.atomic import replacing
from onto_compiler.problems import OntoError

__all__ = ["FORMAT", "Audit", "Failure", "Fault", "StateAudit", "TaskAudit", "read_audit", "task_of", "write_audit"]

FORMAT = "onto-audit-1"
Readings = Mapping[str, Mapping[str, float | None]]


@dataclass(frozen=True, slots=True)
class Failure:
    """One premise failure. ``margin`` is negative, in ``unit``; None if the predicate defines none.

    ``failure`` is the diagnosed class of an unmet fact, ``limit`` the term that decided it.
    """

    kind: str
    subject: str
    margin: float | None
    unit: str
    failure: str = ""
    limit: str = ""


@dataclass(frozen=True, slots=True)
class Fault:
    """Why a task or state could not be audited, or a fact not be grounded: code, message and hint of a problem."""

    code: str
    message: str
    hint: str = ""


@dataclass(frozen=True, slots=True)
class StateAudit:
    """``readings`` by measure and subject; magnitudes of zero are left out, and None is an undefined margin."""

    state: int
    failures: tuple[Failure, ...] = ()
    readings: Readings = field(default_factory=dict)
    faults: tuple[Fault, ...] = ()


@dataclass(frozen=True, slots=True)
class TaskAudit:
    """``available`` counts the initial states that there are.

    ``official`` is False if the suite ships none; the seeded reset is then the only one.
    """

    suite: str
    index: int
    name: str
    official: bool
    available: int
    states: tuple[StateAudit, ...]
    faults: tuple[Fault, ...] = ()

    @property
    def label(self) -> str:
        """``SUITE/INDEX``, or the name of a task of no suite."""
        return f"{self.suite}/{self.index}" if self.suite else self.name


@dataclass(frozen=True, slots=True)
class Audit:
    """Tasks under one simulator. ``kinds`` says, by name, what each kind of failure measures and tolerates."""

    versions: Mapping[str, str]
    seed: int
    kinds: Mapping[str, Mapping[str, Any]]
    tasks: tuple[TaskAudit, ...]

    @property
    def clean(self) -> bool:
        """Whether nothing at all was found."""
        return not any(True for _ in self.found())

    def found(self) -> Iterator[Failure | Fault]:
        """Every failure and fault."""
        for task in self.tasks:
            yield from task.faults
            for state in task.states:
                yield from state.faults
                yield from state.failures

    def as_dict(self) -> dict[str, Any]:
        """The record as JSON has it."""
        return {"format": FORMAT, **asdict(self)}


def write_audit(path: Path, audit: Audit) -> None:
    """Write ``audit`` to ``path``, whole or not at all; raises ``RUN023`` if that cannot be."""
    try:
        with replacing(path) as partial:
            partial.write_text(json.dumps(audit.as_dict(), allow_nan=False) + "\n", encoding="utf-8")
    except OSError as error:
        raise OntoError.of("RUN023", f"cannot write `{path}`: {error.strerror}", "choose another --out") from error


def read_audit(path: Path) -> Audit:
    """The audit that :func:`write_audit` wrote; raises ``RUN022`` if ``path`` holds none."""
    try:
        return _audit_of(json.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise OntoError.of("RUN022", f"cannot read `{path}`: {error.strerror}", _HINT, str(path)) from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise OntoError.of("RUN022", f"`{path.name}` is not a record of `onto audit`", _HINT, str(path)) from error


def _audit_of(record: dict[str, Any]) -> Audit:
    if record.pop("format") != FORMAT:
        raise ValueError("a record of another format")
    return Audit(**{**record, "tasks": tuple(task_of(task) for task in record["tasks"])})


_HINT = "record one with `onto audit --out FILE`"


def task_of(record: Mapping[str, Any]) -> TaskAudit:
    """A task's audit from its JSON; raises ``KeyError`` or ``TypeError`` where it is none."""
    states = tuple(
        StateAudit(
            state=int(one["state"]),
            failures=tuple(Failure(**failure) for failure in one["failures"]),
            readings=one["readings"],
            faults=tuple(Fault(**fault) for fault in one["faults"]),
        )
        for one in record["states"]
    )
    faults = tuple(Fault(**fault) for fault in record["faults"])
    return TaskAudit(**{**record, "states": states, "faults": faults})
