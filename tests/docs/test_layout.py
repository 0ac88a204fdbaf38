"""The rules of the layout, held over every import of the tree, at run time and for types."""

import pytest

from benchmarks.house_imports import (
    Import,
    import_circles,
    imports,
    naming_tasks_of,
    upward_imports,
    world_leaks,
)


@pytest.fixture(scope="module")
def found():
    return imports()


def test_no_module_imports_what_imports_it(found):
    assert import_circles(found) == []


def test_packages_import_one_way(found):
    assert upward_imports(found) == []


def test_a_world_and_its_simulator_are_imported_by_nobody_else(found):
    assert world_leaks(found) == []


def test_every_import_of_the_tree_was_read(found):
    read = {(each.module, each.target) for each in found}
    assert ("runtime.worlds.libero.world", "runtime.worlds.world") in read  # at the head of a module
    assert ("runtime.worlds.libero.world", "runtime.worlds.libero.loop.environment") in read  # within a function
    assert ("runtime.worlds.world", "runtime.worlds.environment") in read  # for types alone
    assert ("runtime.worlds.libero.simulator.native_import", "robosuite.utils.errors") in read  # by its name


@pytest.mark.parametrize(
    ("module", "target", "leaks"),
    [
        ("runtime.loop.correction", "runtime.worlds.libero.world", True),
        ("runtime.worlds.pointmaze.maze", "runtime.worlds.libero.world", True),
        ("runtime.worlds.world", "runtime.worlds.libero.world", True),
        ("runtime.commands.inspect", "libero.libero.envs", True),
        ("grounding.scenes", "robosuite", True),
        ("runtime.worlds.pointmaze.maze", "robosuite.models", True),
        ("runtime.worlds.libero.world", "runtime.worlds.world", False),
        ("runtime.worlds.libero.simulator.native", "robosuite.models", False),
        ("benchmarks.skills", "runtime.worlds.libero.world", False),
        ("runtime.commands.inspect", "runtime.worlds.world", False),
    ],
)
def test_what_a_leak_is(module, target, leaks):
    assert bool(world_leaks([Import(module, target, 1)])) is leaks


def test_circles_and_upward_imports_are_found():
    ring = [Import("onto_compiler.a", "grounding.b", 3), Import("grounding.b", "onto_compiler.a", 7)]
    assert import_circles(ring) == ["grounding.b <-> onto_compiler.a"]
    assert upward_imports(ring) == ["onto_compiler.a:3 imports grounding.b"]


def test_a_new_world_touches_no_other_file():
    assert naming_tasks_of("robosuite") == []
    assert "runtime/commands/inspect.py" in naming_tasks_of("libero")  # its help has examples
