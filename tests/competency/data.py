"""Which made-up episodes stand in each question's ``data.trig``: some that its answer names, some that it must not."""

from __future__ import annotations

import csv
import io

from pyoxigraph import RdfFormat, Store

from runtime.trace.store import dump
from runtime.trace.write import episode_quads
from tests.runtime.trace import samples

DATA = {
    "disagreements": (samples.disagreement, samples.lost_after_settling, samples.unresolved),
    "execution-ends": (samples.played, samples.accepted),
    "failure-counts": (samples.accepted, samples.lost_after_settling, samples.negated, samples.disagreement),
    "lineage": (samples.accepted, samples.disagreement, samples.faulted),
    "margins-by-predicate": (samples.accepted, samples.unresolved, samples.faulted),
    "prediction-errors": (samples.planned, samples.played),
    "premise-violations": (samples.accepted, samples.unresolved),
    "repairs": (samples.accepted, samples.lost_after_settling, samples.unresolved),
    "retries": (samples.accepted, samples.unresolved),
    "route-success": (samples.accepted, samples.lost_after_settling, samples.faulted),
    "settling-losses": (samples.accepted, samples.lost_after_settling),
    "unmet-predicates": (samples.accepted, samples.faulted, samples.negated, samples.disagreement),
}


def trig(name):
    """The bytes of ``data.trig`` for the question ``name``."""
    store = Store()
    for make in DATA[name]:
        store.extend(episode_quads(make(), samples.SCHEMA, "example"))
    return dump(store, RdfFormat.TRIG)


def table(rows):
    """Rows as the text of a CSV file with plain line ends."""
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="\n").writerows(rows)
    return buffer.getvalue()
