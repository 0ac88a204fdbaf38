"""Whether the first task of every other installed suite can be built, set and grounded: LIBERO-PRO's, above all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from benchmarks import audit
from benchmarks.protocol import Protocol, Row, Trial
from runtime.worlds.libero.audit.command import LIBERO
from runtime.worlds.libero.simulator.assets import suites

__all__ = ["AUDIT_SUITES"]

SMALL = 3  # suites


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """The first task of each suite, in its first initial state."""
    others = [suite for suite in suites() if suite not in LIBERO]
    return [{"key": suite, "suite": suite, "task": 0, "states": 1} for suite in (others if full else others[:SMALL])]


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """As the audit's, and in how many suites the task was audited without a fault."""
    whole = [row for row in rows if "crashed" not in row]
    odd = {row["suite"] for row in whole if row["faults"]}
    return {
        "suites": len({row["suite"] for row in rows}),
        "audited_suites": len({row["suite"] for row in whole if row["state"] is not None} - odd),
        "official_suites": len({row["suite"] for row in whole if row["official"]}),
        **{name: value for name, value in audit.metrics(rows).items() if not name.startswith("libero")},
    }


AUDIT_SUITES = Protocol(
    name="audit_suites",
    help="whether a task of every other installed suite can be built, set and grounded",
    seeds=audit.AUDIT.seeds,
    trials=trials,
    run=audit.run,
    metrics=metrics,
)
