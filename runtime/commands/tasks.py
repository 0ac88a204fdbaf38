"""Ground, diagnose or repair one task in one call; the commands of these names print what the functions return."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from grounding.observation import Observation
from onto_compiler.required import Fact
from onto_compiler.schema import Schema
from runtime.commands.opening import open_task, start_of
from runtime.loop.diagnosis import by_distance, diagnose_goal, select
from runtime.loop.records import Diagnosis, Episode
from runtime.loop.routing import route
from runtime.trace.fact_rows import OBSERVED, UNMET, RoutedDiagnosis, seen_facts
from runtime.wording import atom

__all__ = ["DiagnosedFact", "DiagnosedTask", "GroundedFact", "GroundedTask", "diagnose", "ground", "repair"]


@dataclass(frozen=True, slots=True)
class GroundedFact:
    """A required fact with its evidence.

    ``fact`` is the fact in words, ``native`` the atom of the task file, ``status`` "satisfied", "absent", "explicitly
    false" or "margin violated". ``margin`` is in ``unit``, positive where satisfied and NaN where none is defined;
    ``limit`` is the term that decides it.
    """

    fact: str
    predicate: str
    arguments: tuple[str, ...]
    polarity: bool
    truth: bool
    satisfied: bool
    status: str
    margin: float
    unit: str
    limit: str
    native: str


@dataclass(frozen=True, slots=True)
class GroundedTask:
    """The facts of goal and premise in one state, and the native verdict, None where the ``world`` cannot judge.

    ``settle_steps`` without motion came before it. ``fixtures`` is who says where the fixtures stand; where nobody
    does, ``uncertain`` lists the facts whose verdict hangs on it.
    """

    world: str
    suite: str
    task: str
    state: int
    facts: tuple[GroundedFact, ...]
    premise: tuple[GroundedFact, ...]
    native_success: bool | None
    settle_steps: int
    fixtures: str | None
    uncertain: tuple[dict[str, Any], ...]


@dataclass(frozen=True, slots=True)
class DiagnosedFact:
    """An unmet fact with its failure and its route, by their short names; the loop begins with what is ``selected``."""

    fact: str
    predicate: str
    arguments: tuple[str, ...]
    polarity: bool
    truth: bool
    status: str
    margin: float
    unit: str
    limit: str
    failure: str
    route: str
    rule: str
    selected: bool


@dataclass(frozen=True, slots=True)
class DiagnosedTask:
    """What a state lacks of a goal, by the nearest way to reach it.

    ``required`` counts the facts of that way; ``alternatives`` holds the unmet facts of each way, the nearest first.
    ``settle_steps`` without motion came before it. ``fixtures`` is who says where the fixtures stand; where nobody
    does, ``uncertain`` lists the facts whose verdict hangs on it.
    """

    task: str
    state: int
    required: int
    diagnoses: tuple[DiagnosedFact, ...]
    alternatives: tuple[tuple[str, ...], ...]
    settle_steps: int
    fixtures: str | None
    uncertain: tuple[dict[str, Any], ...]


def ground(
    task: str,
    *,
    state: int | str | Path | ArrayLike = 0,
    ontology: Sequence[str | Path] = (),
    seed: int | None = None,
    settle: int | None = None,
    model: str | None = None,
    imports: Sequence[str] = (),
) -> GroundedTask:
    """Ground the goal and the premise of ``task`` in the initial ``state``.

    Args:
        task: ``SUITE/INDEX``, ``SUITE/NAME`` or the path of a BDDL file.
        state: The number of an official initial state, the path of a ``.npy`` file, or a flat state itself: time,
            qpos and qvel, shape (1 + nq + nv,).
        ontology: Turtle files of your own, for predicates, bindings, rules and routes.
        seed: Places the fixtures, which no initial state describes; 0 where nobody says.
        settle: Control steps without motion before the state is judged; without a number, an official state takes as
            many as its world's evaluations, and one of your own none.
        model: A file that says where the fixtures stand: MJCF that was saved from the scene, or demonstrations.
        imports: Modules that register objects and predicates of your own with LIBERO.

    Raises:
        OntoError: as the command ``onto ground``: BDDL, SIM and TTL problems, ``CLI004`` and ``CLI005``.
    """
    with open_task(task, ontology, seed, model=model, imports=imports) as runner:
        start, given = start_of(state)
        steps = runner.start(start, given, settle=settle)
        schema, environment, required = runner.knowledge.schema, runner.environment, runner.required
        return GroundedTask(
            world=runner.world.title,
            suite=runner.ref.suite,
            task=required.task,
            state=start,
            facts=_grounded(required.facts, environment.observe(), schema),
            premise=_grounded(required.premise, environment.observe_premise(), schema),
            native_success=environment.verify().outcome if environment.judged else None,
            settle_steps=steps,
            fixtures=runner.placed or None,
            uncertain=runner.uncertain(start),
        )


def diagnose(
    task: str,
    *,
    state: int | str | Path | ArrayLike = 0,
    ontology: Sequence[str | Path] = (),
    seed: int | None = None,
    settle: int | None = None,
    model: str | None = None,
    imports: Sequence[str] = (),
) -> DiagnosedTask:
    """Name what ``task`` lacks in the initial ``state``; the arguments are those of :func:`ground`.

    Raises:
        OntoError: as :func:`ground`, and ``RUN003`` where no rule speaks of a failure.
    """
    with open_task(task, ontology, seed, possible=True, model=model, imports=imports) as runner:
        start, given = start_of(state)
        steps = runner.start(start, given, settle=settle)
        knowledge, required, level = runner.knowledge, runner.required, runner.world.level
        observation, uncertain, placed = runner.environment.observe(), runner.uncertain(start), runner.placed
    ways = by_distance(required, observation)
    ranked = [diagnose_goal(required, observation, knowledge.tables, rank) for rank in range(len(ways))]
    schema, found = knowledge.schema, ranked[0]
    first = select(found).index if found else -1

    def diagnosed(one: Diagnosis) -> DiagnosedFact:
        told = UNMET.of(RoutedDiagnosis(one, route(one, knowledge, level=level).route, one.index == first), schema)
        return DiagnosedFact(**{**told, "arguments": tuple(told["arguments"]), "margin": one.margin})

    return DiagnosedTask(
        task=required.task,
        state=start,
        required=len(ways[0]),
        diagnoses=tuple(map(diagnosed, found)),
        alternatives=tuple(tuple(atom(one.fact, schema) for one in each) for each in ranked),
        settle_steps=steps,
        fixtures=placed or None,
        uncertain=uncertain,
    )


def repair(
    task: str,
    *,
    state: int | str | Path | ArrayLike = 0,
    ontology: Sequence[str | Path] = (),
    seed: int | None = None,
    budget: int | None = None,
    judge: str = "native",
    proposers: Mapping[str, str] | None = None,
    settle: int | None = None,
    model: str | None = None,
    imports: Sequence[str] = (),
) -> Episode:
    """Run the correction loop on ``task`` from the initial ``state``; the arguments are those of :func:`ground`.

    ``budget`` is how many attempts the loop may make. ``judge`` is "native", LIBERO's own predicate, or "grounding":
    the facts as they are grounded accept, which the record says. ``proposers`` names, by route, which of several
    proposers acts.

    Raises:
        OntoError: as :func:`ground`; ``SIM018`` where the native judge does not know a predicate of the goal.
    """
    with open_task(
        task, ontology, seed, budget, judge, proposers=proposers, possible=True, model=model, imports=imports
    ) as runner:
        start, given = start_of(state)
        episode = runner.run(start, given, settle=settle)
    if not proposers:
        return episode
    chosen = ((f"proposer of {route_name}", name) for route_name, name in proposers.items())
    return replace(episode, provenance=(*episode.provenance, *chosen))


def _grounded(facts: Sequence[Fact], observation: Observation, schema: Schema) -> tuple[GroundedFact, ...]:
    rows = ((each, OBSERVED.of(each, schema)) for each in seen_facts(facts, observation))
    return tuple(
        GroundedFact(**{**told, "arguments": tuple(told["arguments"]), "margin": each.margin}) for each, told in rows
    )
