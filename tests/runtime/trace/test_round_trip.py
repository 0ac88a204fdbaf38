"""Laws of the RDF form: what is written reads back equal, and the same episode gives the same bytes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import HealthCheck, given, settings
from pyoxigraph import NamedNode, RdfFormat, Store, serialize

from onto_compiler.rdf import CORE, PREFIXES, RDF, SKOS
from runtime.trace.names import ENDS, LEVELS, MODES, OUTCOMES, SOURCES, iri_of
from runtime.trace.read import read_episode
from runtime.trace.store import dump
from runtime.trace.vocabulary import vocabulary
from runtime.trace.write import episode_quads
from tests.runtime.trace.plain import plain
from tests.runtime.trace.samples import accepted
from tests.strategies import SCHEMA, episodes

RUN = "run / é"
VOCABULARY = vocabulary()
law = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])


def _iri(episode):
    return iri_of(RUN, episode)


@law
@given(episodes())
def test_an_episode_reads_back_from_trig_as_it_was(episode):
    trig = serialize(episode_quads(episode, SCHEMA, RUN), format=RdfFormat.TRIG, prefixes=PREFIXES)
    store = Store()
    store.load(trig, format=RdfFormat.TRIG)
    assert plain(read_episode(store, _iri(episode))) == plain(episode)


@law
@given(episodes())
def test_the_ontology_beside_a_record_does_not_change_what_is_read(episode):
    store = Store()
    store.extend(episode_quads(episode, SCHEMA, RUN))
    store.extend(VOCABULARY)
    assert plain(read_episode(store, _iri(episode))) == plain(episode)


@law
@given(episodes())
def test_the_same_episode_gives_the_same_bytes_and_no_nan(episode):
    first, second = Store(), Store()
    first.extend(episode_quads(episode, SCHEMA, RUN))
    second.extend(reversed(list(episode_quads(episode, SCHEMA, RUN))))
    data = dump(first, RdfFormat.TRIG)
    assert data == dump(second, RdfFormat.TRIG)
    again = Store()
    again.load(data, format=RdfFormat.TRIG)
    assert set(again) == set(first)
    assert not [quad for quad in first if str(quad.object).startswith('"NaN"^^')]


@law
@given(episodes())
def test_every_record_stands_in_the_graph_that_its_iri_names(episode):
    top = _iri(episode)
    fixed = {top, *(f"{top}/{part}" for part in ("required", "initial", "final", "premise"))}
    turns = {f"{top}/{part}/{a.index}" for a in episode.attempts for part in ("attempt", "observed")}
    turns |= {f"{top}/attempt/{a.index}/predicted" for a in episode.attempts if a.prediction}
    turns |= {f"{top}/plan/{p.index}{part}" for p in episode.plans for part in ("", "/simulated")}
    turns |= {f"{top}/plan/{p.index}/predicted" for p in episode.plans if p.predicted}
    graphs = {quad.graph_name.value for quad in episode_quads(episode, SCHEMA, RUN)}
    assert graphs == fixed | turns
    for quad in episode_quads(episode, SCHEMA, RUN):
        subject, graph = quad.subject.value, quad.graph_name.value
        assert subject.startswith((graph, f"{top}/entity/", "https://w3id.org/onto-evwm/run/")), (subject, graph)


def test_the_words_for_individuals_are_the_notations_of_the_ontology():
    store = Store()
    store.extend(VOCABULARY)
    checked = 0
    for table in (ENDS, LEVELS, MODES, OUTCOMES, SOURCES):
        for word, iri in table.items():
            (quad,) = store.quads_for_pattern(NamedNode(iri), NamedNode(SKOS + "notation"), None, None)
            assert quad.object.value == word
            checked += 1
    assert checked == 21


@law
@given(episodes())
def test_only_declared_terms_of_our_namespaces_are_used(episode):
    declared = {quad.subject.value for quad in VOCABULARY if isinstance(quad.subject, NamedNode)}
    for quad in episode_quads(episode, SCHEMA, RUN):
        for term in (quad.predicate, quad.object):
            if isinstance(term, NamedNode) and "#" in term.value and not term.value.startswith(RDF):
                known = term.value in declared or term.value.startswith("http://www.w3.org/2000/01/rdf-schema#")
                assert known or "/rules#" in term.value, term


def test_an_observed_fact_without_evidence_states_no_truth():
    episode = _absent_episode()
    quads = [q for q in episode_quads(episode, SCHEMA, RUN) if "/initial/observation/" in q.subject.value]
    predicates = {q.predicate.value for q in quads}
    assert CORE + "status" in predicates
    assert CORE + "truth" not in predicates
    assert CORE + "margin" not in predicates


def _absent_episode():
    episode = accepted()
    size = len(episode.initial)
    nothing = replace(
        episode.initial,
        observed=np.zeros(size, dtype=np.bool_),
        truth=np.zeros(size, dtype=np.bool_),
        margin=np.full(size, np.nan),
        limit=("",) * size,
    )
    return replace(episode, initial=nothing)
