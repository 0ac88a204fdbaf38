from __future__ import annotations

import pytest


@pytest.fixture(scope="session")
def schema():
    from onto_compiler.compile_schema import load_schema

    return load_schema()
