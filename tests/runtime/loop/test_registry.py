from __future__ import annotations

from dataclasses import replace
from importlib.metadata import EntryPoint

import pytest

from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import OntoError
from onto_compiler.schema import local_name
from runtime.loop import registry, routed

pytestmark = pytest.mark.sim


def test_every_declared_state_route_has_a_proposer():
    schema = load_schema()
    states = {local_name(iri) for iri, route in schema.routes.items() if route.level == "state"}
    found = registry.load_proposers(schema)
    assert len(states) == 4
    assert states == set(found)
    assert len({proposer.name for proposer in found.values()}) == 4


def test_a_route_that_the_schema_lacks_is_left_out():
    schema = load_schema()
    kept = {iri: route for iri, route in schema.routes.items() if local_name(iri) == "rack_contact_site"}
    assert list(registry.load_proposers(replace(schema, routes=kept))) == ["rack_contact_site"]


@pytest.mark.parametrize("value", ["no_such_module:Proposer", "runtime.loop.registry:NoSuchName"])
def test_a_proposer_that_cannot_be_loaded_is_an_error_of_its_own(monkeypatch, value):
    entry = EntryPoint("rack_contact_site", value, registry.GROUP)
    monkeypatch.setattr(routed, "entry_points", lambda group: [entry] if group == registry.GROUP else [])
    with pytest.raises(OntoError) as raised:
        registry.load_proposers(load_schema())
    assert [p.code for p in raised.value.problems] == ["RUN010"]
    assert "rack_contact_site" in raised.value.problems[0].message
