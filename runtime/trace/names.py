"""IRIs of records, minted from run and index only, and the individuals for short words.

An episode is identified by its run, suite, task, initial state, seed, trial and tags. The same run makes the same
graph: no IRI contains a time, a process counter or a random number.
"""

from __future__ import annotations

from collections.abc import Iterable
from urllib.parse import quote

from onto_compiler.rdf import BASE, CORE, TRACE
from onto_compiler.tables import LEVELS
from runtime.loop.records import GIVEN, Episode

__all__ = [
    "ENDS",
    "LEVELS",
    "MODES",
    "OUTCOMES",
    "RUNS",
    "SOURCES",
    "episode_iri",
    "file_name",
    "iri_of",
    "run_iri",
    "run_of",
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


def run_of(episode: str) -> str:
    """The IRI of the run that the episode with the IRI ``episode`` belongs to."""
    return episode.partition("/episode/")[0]


def episode_iri(
    run: str,
    suite: str,
    task: str,
    state_index: int,
    seed: int = 0,
    trial: int = 0,
    *,
    given: str = "",
    tags: Iterable[tuple[str, str]] = (),
) -> str:
    """The IRI of an episode, which is also the name of its own graph: it contains everything that identifies it."""
    state = f"given-{given}" if state_index == GIVEN and given else f"state-{state_index}"
    marks = "".join(f";{quote(key, safe='')}={quote(value, safe='')}" for key, value in sorted(tags))
    names = "/".join(quote(name, safe="") for name in (suite, task))
    return f"{run_iri(run)}/episode/{names}/{state}/seed-{seed}/trial-{trial}{marks}"


def iri_of(run: str, episode: Episode) -> str:
    """The IRI of ``episode`` as a part of ``run``."""
    each = episode
    return episode_iri(
        run, each.suite, each.task, each.state_index, each.seed, each.trial, given=each.given, tags=each.tags
    )


def file_name(episode: str) -> str:
    """A file name for what belongs to the episode with the IRI ``episode``, and to no other."""
    return episode.removeprefix(RUNS).replace("/episode/", "/").replace("/", "-")
