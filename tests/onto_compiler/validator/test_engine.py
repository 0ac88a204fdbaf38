"""The engine finds the same, in the same words, by the queries of the implications and by their Python forms."""

from dataclasses import replace
from pathlib import Path

import pytest
from pyoxigraph import Literal, Quad

from onto_compiler.rdf import SH, node
from onto_compiler.shapes import compile_shapes, validate
from onto_compiler.sources import load_store
from onto_compiler.validator.engine import with_implications

CHECK = Path(__file__).parents[1] / "check"
IMPLIED = ("abx001", "abx002", "abx003")  # what the implications are about; the other files break other constraints
FILES = [*sorted((CHECK / "broken").glob("abx*.ttl")), CHECK / "good" / "episode.ttl"]


def queries(shapes):
    """How many constraints of the ABox shapes run as SPARQL."""
    return sum(
        check.find.__module__.endswith("shacl.sparql")
        for shape in shapes.known.values()
        for check in shape.checks
        if getattr(check, "component", "") == "SPARQLConstraintComponent"
    )


def test_there_are_examples():
    assert sum(file.stem.startswith(IMPLIED) for file in FILES) >= 5


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_both_forms_find_the_same(file):
    store = load_store([file])
    shapes = compile_shapes(store)
    shapes = shapes.only({shape.iri for shape in shapes.roots if queries(replace(shapes, known={shape.iri: shape}))})
    found = validate(store, shapes)
    assert sorted(validate(store, with_implications(shapes)), key=str) == sorted(found, key=str)
    if file.stem.startswith(IMPLIED):
        assert found


def test_no_shipped_implication_runs_as_a_query():
    shapes = compile_shapes(load_store())
    assert queries(shapes) == 6
    assert queries(with_implications(shapes)) == 0


def test_a_changed_query_runs_as_it_is_written():
    store = load_store()
    (quad,) = [
        q for q in store.quads_for_pattern(None, node(SH + "select"), None, None) if "core:admits" in q.object.value
    ]
    store.remove(quad)
    changed = Literal(quad.object.value.replace("core:admits", "core:supports"))
    store.add(Quad(quad.subject, quad.predicate, changed, quad.graph_name))
    assert queries(with_implications(compile_shapes(store))) == 2, "with the other query of its shape"
