"""A function over processes: results, errors, and the death of a process."""

import os
import signal

import pytest

from onto_compiler.pool import WorkerDiedError, map_over_processes
from onto_compiler.problems import OntoError


def process_of(number):
    return os.getpid(), number * number


def refuse(number):
    raise OntoError.of("CLI002", f"{number} is refused")


def die(_number):
    os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.parametrize("jobs", [1, 2])
def test_every_item_comes_with_its_result(jobs):
    found = list(map_over_processes(process_of, [2, 3, 2], jobs))
    assert sorted((item, square) for item, (_, square) in found) == [(2, 4), (2, 4), (3, 9)]
    assert (os.getpid() in {process for _, (process, _) in found}) is (jobs == 1)


def test_a_single_item_runs_here_unless_it_must_run_apart():
    ((_, (here, _)),) = map_over_processes(process_of, [1], 4)
    ((_, (there, _)),) = map_over_processes(process_of, [1], 1, apart=True)
    assert here == os.getpid() != there


def test_a_problem_of_an_item_reaches_the_caller():
    with pytest.raises(OntoError, match="7 is refused"):
        list(map_over_processes(refuse, [7], 1, apart=True))


def test_a_process_that_dies_is_a_problem_with_a_code_of_its_own():
    with pytest.raises(WorkerDiedError) as raised:
        list(map_over_processes(die, [1, 2], 2))
    assert [problem.code for problem in raised.value.problems] == ["CLI007"]


def test_nothing_gives_nothing():
    assert list(map_over_processes(process_of, [], 4, apart=True)) == []
