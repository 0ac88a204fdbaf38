"""Nodes stand behind what leads to them, and the order of a column avoids crossings."""

from hypothesis import given
from hypothesis import strategies as st

from onto_compiler.reference.layers import crossings, layers, ordered

NAMES = [f"n{i}" for i in range(8)]
EDGES = st.lists(st.tuples(st.sampled_from(NAMES), st.sampled_from(NAMES)), max_size=20, unique=True)


@given(EDGES)
def test_without_cycles_every_edge_leads_to_a_later_layer(edges):
    forward = [(a, b) for a, b in edges if a < b]
    depth = layers(NAMES, forward)
    assert all(depth[a] < depth[b] for a, b in forward)
    assert all(depth[name] == 0 for name in NAMES if name not in {b for _, b in forward})


@given(EDGES)
def test_a_cycle_ends_too(edges):
    depth = layers(NAMES, edges)
    assert set(depth) == set(NAMES)
    assert all(0 <= d < len(NAMES) for d in depth.values())


@given(EDGES)
def test_ordering_keeps_the_columns_and_never_adds_a_crossing(edges):
    forward = [(a, b) for a, b in edges if a < b]
    depth = layers(NAMES, forward)
    before = [[n for n in NAMES if depth[n] == i] for i in range(max(depth.values()) + 1)]
    after = ordered(before, forward)
    assert [sorted(column) for column in after] == [sorted(column) for column in before]
    assert crossings(after, forward) <= crossings(before, forward)


def test_a_crossing_that_can_be_avoided_is_avoided():
    edges = [("a", "y"), ("b", "x")]
    assert crossings([["a", "b"], ["x", "y"]], edges) == 1
    assert crossings(ordered([["a", "b"], ["x", "y"]], edges), edges) == 0
