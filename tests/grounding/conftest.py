from __future__ import annotations

import pytest


@pytest.fixture(scope="session")
def schema():
    from onto_compiler.compile_schema import load_schema

    return load_schema()


@pytest.fixture(scope="session")
def probe(schema):
    """Both groundings in states made for a task's goal."""
    from benchmarks.probing import Counts, probe

    return lambda suite, index, **counts: probe(suite, index, schema, Counts(**counts))
