"""A record that does not conform is refused before anything is written, and the problem says which and why."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from onto_compiler.problems import OntoError
from onto_compiler.rdf import CORE, MAN
from onto_compiler.required import Entity
from runtime.trace.store import TraceStore
from tests.runtime.trace import samples

PREFIXES = """
@prefix core: <https://w3id.org/onto-evwm/core#> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix shape: <https://w3id.org/onto-evwm/shapes#> .
@prefix trace: <https://w3id.org/onto-evwm/trace#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
@prefix own: <https://example.org/own#> .
"""


def refused(tmp_path, episode, *ontology):
    """The problems that ``episode`` is refused with; nothing of it may be in the store."""
    with TraceStore(tmp_path / "store", samples.SCHEMA, "run", ontology=ontology) as store:
        before = len(store._store)
        with pytest.raises(OntoError) as error:
            store.add(episode)
        assert len(store._store) == before
        assert store.episodes() == ()
    return error.value.problems


def with_diagnosis(episode, **changes):
    """``episode`` with a first attempt whose diagnosis is changed, both where it is listed and where it is routed."""
    first, *others = episode.attempts
    changed = replace(first.diagnoses[0], **changes)
    first = replace(first, diagnoses=(changed,), selected=replace(first.selected, diagnosis=changed))
    return replace(episode, attempts=(first, *others))


def test_a_diagnosis_of_a_fact_that_the_task_does_not_require_is_refused(tmp_path):
    problems = refused(tmp_path, with_diagnosis(samples.accepted(), fact=samples.IN_FRONT))
    assert "ABX002" in {problem.code for problem in problems}


@pytest.mark.parametrize(
    "fact",
    [
        replace(samples.ON, arguments=(samples.BOWL, replace(samples.PLATE, name="plate_2"))),
        replace(samples.ON, predicate=MAN + "left_of"),
        replace(samples.ON, polarity=False),
    ],
    ids=["argument", "predicate", "polarity"],
)
def test_a_diagnosis_that_does_not_keep_its_fact_whole_is_refused(tmp_path, fact):
    problems = refused(tmp_path, with_diagnosis(samples.accepted(), fact=fact))
    (preserved,) = [problem for problem in problems if problem.code == "ABX002"]
    assert "attempt/0/diagnosis/0" in preserved.message
    assert "shape:ArgumentPreservation" in preserved.message
    assert preserved.hint


def test_a_diagnosis_of_a_fact_beyond_the_last_is_refused(tmp_path):
    assert "ABX002" in {problem.code for problem in refused(tmp_path, with_diagnosis(samples.accepted(), index=5))}


def test_a_route_that_does_not_fit_is_refused(tmp_path):
    first, *others = samples.accepted().attempts
    wrong = replace(first, selected=replace(first.selected, route=MAN + "rack_contact_site"))
    (problem,) = refused(tmp_path, replace(samples.accepted(), attempts=(wrong, *others)))
    assert problem.code == "ABX003"
    assert "attempt/0/decision" in problem.message
    assert "rack_contact_site" in problem.message


def test_an_argument_of_another_class_is_refused(tmp_path):
    episode = samples.disagreement()
    fact = replace(samples.ON, arguments=(Entity("table", CORE + "Level"), samples.PLATE))
    problems = refused(tmp_path, replace(episode, required=replace(episode.required, facts=(fact,))))
    assert {problem.code for problem in problems} >= {"ABX001", "ABX004"}


def test_a_score_that_is_no_probability_is_refused_with_what_was_expected(tmp_path):
    episode = samples.disagreement()
    wrong = replace(episode.final, score=np.array([1.5]))
    (problem,) = refused(tmp_path, replace(episode, final=wrong))
    assert problem.code == "ABX004"
    assert "final/observation/0" in problem.message
    assert "an xsd:double between 0 and 1" in problem.message
    assert "`1.5`" in problem.message


def test_an_episode_with_too_many_faults_tells_some_of_them(tmp_path):
    facts = (replace(samples.ON, arguments=()),) * 40
    nothing = samples.observed(*[None] * 40)
    episode = samples.episode("none", facts, nothing, (), nothing, outcome="unresolved")
    assert len(refused(tmp_path, episode)) == 20


def test_a_refused_episode_leaves_the_earlier_record_of_its_name(tmp_path):
    with TraceStore(tmp_path / "store", samples.SCHEMA, "run") as store:
        iri = store.add(samples.accepted())
        with pytest.raises(OntoError):
            store.add(with_diagnosis(samples.accepted(), index=5))
        assert store.episode(iri).outcome == "accepted"


def test_a_property_shape_of_ones_own_is_enforced(tmp_path):
    own = tmp_path / "own.ttl"
    own.write_text(
        PREFIXES
        + """own:Quick a sh:NodeShape ; sh:targetClass trace:Episode ;
    sh:property [ sh:path trace:seed ; sh:maxInclusive 5 ; sh:message "starts from a seed of at most 5" ] ."""
    )
    (problem,) = refused(tmp_path, samples.accepted(), own)
    assert problem.code == "SHP001"
    assert "starts from a seed of at most 5, and has `7`" in problem.message
    assert problem.hint


def test_a_literal_in_a_shape_is_the_one_that_the_file_spells(tmp_path):
    own = tmp_path / "own.ttl"
    shape = """own:Seed a sh:NodeShape ; sh:targetClass trace:Episode ;
    sh:property [ sh:path trace:seed ; sh:in ( "%s"^^xsd:integer ) ] ."""
    own.write_text(PREFIXES + shape % "007")
    (problem,) = refused(tmp_path, samples.accepted(), own)
    assert problem.code == "SHP001"
    own.write_text(PREFIXES + shape % "7")
    with TraceStore(tmp_path / "store", samples.SCHEMA, "run", ontology=[own]) as store:
        assert store.add(samples.accepted()) in store.episodes()


def test_a_query_of_ones_own_is_enforced(tmp_path):
    own = tmp_path / "own.ttl"
    own.write_text(
        PREFIXES
        + """own:Tried a sh:NodeShape ; sh:targetClass trace:Episode ; sh:sparql [
    sh:message "was tried more than once" ; shape:code "SHP001" ; shape:hint "try less" ;
    sh:select '''SELECT $this WHERE { ?attempt <https://w3id.org/onto-evwm/trace#inEpisode> $this ;
        <https://w3id.org/onto-evwm/trace#index> 1 }''' ] ."""
    )
    (problem,) = refused(tmp_path, samples.accepted(), own)
    assert "was tried more than once" in problem.message
    assert problem.hint == "try less"


def test_a_warning_refuses_nothing(tmp_path):
    own = tmp_path / "own.ttl"
    own.write_text(
        PREFIXES
        + """own:Quick a sh:NodeShape ; sh:targetClass trace:Episode ;
    sh:property [ sh:path trace:seed ; sh:maxInclusive 5 ; sh:severity sh:Warning ] ."""
    )
    with TraceStore(tmp_path / "store", samples.SCHEMA, "run", ontology=[own]) as store:
        assert store.add(samples.accepted()) in store.episodes()


def test_a_shape_that_cannot_run_is_told_when_the_store_is_opened(tmp_path):
    own = tmp_path / "own.ttl"
    own.write_text(
        PREFIXES + 'own:Bad a sh:NodeShape ; sh:targetClass trace:Episode ; sh:property [ sh:path "seed" ] .'
    )
    with pytest.raises(OntoError) as error:
        TraceStore(tmp_path / "store", samples.SCHEMA, "run", ontology=[own])
    (problem,) = error.value.problems
    assert problem.code == "SHP002"
    assert not (tmp_path / "store").exists()
