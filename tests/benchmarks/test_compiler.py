"""The registry of LIBERO-Plus resolves."""

import pytest

from benchmarks.registry import SUITES, registry
from onto_compiler.problems import OntoError


@pytest.fixture(scope="module")
def tasks():
    try:
        return registry()
    except OntoError as error:
        pytest.skip(f"the package index cannot be reached: {error}")


def test_every_registered_name_stands_for_a_file_and_its_perturbation_is_known(tasks):
    assert len(tasks) == sum(SUITES.values()) == 10_030
    assert [task.name for task in tasks if task.file is None or not task.known] == []
    assert len({task.file for task in tasks}) == 5_320


def test_a_name_that_holds_a_perturbations_word_of_its_own_is_read_from_the_right(tasks):
    named = [task for task in tasks if "_from_table_center_" in task.name]
    assert len(named) > 100
    assert {task.file.stem.partition("_and_")[0] for task in named} == {"pick_up_the_black_bowl_from_table_center"}
