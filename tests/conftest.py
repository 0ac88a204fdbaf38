"""``slow`` tests are those that ``tests/slow.txt`` names: ``-m "not slow"`` is for the daily round, all for a merge.

The list is made by measuring. ``pytest --measure-slow``, alone or with ``-n``, writes it anew for the files that it
runs, in seconds of processor time of a test and of the processes that it started, which a busy machine hardly changes.
A name in the list that stands for no test is warned of, so that it cannot go stale unseen.
"""

from __future__ import annotations

import os
import resource
import sys
import warnings
from collections import defaultdict
from functools import cache
from pathlib import Path

import pytest
from hypothesis import settings

LIST = Path(__file__).with_name("slow.txt")
settings.register_profile("untimed", deadline=None)  # speed is measured in benchmarks, not by tests
settings.load_profile("untimed")
# Containers often forbid it, and then each process that a test starts would compile all our modules again.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
LIMIT = 1.0  # seconds of processor time of a function's tests, or of one set-up that others share
_HEAD = "# Made by `pytest --measure-slow`; see tests/conftest.py. A file stands for all its tests.\n"


def pytest_addoption(parser):
    parser.addoption("--measure-slow", action="store_true", help="write the tests that are slow to tests/slow.txt")


def function_of(nodeid):
    """A test's name without its parameters and its group."""
    return nodeid.partition("[")[0].partition("@")[0]


def listed():
    lines = LIST.read_text(encoding="utf-8").splitlines() if LIST.exists() else []
    return {line for line in lines if line and not line.startswith("#")}


def stale(names, items, root):
    """Names for which there is no file, or no such test in a file that was collected whole."""
    files = {function_of(item.nodeid).partition("::")[0] for item in items}
    functions = {function_of(item.nodeid) for item in items}
    return sorted(
        name
        for name in names
        if not (root / name.partition("::")[0]).is_file()
        or ("::" in name and name.partition("::")[0] in files and name not in functions)
    )


@pytest.hookimpl(tryfirst=True)  # before `-m` looks at the markers
def pytest_collection_modifyitems(config, items):
    names = listed()
    for item in items:
        function = function_of(item.nodeid)
        if function in names or function.partition("::")[0] in names:
            item.add_marker("slow")
    chosen_by_name = any("::" in argument for argument in config.args)
    if not chosen_by_name and (old := stale(names, items, config.rootpath)):
        warnings.warn(pytest.PytestWarning(f"tests/slow.txt names what is no test: {', '.join(old)}"), stacklevel=1)


def _processor_seconds():
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(each.ru_utime + each.ru_stime for each in used)


def _timed(item, phase):
    started = _processor_seconds()
    yield
    item.user_properties.append((f"cpu {phase}", _processor_seconds() - started))


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_setup(item):
    yield from _timed(item, "setup")


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_call(item):
    yield from _timed(item, "call")


@cache
def _translated(text, base, names):
    from rdflib.plugins.sparql.algebra import translateQuery
    from rdflib.plugins.sparql.parser import parseQuery

    return translateQuery(parseQuery(text), base, dict(names))


@pytest.fixture(scope="module")
def queries_parsed_once():
    """PySHACL, the oracle of many tests, asks a query once for each focus node, and rdflib would parse it each time."""
    from rdflib.plugins.sparql import processor

    def translated(text, base, names):
        return _translated(text, base, tuple((names or {}).items()))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(processor, "parseQuery", str)
        patch.setattr(processor, "translateQuery", translated)
        yield


class Measure:
    """Sums what tests took, in the process that reports, and writes the list at the end."""

    def __init__(self):
        self.setups, self.calls, self.files = defaultdict(float), defaultdict(float), set()

    def pytest_runtest_logreport(self, report):
        self.files.add(report.nodeid.partition("::")[0])
        if report.when == "teardown":  # by now the report has both
            took = dict(report.user_properties)
            name = function_of(report.nodeid)
            self.calls[name] += took.get("cpu call", 0.0)
            file = name.partition("::")[0]
            self.setups[file] = max(self.setups[file], took.get("cpu setup", 0.0))

    def slow(self):
        files = {file for file, seconds in self.setups.items() if seconds >= LIMIT}
        tests = {name for name, seconds in self.calls.items() if seconds >= LIMIT}
        return files | {name for name in tests if name.partition("::")[0] not in files}

    def pytest_sessionfinish(self):
        others = {name for name in listed() if name.partition("::")[0] not in self.files}
        LIST.write_text(_HEAD + "".join(f"{name}\n" for name in sorted(others | self.slow())), encoding="utf-8")


def pytest_configure(config):
    if config.getoption("--measure-slow") and not hasattr(config, "workerinput"):
        config.pluginmanager.register(Measure())
