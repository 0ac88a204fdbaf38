"""IRIs of records, minted from the run and the index alone, and the individuals that stand for short words.

The same run makes the same graph: no IRI holds a time, a counter of the process or a random number.
"""

from __future__ import annotations

from urllib.parse import quote

from onto_compiler.rdf import BASE, CORE, TRACE
from onto_compiler.tables import LEVELS

__all__ = [
    "ENDS",
    "LEVELS",
    "MODES",
    "OUTCOMES",
    "RUNS",
    "SOURCES",
    "episode_iri",
    "inverse",
    "run_iri",
]

RUNS = BASE + "run/"

ENDS = {
    "blocked": TRACE + "Blocked",
    "completed": TRACE + "Completed",
    "gave_up": TRACE + "GaveUp",
    "lost": TRACE + "Lost",
    "missed": TRACE + "Missed",
    "out_of_steps": TRACE + "OutOfSteps",
    "unreachable": TRACE + "Unreachable",
}
MODES = {"none": TRACE + "NoApplication", "state": TRACE + "StateMutation", "controller": TRACE + "ControllerExecution"}
OUTCOMES = {
    "retained": TRACE + "Retained",
    "verified": TRACE + "Verified",
    "accepted": TRACE + "Accepted",
    "unresolved": TRACE + "Unresolved",
    "grounding_verifier_disagreement": TRACE + "GroundingVerifierDisagreement",
    "run_fault": TRACE + "FaultedRun",
}
SOURCES = {"sim": CORE + "Simulator", "pred": CORE + "WorldModel"}


def run_iri(run: str) -> str:
    """The IRI of a run."""
    return RUNS + quote(run, safe="")


def episode_iri(run: str, suite: str, task: str, state_index: int) -> str:
    """The IRI of an episode, which is also the name of its own graph."""
    return f"{run_iri(run)}/episode/{quote(suite, safe='')}/{quote(task, safe='')}/{state_index}"


def inverse(table: dict[str, str]) -> dict[str, str]:
    """From individuals back to words."""
    return {iri: word for word, iri in table.items()}
