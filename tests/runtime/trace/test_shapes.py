"""What the loop records conforms to the shapes of required, observed and recorded facts."""

import pytest
from pyoxigraph import NamedNode

from onto_compiler.rdf import CORE, RDF, TRACE
from onto_compiler.shapes import compile_shapes, validate
from onto_compiler.sources import load_store
from runtime.trace.write import episode_quads
from tests.runtime.trace.samples import all_samples, partly_sensed, planned, played
from tests.strategies import SCHEMA

SAMPLES = (*all_samples(), played(), planned(), partly_sensed())
TYPE = NamedNode(RDF + "type")


def results(episode, damage=lambda quads: quads):
    store = load_store()
    store.extend(damage(list(episode_quads(episode, SCHEMA, "run"))))
    return validate(store, compile_shapes(store))


def test_there_are_samples():
    assert len(SAMPLES) >= 8


@pytest.mark.parametrize("number", range(len(SAMPLES)))
def test_every_sample_conforms(number):
    assert results(SAMPLES[number]) == ()


@pytest.mark.parametrize("part", ["controlSteps", "evaluations", "mode", "proposer", "simulated", "verification"])
def test_a_plan_without_one_of_its_parts_does_not(part):
    def damage(quads):
        return [q for q in quads if not (q.predicate.value == TRACE + part and "/plan/0" in q.subject.value)]

    assert {result.code for result in results(planned(), damage)} == {"ABX004"}


@pytest.mark.parametrize(
    ("predicate", "code"),
    [(CORE + "polarity", "ABX004"), (TRACE + "memberFact", "ABX002"), (CORE + "argument2", "ABX001")],
)
def test_a_record_without_one_of_its_parts_does_not(predicate, code):
    def damage(quads):
        return [quad for quad in quads if quad.predicate.value != predicate]

    episode = next(sample for sample in SAMPLES if sample.attempts)
    assert code in {result.code for result in results(episode, damage)}
