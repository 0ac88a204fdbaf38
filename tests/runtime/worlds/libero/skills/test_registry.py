"""Skills are found by the name of their route."""

from __future__ import annotations

from importlib.metadata import EntryPoint

import pytest

from onto_compiler import registered
from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import OntoError
from runtime.worlds.libero.skills import registry


def declare(monkeypatch, *entries):
    monkeypatch.setattr(registered, "entry_points", lambda group: list(entries) if group == registry.GROUP else [])


def test_a_skill_is_found_by_its_route_and_one_of_no_route_is_left_out(monkeypatch):
    known = EntryPoint("pick_and_place", "builtins:dict", registry.GROUP)
    declare(monkeypatch, known, EntryPoint("no_such_route", "builtins:dict", registry.GROUP))
    assert registry.load_skills(load_schema()) == {"pick_and_place": dict}


@pytest.mark.parametrize("value", ["no_such_module:Skill", "runtime.worlds.libero.skills.registry:NoSuchName"])
def test_a_skill_that_cannot_be_loaded_is_an_error_of_its_own(monkeypatch, value):
    declare(monkeypatch, EntryPoint("move_joint", value, registry.GROUP))
    with pytest.raises(OntoError) as raised:
        registry.load_skills(load_schema())
    assert [problem.code for problem in raised.value.problems] == ["RUN011"]
    assert "`move_joint`" in raised.value.problems[0].message
