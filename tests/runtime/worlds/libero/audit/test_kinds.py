"""What counts as a premise failure stands in Turtle, and a person can add to it."""

from __future__ import annotations

import pytest

from onto_compiler.problems import OntoError
from runtime.worlds.libero.audit.kinds import load_kinds
from runtime.worlds.libero.audit.measures import DECIDING, MEASURES

PREFIXES = """
@prefix audit: <https://w3id.org/onto-evwm/audit#> .
@prefix core: <https://w3id.org/onto-evwm/core#> .
@prefix my: <https://example.org/my#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix unit: <http://qudt.org/vocab/unit/> .
"""


def kinds(*files):
    return load_kinds(files, measures=MEASURES, deciding=DECIDING)


def turtle(tmp_path, body):
    path = tmp_path / "mine.ttl"
    path.write_text(PREFIXES + f"my:Slid a owl:Class ; rdfs:subClassOf audit:PremiseFailure ; {body} .\n")
    return path


def test_every_measure_has_its_kind():
    shipped = kinds()
    assert sorted(kind.measure for kind in shipped) == sorted(MEASURES)
    assert {kind.measure for kind in shipped if kind.most is None} == DECIDING
    assert all(kind.unit in {"m", "rad"} for kind in shipped if kind.most is not None)


def test_a_kind_of_one_s_own_is_added(tmp_path):
    own = turtle(tmp_path, 'audit:measuredBy "displacement" ; audit:tolerates 0.002 ; core:unit unit:M')
    (added,) = set(kinds(own)) - set(kinds())
    assert (added.name, added.measure, added.most, added.unit) == ("Slid", "displacement", 0.002, "m")


@pytest.mark.parametrize(
    ("body", "message", "hint"),
    [
        (
            'audit:measuredBy "displacment" ; audit:tolerates 1',
            "no measure is called so",
            "did you mean `displacement`?",
        ),
        ('audit:measuredBy "fall"', "does not say how much", "audit:tolerates"),
        ('audit:measuredBy "goal" ; audit:tolerates 1', "is decided by its measure", "audit:tolerates"),
    ],
)
def test_a_kind_that_cannot_be_measured_is_refused(tmp_path, body, message, hint):
    with pytest.raises(OntoError) as caught:
        kinds(turtle(tmp_path, body))
    (problem,) = caught.value.problems
    assert problem.code == "RUN020"
    assert message in problem.message
    assert hint in problem.hint
