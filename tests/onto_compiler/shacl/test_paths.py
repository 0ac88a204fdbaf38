"""Paths lead where Oxigraph's SPARQL paths lead, and are described as they were read."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import NamedNode, RdfFormat, Triple, parse

from onto_compiler.shacl.graph import Graph
from onto_compiler.shacl.paths import Path, describe, follow, read_path, sparql_path

NODES = [NamedNode(f"urn:{name}") for name in "abcd"]
PREDICATES = [NamedNode(f"urn:{name}") for name in "pq"]
TRIPLES = st.lists(
    st.builds(Triple, st.sampled_from(NODES), st.sampled_from(PREDICATES), st.sampled_from(NODES)), max_size=8
)
SIMPLE = st.sampled_from(PREDICATES).map(lambda iri: Path("predicate", iri))
PATHS = st.recursive(
    SIMPLE,
    lambda inner: st.one_of(
        st.builds(
            lambda kind, part: Path(kind, parts=(part,)),
            st.sampled_from(["inverse", "star", "plus", "optional"]),
            inner,
        ),
        st.builds(
            lambda kind, parts: Path(kind, parts=tuple(parts)),
            st.sampled_from(["sequence", "alternative"]),
            st.lists(inner, min_size=2, max_size=3),
        ),
    ),
    max_leaves=5,
)


@given(TRIPLES, PATHS, st.sampled_from(NODES))
def test_a_path_leads_where_sparql_leads(triples, path, node):
    # Oxigraph knows no path of length zero from a node that stands in no triple.
    graph = Graph([*triples, *(Triple(one, NamedNode("urn:other"), one) for one in NODES)])
    answer = graph.store.ask(f"SELECT DISTINCT ?v WHERE {{ {node} {sparql_path(path)} ?v }}")
    assert set(follow(graph, node, path)) == {value for (value,) in answer.rows}


@given(PATHS)
def test_what_is_described_reads_back(path):
    node, triples = describe(path)
    assert read_path(Graph(triples), node) == path


@pytest.mark.parametrize("text", ['"p"', "[]", "[ sh:inversePath [] ]", "[ sh:alternativePath () ]", "_:x"])
def test_what_is_no_path_is_none(text):
    turtle = f"@prefix sh: <http://www.w3.org/ns/shacl#> . <urn:s> sh:path {text} . _:x sh:inversePath _:x ."
    graph = Graph(parse(turtle.encode(), format=RdfFormat.TURTLE))
    (node,) = graph.objects(NamedNode("urn:s"), NamedNode("http://www.w3.org/ns/shacl#path"))
    assert read_path(graph, node) is None
