"""What Turtle says of the grounding functions is what they do."""

import pytest

from grounding.predicates.registry import factory
from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import OntoError
from onto_compiler.rdf import prologue
from onto_compiler.registered import GROUNDINGS, points
from onto_compiler.required import Entity, Fact, NativeAtom
from onto_compiler.sources import load_store

pytestmark = pytest.mark.sim

ROWS = load_store().query(
    prologue() + "SELECT ?name ?tests { ?f a core:GroundingFunction ; skos:notation ?name ; core:tests ?tests }",
    use_default_graph_as_union=True,
)
DECLARED = {row["name"].value: int(row["tests"].value) for row in ROWS}


def test_every_function_of_ours_is_declared():
    own = {point.name for point in points(GROUNDINGS) if point.module.startswith("grounding.")}
    assert own == set(DECLARED)
    assert len(own) == 13


@pytest.mark.parametrize("name", sorted(DECLARED))
@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_function_refuses_another_number_of_names(name, count):
    """SIM006 is what an unsuited fact raises before anything is looked up in a scene."""
    fact = Fact(
        "https://w3id.org/onto-evwm/navigation#at_target",
        (Entity("a", "c"),) * count,
        NativeAtom("P", ("a", "b", "c")[:count]),
        name,
    )
    with pytest.raises((OntoError, AttributeError, TypeError)) as caught:
        factory(name)(None, fact, load_schema())
    refused = isinstance(caught.value, OntoError) and "tests" in str(caught.value) and "SIM006" in str(caught.value)
    assert refused == (count != DECLARED[name])
