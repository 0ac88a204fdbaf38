"""Admission to a trace: every record is validated against the shapes before writing, and nothing is overwritten.

An episode that equals the recorded one of the same names is not recorded again, so that a run can be resumed. A
different one is recorded as the next trial.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from pyoxigraph import NamedNode, Quad, Store

from onto_compiler.problems import OntoError
from onto_compiler.rdf import RDF, TRACE, node, shorten
from onto_compiler.schema import Schema
from onto_compiler.shacl.graph import Term
from onto_compiler.terms import text_of
from onto_compiler.validator.records import Validator, problem_of
from runtime.loop.records import Episode
from runtime.trace.names import RUNS, iri_of
from runtime.trace.read import read_episode
from runtime.trace.write import episode_quads

__all__ = ["admit", "is_recorded", "refuse_invalid", "tagged"]

_FEW = 20  # problems that are reported; one wrong number repeats in every later record


def admit(store: Store, validator: Validator, episode: Episode, schema: Schema, run: str) -> tuple[str, list[Quad]]:
    """The IRI for ``episode`` in ``store``, and the statements that the store lacks.

    Raises:
        OntoError: as :func:`refuse_invalid`.
    """
    while True:
        iri, quads = iri_of(run, episode), list(episode_quads(episode, schema, run))
        if not is_recorded(store, iri):
            refuse_invalid(validator, quads)
            return iri, quads
        if set(quads) == _recorded(store, iri, schema, run):
            return iri, []
        episode = replace(episode, trial=episode.trial + 1)


def tagged(episode: Episode, tags: Iterable[tuple[str, str]]) -> Episode:
    """``episode`` with ``tags`` added; for a key that it has already, its own value stays."""
    return replace(episode, tags=tuple(sorted({**dict(tags), **dict(episode.tags)}.items())))


def is_recorded(store: Store, iri: str) -> bool:
    """Whether the episode is recorded; it is always recorded completely."""
    pattern = store.quads_for_pattern(node(iri), node(RDF + "type"), node(TRACE + "Episode"), None)
    return next(pattern, None) is not None


def _recorded(store: Store, iri: str, schema: Schema, run: str) -> set[Quad]:
    """The statements of a recorded episode; none of one that cannot be read, from which every other differs."""
    try:
        return set(episode_quads(read_episode(store, iri), schema, run))
    except OntoError:
        return set()


def refuse_invalid(validator: Validator, quads: Iterable[Quad]) -> None:
    """Validate every record that ``quads`` describe against the shapes.

    Raises:
        OntoError: one problem for each violation (the first twenty): the shape's code, the record, what was expected.
    """
    results = [result for result in validator.validate(quads) if result.severity == "Violation"]
    if results:
        raise OntoError(*(problem_of(result, validator.home(result.shape), _name) for result in results[:_FEW]))


def _name(term: Term) -> str:
    """A term in one word; a record by its place in its run."""
    return f"`{shorten(term.value).removeprefix(RUNS) if isinstance(term, NamedNode) else text_of(term)}`"
