"""Quads in, records out: the exact inverse of :mod:`runtime.trace.write`, by the same table."""

from __future__ import annotations

import re

from pyoxigraph import NamedNode, Store

from onto_compiler.problems import OntoError
from onto_compiler.rdf import PREFIXES, RDF, TRACE, node, shorten
from onto_compiler.record.places import Subject
from onto_compiler.record.walk import read_record
from runtime.loop.records import Episode
from runtime.trace.names import run_of
from runtime.trace.table import ATTEMPT, EPISODE, EXECUTED_PLAN, TERMS
from runtime.trace.write import VOCABULARY

__all__ = ["episode_iris", "read_episode"]


def episode_iris(store: Store) -> tuple[str, ...]:
    """The IRIs of every recorded episode: by run, suite, task, initial state, seed and trial."""
    quads = store.quads_for_pattern(None, node(RDF + "type"), node(TRACE + "Episode"), None)
    return tuple(sorted({q.subject.value for q in quads if isinstance(q.subject, NamedNode)}, key=_natural))


def _natural(text: str) -> list[tuple[int, str]]:
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", text)]


def read_episode(store: Store, iri: str) -> Episode:
    """The episode ``iri`` as it was recorded, also by former versions.

    Raises:
        OntoError: TRC003 if the trace lacks a statement that the record needs, or holds an unusable value; TRC007,
            where it was written in another vocabulary, of which a part would be lost.
    """
    about = Subject(store, iri)
    try:
        episode: Episode = read_record(EPISODE, about)
    except OntoError as error:
        if other := _other_vocabulary(about):
            found = error.problems[0].message.removeprefix("the trace is incomplete: ")
            raise _refusal(f"{other}: {found}") from error
        raise
    if unread := _unread(about):
        raise _refusal(unread)
    return episode


def _refusal(why: str) -> OntoError:
    hint = "read it with the version of Onto-EV-WM that wrote it, or record the episode again"
    return OntoError.of("TRC007", f"the trace is in another vocabulary: {why}", hint)


def _other_vocabulary(about: Subject) -> str:
    """What shows that an episode was written in another vocabulary; nothing where all is ours."""
    stated = about.at(run_of(about.iri)).all(PREFIXES["dcterms"] + "conformsTo")
    if stated and all(term.value != VOCABULARY for term in stated):
        return f"it conforms to <{stated[0].value}>"
    return _unread(about)


def _unread(about: Subject) -> str:
    """A term of what was read of an episode that no record has, as it would be lost; nothing where there is none."""
    kinds = {ATTEMPT.type, EXECUTED_PLAN.type}
    turns = about.back(TRACE + "inEpisode")
    strange = [each for each in turns if not any(map(each.is_a, kinds))]
    for iri in sorted({*about.shared.get("read", ()), *(each.iri for each in strange)}):
        for quad in about.store.quads_for_pattern(node(iri), None, None, None):
            kind = quad.object if quad.predicate.value == RDF + "type" else None
            term = kind if isinstance(kind, NamedNode) else quad.predicate
            if term.value.startswith(TRACE) and term.value not in TERMS:
                return f"it uses `{shorten(term.value)}`, which no record of ours has"
    return f"<{strange[0].iri}> is neither an attempt nor a plan" if strange else ""
