"""Scores: what the ontology declares is what a scorer weighs."""

from __future__ import annotations

import pytest

from onto_compiler.compile_schema import load_schema
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError
from onto_compiler.schema import Score, ScoreTerm
from runtime.planning.scorers import Weights
from runtime.worlds.pointmaze.planning.rows import ROWS

PLAN = "https://w3id.org/onto-evwm/planning#"
SCORES = load_knowledge().schema.scores
OWN = """
@prefix ex: <https://example.org/mine#> .
@prefix nav: <https://w3id.org/onto-evwm/navigation#> .
@prefix plan: <https://w3id.org/onto-evwm/planning#> .
@prefix skos: <http://www.w3.org/2004/02/skos/core#> .
ex:mine a plan:Score ; skos:notation "mine" ; plan:term
    [ plan:field plan:remaining_way ; plan:weight %s ] ,
    [ plan:field plan:fact_margin ; plan:ofPredicate nav:at_target ; plan:weight 0.25 ] ,
    [ plan:field plan:fact_score ; plan:ofPredicate nav:free_of ; plan:weight 2 ] .
"""


def own(tmp_path, weight):
    path = tmp_path / "mine.ttl"
    path.write_text(OWN % weight)
    return load_schema(str(path)).scores["mine"]


def test_every_row_has_a_declared_score_and_every_score_a_row():
    assert {row.score for row in ROWS.values()} - {None} == set(SCORES)
    assert len(SCORES) == 6


def test_only_the_typed_rows_read_typed_facts():
    weights = {name: Weights.of(score) for name, score in SCORES.items()}
    assert {name for name, each in weights.items() if each.margins} == {"onto"}
    assert {name for name, each in weights.items() if each.scores} == {"onto_untyped"}
    assert {name for name, each in weights.items() if each.events} == {"event", "onto", "onto_untyped"}
    assert all(each.feature > 0 for each in weights.values())


def test_a_score_of_ones_own_weighs_what_it_declares(tmp_path):
    expected = Weights(remaining=1.5, margins={"at_target": 0.25}, scores={"free_of": 2.0})
    assert Weights.of(own(tmp_path, "1.5")) == expected


@pytest.mark.parametrize("weight", ['"INF"^^<http://www.w3.org/2001/XMLSchema#double>', "-1", '"much"'])
def test_a_weight_that_is_no_number_of_0_or_more_is_refused(tmp_path, weight):
    with pytest.raises(OntoError) as caught:
        own(tmp_path, weight)
    assert caught.value.problems[0].code == "SCH001"


@pytest.mark.parametrize(("field", "hint"), [("remaining_ways", "did you mean `remaining_way`?"), ("fact_margin", "")])
def test_a_field_that_no_scorer_computes_is_refused(field, hint):
    with pytest.raises(OntoError) as caught:
        Weights.of(Score("urn:mine", "mine", (ScoreTerm(PLAN + field, 1.0),)))
    (problem,) = caught.value.problems
    assert (problem.code, hint in problem.hint) == ("PMZ009", True)
