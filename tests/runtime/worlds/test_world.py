"""Worlds are found by entry point; one that is broken says so when it is asked for, and leaves the others alone."""

from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from onto_compiler.problems import OntoError
from runtime.worlds import world
from runtime.worlds.world import GROUP, TaskRef, named_task, suites, world_of

LIBERO = EntryPoint("libero", "runtime.worlds.libero.world:WORLD", GROUP)


class Tray:
    name = "tray"
    title = "Tray"
    domains = ("tray",)

    def suites(self):
        return ("tray_easy", "tray_hard")

    def tasks(self, suite):
        return (TaskRef(suite, 0, "tidy", Path("tidy.bddl")),)


TRAY = Tray()


@pytest.fixture(autouse=True)
def caches():
    yield
    world._installed.cache_clear()
    world.world_named.cache_clear()


@pytest.fixture
def installed(monkeypatch):
    def install(*entries):
        monkeypatch.setattr(world, "entry_points", lambda group: list(entries) if group == GROUP else [])
        world._installed.cache_clear()
        world.world_named.cache_clear()

    return install


@pytest.fixture
def tray(monkeypatch):
    """A world of this module's own, under whatever name the collector gave the module."""
    entry = EntryPoint("tray", "nowhere:TRAY", GROUP)
    plain = EntryPoint.load
    monkeypatch.setattr(EntryPoint, "load", lambda self: TRAY if self.name == "tray" else plain(self))
    return entry


def problem(act, *arguments):
    with pytest.raises(OntoError) as raised:
        act(*arguments)
    (found,) = raised.value.problems
    return found


def test_a_suite_leads_to_its_world(installed, tray):
    installed(LIBERO, tray)
    assert {"libero_goal", "tray_easy", "tray_hard"} <= set(suites())
    found, ref = named_task("tray_hard/tidy")
    assert (found, ref.suite, ref.index) == (TRAY, "tray_hard", 0)
    found, ref = named_task("libero_goal/8")
    assert (found.name, ref.name) == ("libero", "put_the_bowl_on_the_plate")


def test_an_unknown_suite_lists_those_of_every_world_and_a_near_one(installed, tray):
    installed(LIBERO, tray)
    found = problem(named_task, "tray_esay/0")
    assert found.code == "SIM011"
    assert found.hint.startswith("did you mean `tray_easy`?; libero: libero_")
    assert found.hint.endswith("; tray: tray_easy, tray_hard")


@pytest.mark.parametrize("value", ["no_such_module:WORLD", "runtime.worlds.world:NO_SUCH_NAME"])
def test_a_world_that_cannot_be_loaded_leaves_the_others_working_and_says_why(installed, value):
    installed(EntryPoint("kitchen", value, GROUP), LIBERO)
    assert named_task("libero_goal/8")[0].name == "libero"
    assert "libero_goal" in suites()
    for suite in ("kitchen", "kitchen_10"):
        found = problem(world_of, suite)
        assert found.code == "RUN015"
        assert value.partition(":")[0] in found.message
    other = problem(world_of, "something")
    assert (other.code, "kitchen: the world `kitchen` cannot be loaded" in other.hint) == ("SIM011", True)


@pytest.mark.parametrize(("domain", "name"), [("tray", "tray"), ("robosuite", "libero"), ("igibson", "libero")])
def test_a_task_file_leads_to_the_world_of_its_domain(installed, tray, tmp_path, domain, name):
    installed(LIBERO, tray)
    path = tmp_path / "task.bddl"
    path.write_text(
        f"(define (problem p) (:domain {domain}) (:language a) (:fixtures t - t) (:objects a - b)"
        " (:obj_of_interest a) (:init (On a t)) (:goal (And (On a t))))"
    )
    found, ref = named_task(str(path))
    assert (found.name, ref.suite, ref.bddl) == (name, "", path)


def test_without_any_world_that_plays_it_a_task_file_is_refused(installed, tray, tmp_path):
    installed(tray)
    found = problem(named_task, str(tmp_path / "nothing.bddl"))
    assert (found.code, found.hint) == ("SIM011", "tray: tray_easy, tray_hard")
