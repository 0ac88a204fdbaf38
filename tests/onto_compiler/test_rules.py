"""The rule base gives one answer, whoever runs it: pySHACL, Oxigraph, or the compiled tables."""

from itertools import product

import pyshacl
import pytest
from pyoxigraph import NamedNode, Quad, RdfFormat, Store
from rdflib import RDF, Graph, Literal, URIRef

import ontology
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError
from onto_compiler.rdf import CORE, MAN, NAV
from onto_compiler.rules import apply_rules, read_rules
from onto_compiler.sources import load_store
from onto_compiler.tables import ATTEMPT_STATUSES, FIRST, LEVELS, STATUSES, compile_tables

CONCLUDED = [
    URIRef(CORE + name) for name in ("failureClass", "diagnosedBy", "priority", "route", "decision", "routedBy")
]
CASE = "urn:test:"


def core(name):
    return URIRef(CORE + name)


@pytest.fixture(scope="module")
def tbox():
    graph = Graph()
    for path in ontology.turtle_files():
        graph.parse(path)
    return graph


def cases(schema, *, pairs=False):
    """One observed fact per predicate, polarity and status, and one failure per way in which a route is asked for.

    With ``pairs``, fewer failures: every predicate meets every failure, and each of the two every way.
    """
    graph, observed, failed = Graph(), {}, {}
    for number, key in enumerate(product(sorted(schema.predicates), (True, False), STATUSES)):
        node = URIRef(f"{CASE}observed:{number}")
        fact = URIRef(f"{node}:fact")
        graph.add((fact, core("predicate"), URIRef(key[0])))
        graph.add((fact, core("polarity"), Literal(key[1])))
        graph.add((node, RDF.type, core("ObservedFact")))
        graph.add((node, core("fact"), fact))
        graph.add((node, core("status"), URIRef(key[2])))
        observed[node] = key
    ways = []
    for vocabulary in (MAN, NAV):  # no fact of one is sent to a route of the other
        predicates, failures, ours = (
            [iri for iri in sorted(terms) if iri.startswith(vocabulary)]
            for terms in (schema.predicates, schema.failures, schema.routes)
        )
        routes = [(None, level) for level in LEVELS] + [(iri, schema.routes[iri].level) for iri in ours]
        asked = [way for way in product(ATTEMPT_STATUSES, routes) if (way[0] == FIRST) == (way[1][0] is None)]
        stride = min(len(predicates), len(failures)) if pairs else 1
        ways += [
            (predicate, failure, status, *route)
            for (p, predicate), (f, failure), (a, (status, route)) in product(
                *map(enumerate, (predicates, failures, asked))
            )
            if (p + f + a) % stride == 0
        ]
    for level, other in (
        ("state", "pick_and_place"),
        ("action", "object_relation_predicate"),
        ("plan", "rack_contact_site"),
    ):
        ways += [(MAN + "on", f, ATTEMPT_STATUSES[2], MAN + other, level) for f in schema.failures if f.startswith(MAN)]
    for number, key in enumerate(ways):
        node = URIRef(f"{CASE}failed:{number}")
        fact = URIRef(f"{node}:fact")
        graph.add((fact, core("predicate"), URIRef(key[0])))
        graph.add((node, RDF.type, URIRef(key[1])))
        graph.add((node, core("failureClass"), URIRef(key[1])))
        graph.add((node, core("fact"), fact))
        graph.add((node, core("attemptStatus"), URIRef(key[2])))
        if key[3] is not None:
            graph.add((node, core("previousRoute"), URIRef(key[3])))
        graph.add((node, core("requestedLevel"), URIRef(LEVELS[key[4]])))
        failed[node] = key
    return graph, observed, failed


def conclusions(triples, given):
    # pySHACL may answer with a dataset, whose members are quads.
    return {t[:3] for t in triples if t[1] in CONCLUDED and str(t[0]).startswith(CASE)} - set(given)


def by_oxigraph(given):
    store = load_store()
    graph = NamedNode("urn:test:graph")
    store.load(input=given.serialize(format="nt").encode(), format=RdfFormat.N_TRIPLES, to_graph=graph)
    apply_rules(store, read_rules(store), graph)
    found = Graph()
    rows = b"\n".join(
        f"{q.subject} {q.predicate} {q.object} .".encode() for q in store.quads_for_pattern(None, None, None, graph)
    )
    found.parse(data=rows, format="nt")
    return conclusions(found, given)


def test_oxigraph_concludes_what_pyshacl_concludes(tbox, queries_parsed_once):
    given, observed, failed = cases(load_knowledge().schema, pairs=True)
    expanded = pyshacl.shacl_rules(tbox + given, shacl_graph=tbox, advanced=True, iterate_rules=False)
    expected = conclusions(expanded, given)
    assert by_oxigraph(given) == expected
    assert len(observed) == (9 + 3 + 4) * 2 * 4
    for parts in ((0, 1), (0, 2, 3, 4), (1, 2, 3, 4)):
        every = {tuple(key[part] for part in parts) for key in cases(load_knowledge().schema)[2].values()}
        assert {tuple(key[part] for part in parts) for key in failed.values()} == every
    assert len(expected) > 500


def test_tables_hold_what_oxigraph_concludes():
    given, observed, failed = cases(load_knowledge().schema)
    expected = by_oxigraph(given)
    assert len(failed) == 9 * 5 * (3 + 2 * 8) + 3 * 5 * (3 + 2 * 4) + 3 * 5
    assert len(expected) > 1000
    tables = load_knowledge().tables
    from_tables = set()
    for node, key in observed.items():
        if key in tables.diagnosis:
            entry = tables.diagnosis[key]
            from_tables.add((node, core("failureClass"), URIRef(entry.failure)))
            from_tables.add((node, core("diagnosedBy"), URIRef(entry.rule)))
            from_tables.add((node, core("priority"), Literal(entry.priority)))
    produced = {(predicate, entry.failure) for (predicate, _, _), entry in tables.diagnosis.items()}
    reachable = {node: key for node, key in failed.items() if key[:2] in produced}
    assert {key[4] for key in reachable.values()} == set(LEVELS)
    for node, key in reachable.items():
        if key in tables.routing:
            entry = tables.routing[key]
            from_tables.add((node, core("route"), URIRef(entry.route)))
            from_tables.add((node, core("decision"), URIRef(entry.decision)))
            from_tables.add((node, core("routedBy"), URIRef(entry.rule)))
    relevant = {t for t in expected if t[0] in observed or t[0] in reachable}
    assert from_tables == relevant


def test_every_unsatisfied_status_is_diagnosed_and_every_diagnosis_is_routed():
    knowledge = load_knowledge()
    tables, schema = knowledge.tables, knowledge.schema
    for predicate, polarity, status in product(schema.predicates, (True, False), STATUSES[1:]):
        failure = tables.diagnosis[predicate, polarity, status].failure
        for level in ("plan",) if predicate.startswith(NAV) else ("state", "action"):
            assert (predicate, failure, FIRST, None, level) in tables.routing
        for attempt, previous, level in product(ATTEMPT_STATUSES[1:], schema.routes, LEVELS):
            entry = tables.routing.get((predicate, failure, attempt, previous, level))
            if entry is not None:
                route = schema.routes[entry.route]
                assert route.level == level
                assert failure in route.admits
                assert any(schema.is_a(schema.predicates[predicate].kind, kind) for kind in route.supports)


@pytest.mark.parametrize("status", STATUSES[:1])
def test_a_satisfied_fact_is_not_diagnosed(status):
    knowledge = load_knowledge()
    keys = product(knowledge.schema.predicates, (True, False), (status,))
    assert not any(key in knowledge.tables.diagnosis for key in keys)


def test_the_router_table_of_the_paper():
    tables = load_knowledge().tables
    expected = {
        "in_region": ("RelationMissing", "source_joint_pose"),
        "joint_state": ("JointState", "source_joint_pose"),
        "on": ("RelationMissing", "object_relation_predicate"),
        "inside": ("RelationMissing", "object_relation_predicate"),
        "right_of": ("RelationMissing", "object_relation_predicate"),
        "left_of": ("RelationMissing", "object_relation_predicate"),
        "front_of": ("RelationMissing", "object_relation_predicate"),
        "back_of": ("RelationMissing", "object_relation_predicate"),
        "contact": ("RackContact", "rack_contact_site"),
    }
    for predicate, (failure, route) in expected.items():
        key = (MAN + predicate, MAN + failure)
        assert tables.routing[(*key, FIRST, None, "state")].route == MAN + route
        rejected = tables.routing[(*key, CORE + "RepeatAttempt", MAN + route, "state")]
        assert (rejected.route, rejected.decision) == (MAN + "source_joint_residual", CORE + "Reroute")
        again = tables.routing[(*key, CORE + "RepeatAttempt", MAN + "source_joint_residual", "state")]
        assert (again.route, again.decision) == (MAN + "source_joint_residual", CORE + "Retry")


def test_where_an_unmet_fact_of_navigation_is_sent():
    tables = load_knowledge().tables
    expected = {
        ("at_target", "Absent"): ("EntityMissing", "longer_horizon", "waypoint"),
        ("at_target", "ExplicitlyFalse"): ("EntityMissing", "longer_horizon", "waypoint"),
        ("at_target", "MarginViolated"): ("TargetDistance", "resample_around_margin", "waypoint"),
        ("velocity_matches", "ExplicitlyFalse"): ("VelocityMismatch", "match_velocity", "match_velocity"),
        ("velocity_matches", "MarginViolated"): ("VelocityMismatch", "match_velocity", "match_velocity"),
        ("free_of", "ExplicitlyFalse"): ("InvalidState", "resample_around_margin", "waypoint"),
        ("free_of", "MarginViolated"): ("InvalidState", "resample_around_margin", "waypoint"),
    }
    for (predicate, status), (failure, first, then) in expected.items():
        assert tables.diagnosis[NAV + predicate, True, CORE + status].failure == NAV + failure
        key = (NAV + predicate, NAV + failure)
        assert tables.routing[(*key, FIRST, None, "plan")].route == NAV + first
        assert tables.routing[(*key, CORE + "RepeatAttempt", NAV + first, "plan")].route == NAV + then
        exhausted = tables.routing.get((*key, CORE + "ExhaustedAttempt", NAV + then, "plan"))
        # What has no successor is done when its candidates are; the last of a chain returns to the first.
        assert exhausted is None if first == then else exhausted.route == NAV + first


def test_a_rejected_action_is_retried_within_its_route_until_no_candidate_is_left():
    tables, schema = load_knowledge().tables, load_knowledge().schema
    first = {key: entry for key, entry in tables.routing.items() if key[2] == FIRST and key[4] == "action"}
    assert {entry.route for entry in first.values()} == {
        MAN + name for name in ("move_joint", "pick_and_place", "place_in_region", "place_on_rack")
    }
    for (predicate, failure, _, _, level), entry in first.items():
        again = tables.routing[predicate, failure, CORE + "RepeatAttempt", entry.route, level]
        assert (again.route, again.decision) == (entry.route, CORE + "Retry")
        assert (predicate, failure, CORE + "ExhaustedAttempt", entry.route, level) not in tables.routing
        assert schema.routes[entry.route].on_rejection is None


def test_routes_of_one_level_are_all_that_a_run_of_this_level_is_sent_to():
    tables, schema = load_knowledge().tables, load_knowledge().schema
    assert {key[4] for key in tables.routing} == set(LEVELS)
    assert {key[4] for key in tables.routing if key[0].startswith(MAN)} == {"state", "action"}
    assert {key[4] for key in tables.routing if key[0].startswith(NAV)} == {"plan"}
    assert all(schema.routes[entry.route].level == key[4] for key, entry in tables.routing.items())
    assert all(key[3] is None or schema.routes[key[3]].level == key[4] for key in tables.routing)


def test_rules_that_disagree_are_refused(tmp_path):
    rule = tmp_path / "contrary.ttl"
    rule.write_text(f"""
@prefix core: <{CORE}> .
@prefix man: <{MAN}> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
<urn:test:shape> a sh:NodeShape ; sh:targetClass core:ObservedFact ; sh:rule <urn:test:rule> .
<urn:test:rule> a sh:SPARQLRule ; sh:order 60 ; sh:construct '''
CONSTRUCT {{ $this <{CORE}failureClass> <{MAN}RackContact> ; <{CORE}diagnosedBy> <urn:test:rule> }}
WHERE {{ $this <{CORE}fact>/<{CORE}predicate> <{MAN}on> ; <{CORE}status> <{CORE}Absent> }}''' .
""")
    store = load_store([rule])
    with pytest.raises(OntoError, match="RUN002"):
        compile_tables(store, load_knowledge().schema)


def test_compiling_leaves_the_store_alone():
    store = load_store()
    before = set(store)
    compile_tables(store, load_knowledge().schema)
    assert set(store) == before


def test_focus_restricts_what_fires():
    store = Store()
    store.extend(iter(load_store()))
    graph = NamedNode("urn:test:graph")
    for name in ("a", "b"):
        node, fact = NamedNode(f"urn:test:{name}"), NamedNode(f"urn:test:{name}:fact")
        triples = [
            (node, str(RDF.type), NamedNode(CORE + "ObservedFact")),
            (node, CORE + "fact", fact),
            (node, CORE + "status", NamedNode(CORE + "Absent")),
            (fact, CORE + "predicate", NamedNode(MAN + "on")),
        ]
        store.extend(Quad(s, NamedNode(p), o, graph) for s, p, o in triples)
        store.load(input=f"<{fact.value}> <{CORE}polarity> true .".encode(), format=RdfFormat.TURTLE, to_graph=graph)
    concluded = apply_rules(store, read_rules(store), graph, [NamedNode("urn:test:a")])
    assert {t.subject.value for t in concluded} == {"urn:test:a"}
    assert len(concluded) == 3
