"""The rule base: SHACL Advanced Features rules (``sh:SPARQLRule``), run by Oxigraph over any store that holds the TBox.

A rule fires for the instances of its shape's target class (SHACL-AF, section 8). Rules run in ascending ``sh:order``;
what one order concludes, the next can read. Nothing here knows what a rule says.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import cast

from pyoxigraph import NamedNode, Quad, QuerySolutions, QueryTriples, Store, Triple

from onto_compiler.problems import OntoError
from onto_compiler.rdf import prologue

__all__ = ["Rule", "apply_rules", "read_rules"]

_RULES = """
SELECT ?this ?label ?order ?construct ?target ?prefix ?namespace WHERE {
    ?shape sh:targetClass ?target ; sh:rule ?this .
    ?this a sh:SPARQLRule ; sh:construct ?construct .
    OPTIONAL { ?this sh:order ?order } OPTIONAL { ?this rdfs:label ?label }
    OPTIONAL { ?this sh:prefixes/sh:declare [ sh:prefix ?prefix ; sh:namespace ?namespace ] }
} ORDER BY ?order ?this ?target ?prefix"""
_FOCUS = "SELECT DISTINCT ?this WHERE { ?this a/rdfs:subClassOf* ?target }"


@dataclass(frozen=True, slots=True)
class Rule:
    """One SPARQL rule: ``query`` is its CONSTRUCT with the declared prefixes in front."""

    iri: str
    label: str
    order: float
    target: str  # class IRI
    query: str


def read_rules(store: Store) -> tuple[Rule, ...]:
    """Every SPARQL rule in ``store``, in the order in which they run."""
    prefixes: dict[tuple[str, str], set[tuple[str, str]]] = {}
    bodies: dict[tuple[str, str], tuple[str, float, str]] = {}
    solutions = cast("QuerySolutions", store.query(prologue() + _RULES, use_default_graph_as_union=True))
    for row in solutions:
        key = (row["this"].value, row["target"].value)
        label = row["label"].value if row["label"] is not None else row["this"].value
        order = float(row["order"].value) if row["order"] is not None else 0.0
        bodies[key] = (label, order, row["construct"].value)
        declared = prefixes.setdefault(key, set())
        if row["prefix"] is not None:
            declared.add((row["prefix"].value, row["namespace"].value))
    rules = [
        Rule(
            iri=iri,
            label=label,
            order=order,
            target=target,
            query="".join(f"PREFIX {p}: <{ns}>\n" for p, ns in sorted(prefixes[iri, target])) + construct,
        )
        for (iri, target), (label, order, construct) in bodies.items()
    ]
    return tuple(sorted(rules, key=lambda rule: (rule.order, rule.iri, rule.target)))


def apply_rules(
    store: Store, rules: Sequence[Rule], graph: NamedNode, focus: Iterable[NamedNode] | None = None
) -> list[Triple]:
    """Run ``rules`` over all graphs of ``store``, add what they conclude to ``graph`` and return it.

    ``focus`` restricts the nodes that may fire; by default all instances of each rule's target class do.

    Raises:
        OntoError: RUN001, where a rule is not a SPARQL CONSTRUCT query.
    """
    allowed = None if focus is None else set(focus)
    concluded: list[Triple] = []
    for order in sorted({rule.order for rule in rules}):
        fresh = [
            triple
            for rule in rules
            if rule.order == order
            for triple in _construct(store, rule, _instances(store, rule.target, allowed))
        ]
        store.extend(Quad(t.subject, t.predicate, t.object, graph) for t in fresh)
        concluded += fresh
    return concluded


def _instances(store: Store, target: str, allowed: set[NamedNode] | None) -> list[NamedNode]:
    query = _FOCUS.replace("?target", f"<{target}>")
    rows = cast("QuerySolutions", store.query(prologue() + query, use_default_graph_as_union=True))
    nodes = [row["this"] for row in rows]
    return [node for node in nodes if isinstance(node, NamedNode) and (allowed is None or node in allowed)]


def _construct(store: Store, rule: Rule, focus: Sequence[NamedNode]) -> list[Triple]:
    if not focus:
        return []
    # A trailing VALUES block is SPARQL's own way to hand in bindings: one query for all focus nodes.
    query = f"{rule.query}\nVALUES ?this {{ {' '.join(map(str, focus))} }}"
    try:
        return list(cast("QueryTriples", store.query(query, use_default_graph_as_union=True)))
    except SyntaxError as error:
        raise OntoError.of("RUN001", f"rule {rule.iri} is no SPARQL CONSTRUCT query: {error}") from error
