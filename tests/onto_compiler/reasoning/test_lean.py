"""Fewer facts, the same clashes: what is left out of a closure is what no axiom waits for."""

from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import NamedNode, RdfFormat, Store

from onto_compiler.reasoning.axioms import TYPE, disjoint_groups, read_axioms
from onto_compiler.reasoning.closure import close
from onto_compiler.reasoning.lean import contentious, lean, representatives
from onto_compiler.reasoning.reach import above, circles

HEAD = """@prefix : <https://e.org/> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
"""
edges = st.dictionaries(st.integers(0, 9), st.lists(st.integers(0, 9), max_size=3), max_size=10)


def of(text):
    store = Store()
    store.load((HEAD + text).encode(), format=RdfFormat.TURTLE)
    return store, read_axioms(store)


def instances(classes):
    return {(NamedNode(f"urn:some:{cls.value}"), TYPE, cls): () for cls in classes}


def walked(graph, node):
    found, waiting = {node}, [node]
    while waiting:
        further = set(graph.get(waiting.pop(), ())) - found
        found |= further
        waiting += further
    return found


@given(edges, st.sets(st.integers(0, 9)))
def test_above_is_what_a_walk_finds(graph, wanted):
    assert above(graph, wanted) == {node: walked(graph, node) & wanted for node in graph} | {
        node: walked(graph, node) & wanted for tos in graph.values() for node in tos
    }


@given(edges)
def test_a_circle_holds_what_leads_to_each_other_and_comes_behind_what_it_leads_to(graph):
    found = circles(graph)
    place = {node: number for number, circle in enumerate(found) for node in circle}
    for one, two in combinations(place, 2):
        assert (place[one] == place[two]) == (two in walked(graph, one) and one in walked(graph, two))
    assert all(place[to] <= place[node] for node, tos in graph.items() for to in tos)


@given(
    st.sets(st.tuples(st.integers(0, 7), st.integers(0, 7))), st.sets(st.tuples(st.integers(0, 7), st.integers(0, 7)))
)
def test_stand_ins_clash_where_some_class_does(under, apart):
    text = "".join(f":C{a} rdfs:subClassOf :C{b} . " for a, b in under)
    text += "".join(f":C{a} owl:disjointWith :C{b} . " for a, b in apart)
    _, axioms = of(text)
    classes = [NamedNode(f"https://e.org/C{number}") for number in range(8)]
    upper = contentious(axioms, classes)
    full = close(axioms, (), instances(classes))
    short = close(lean(axioms), (), instances(representatives(axioms, upper, classes)))
    assert bool(full.clashes) == bool(short.clashes)
    held = {clash.about.value.removeprefix("urn:some:") for clash in full.clashes}
    clashing = [upper[NamedNode(clash.about.value.removeprefix("urn:some:"))] for clash in short.clashes]
    assert held <= {cls.value for cls in classes if any(upper[cls] <= one for one in clashing)}


@pytest.mark.parametrize("depth", [10, 1000])
def test_a_chain_of_classes_costs_a_fact_or_two(depth):
    chain = "".join(f":C{number} rdfs:subClassOf :C{number - 1} . " for number in range(1, depth))
    _, axioms = of(chain + ":C0 owl:disjointWith :D .")
    classes = [NamedNode(f"https://e.org/C{number}") for number in range(depth)]
    upper = contentious(axioms, classes)
    closure = close(lean(axioms), (), instances(representatives(axioms, upper, classes)))
    assert len(closure.premises) <= 2


def test_a_list_of_disjoint_classes_is_kept_as_one_group():
    members = " ".join(f":C{number}" for number in range(500))
    store, axioms = of(f"[] a owl:AllDisjointClasses ; owl:members ( {members} ) .")
    (group,) = disjoint_groups(store)
    assert len(group) == 500
    assert all(found[0][0] == group and len(found) == 1 for found in axioms.disjoint.values())
