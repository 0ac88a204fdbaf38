from __future__ import annotations

from dataclasses import replace
from importlib.metadata import EntryPoint
from types import SimpleNamespace

import pytest

from onto_compiler import registered
from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import OntoError
from onto_compiler.schema import local_name
from runtime.loop import registry
from tests.faults import fault

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
    monkeypatch.setattr(registered, "entry_points", lambda group: [entry] if group == registry.GROUP else [])
    with pytest.raises(OntoError) as raised:
        registry.load_proposers(load_schema())
    assert [p.code for p in raised.value.problems] == ["RUN010"]
    assert "rack_contact_site" in raised.value.problems[0].message


class Learned:
    name = "learned_pose"

    def __init__(self, schema):
        self.schema = schema


ROUTE = "source_joint_pose"
HEURISTIC = "runtime.worlds.libero.proposers.source_joint_pose:HeuristicSourceJointPose"
OWN_NAME = "heuristic_source_joint_pose"


def declare(monkeypatch, *declared):
    """Entry points as (name, what it loads, package)."""
    monkeypatch.setitem(__import__("sys").modules, "my_learned", SimpleNamespace(Learned=Learned))
    found = []
    for name, value, package in declared:
        point = EntryPoint(name, value, registry.GROUP)
        vars(point).update(dist=SimpleNamespace(name=package))
        found.append(point)
    monkeypatch.setattr(registered, "entry_points", lambda group: found if group == registry.GROUP else [])


OURS = (ROUTE, HEURISTIC, "onto-evwm")
THEIRS = (f"{ROUTE}.learned", "my_learned:Learned", "my-learned")


@pytest.mark.parametrize("order", [(OURS, THEIRS), (THEIRS, OURS)])
def test_of_several_proposers_one_is_chosen_by_name_and_never_by_order(monkeypatch, order):
    declare(monkeypatch, *order)
    schema = load_schema()
    problem = fault(registry.load_proposers, schema)
    assert problem.code == "RUN005"
    own = registry.load_proposers(schema, {ROUTE: next(iter(heuristic_names()))})
    for piece in ("`learned` (package `my-learned`)", "(package `onto-evwm`)", f"--proposer {ROUTE}="):
        assert piece in f"{problem.message} {problem.hint}"
    assert isinstance(registry.load_proposers(schema, {ROUTE: "learned"})[ROUTE], Learned)
    assert not isinstance(own[ROUTE], Learned)


def heuristic_names():
    from runtime.worlds.libero.proposers.source_joint_pose import HeuristicSourceJointPose

    return {HeuristicSourceJointPose.name}


def test_a_proposer_named_as_its_route_is_chosen_by_the_name_of_its_class(monkeypatch):
    declare(monkeypatch, OURS, (ROUTE, "my_learned:Learned", "my-learned"))
    assert isinstance(registry.load_proposers(load_schema(), {ROUTE: "learned_pose"})[ROUTE], Learned)


def test_two_packages_may_not_register_one_name(monkeypatch):
    declare(monkeypatch, THEIRS, (f"{ROUTE}.learned", "my_learned:Learned.__class__", "other-learned"))
    problem = fault(registry.load_proposers, load_schema(), {ROUTE: "learned"})
    assert problem.code == "RUN006"
    assert "`my-learned` and `other-learned`" in problem.message


@pytest.mark.parametrize("chosen", [{ROUTE: "lerned"}, {"no_such_route": "learned"}])
def test_a_choice_that_is_not_there_is_refused(monkeypatch, chosen):
    declare(monkeypatch, THEIRS)
    assert fault(registry.load_proposers, load_schema(), chosen).code == "RUN008"


def test_one_proposer_needs_no_choice(monkeypatch):
    declare(monkeypatch, THEIRS)
    assert list(registry.load_proposers(load_schema())) == [ROUTE]
