"""Ground, diagnose or repair one task in one call; the commands of these names print what the functions return."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

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
class _FactEvidence:
    """A required fact and the evidence for it.

    ``fact`` is the fact in words, ``status`` "satisfied", "absent", "explicitly false" or "margin violated". ``margin``
    is in ``unit``, positive where satisfied and NaN if none is defined; ``limit`` is the term that decides it.
    """

    fact: str
    predicate: str
    arguments: tuple[str, ...]
    polarity: bool
    truth: bool
    status: str
    margin: float
    unit: str
    limit: str

    @classmethod
    def of(cls, row: Mapping[str, Any], margin: float) -> Self:
        """The fact of a ``row`` of JSON, whose margin is None if it is not defined."""
        return cls(**{**row, "arguments": tuple(row["arguments"]), "margin": margin})


@dataclass(frozen=True, slots=True)
class GroundedFact(_FactEvidence):
    """A required fact with its evidence; ``native`` is the atom of the task file."""

    satisfied: bool
    native: str


@dataclass(frozen=True, slots=True)
class GroundedTask:
    """The facts of goal and premise in one state, and the native verdict, None if the ``world`` cannot judge.

    The state was first settled for ``settle_steps`` without motion. ``fixtures`` is the source of the fixtures' poses;
    where it is None, ``uncertain`` lists the facts whose verdict depends on these poses.
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
class DiagnosedFact(_FactEvidence):
    """An unmet fact with the short names of its failure and route; the loop starts with the one ``selected``."""

    failure: str
    route: str
    rule: str
    selected: bool


@dataclass(frozen=True, slots=True)
class DiagnosedTask:
    """The unmet facts of a goal in one state, for the alternative of the goal that is nearest to it.

    ``required`` counts the facts of that alternative; ``alternatives`` has the unmet facts of each, the nearest first.
    The state was first settled for ``settle_steps`` without motion. ``fixtures`` is the source of the fixtures' poses;
    where it is None, ``uncertain`` lists the facts whose verdict depends on these poses.
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
        seed: Places the fixtures, which no initial state describes; default 0.
        settle: Control steps without motion before the state is judged. Default: for an official state, as many as its
            world's evaluations use; for a state of your own, none.
        model: A file with the fixtures' poses: MJCF that was saved from the scene, or demonstrations.
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
    """Diagnose the unmet facts of ``task`` in the initial ``state``; the arguments are those of :func:`ground`.

    Raises:
        OntoError: as :func:`ground`, and ``RUN003`` if no rule matches a failure.
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
        routed = RoutedDiagnosis(one, route(one, knowledge, level=level).route, one.index == first)
        return DiagnosedFact.of(UNMET.of(routed, schema), one.margin)

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

    ``budget`` is the largest number of attempts. ``judge`` is "native", LIBERO's own predicate, or "grounding", the
    grounded facts; the record says which. ``proposers`` chooses a proposer by the name of its route, where a route has
    several.

    Raises:
        OntoError: as :func:`ground`; ``SIM018`` if the native judge does not know a predicate of the goal.
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
    return tuple(GroundedFact.of(OBSERVED.of(each, schema), each.margin) for each in seen_facts(facts, observation))
