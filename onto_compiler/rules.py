"""The rule base: SHACL Advanced Features rules over any store that holds the TBox (SHACL-AF, section 8).

A rule fires for the targets of its shape. Rules run in ascending ``sh:order``; what one order concludes, the next can
read. Nothing here knows what a rule says. A SPARQL rule for the instances of a class is asked once for all of them; any
other rule (a triple rule, one with conditions) runs on :mod:`onto_compiler.shacl.rules`, node by node.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import cast

from pyoxigraph import NamedNode, Quad, QuerySolutions, QueryTriples, Store, Triple

from onto_compiler.placed import placed
from onto_compiler.problems import OntoError
from onto_compiler.rdf import RDF, RDFS, node, prologue
from onto_compiler.shacl.graph import Graph
from onto_compiler.shacl.model import ShapeFault
from onto_compiler.shacl.prebinding import is_joined
from onto_compiler.shacl.rules import GraphRule, RuleBase, read_rule_base
from onto_compiler.terms import text_of

__all__ = ["Rule", "apply_rules", "read_rules"]

_TYPING = {node(RDF + "type"), node(RDFS + "subClassOf")}
_FOCUS = "SELECT DISTINCT ?this WHERE { ?this a/rdfs:subClassOf* ?target }"


@dataclass(frozen=True, slots=True)
class Rule:
    """One rule for one target class; ``query`` is the CONSTRUCT of a SPARQL rule with the declared prefixes in front.

    ``general`` is the rule as the general engine runs it, where it is not asked of all instances at once.
    """

    iri: str
    label: str
    order: float
    target: str  # class IRI; empty if the targets are no classes
    query: str
    shape_order: float = 0.0
    general: RuleBase | None = None


def read_rules(store: Store, graph: Graph | None = None) -> tuple[Rule, ...]:
    """Every rule in ``store`` that is not deactivated, in the order in which they run.

    ``graph`` is the store as a graph, where a caller has read it already.

    Raises:
        OntoError: SHP002 if a rule is of a kind that is not known or lacks a part; QRY001 to QRY003 if its
            query must not be run.
    """
    graph = Graph.of_store(store) if graph is None else graph
    try:
        base = read_rule_base(graph)
    except ShapeFault as fault:
        raise placed(store, fault) from fault
    rules = [rule for one in base.rules for rule in _rules(graph, base, one)]
    return tuple(sorted(rules, key=lambda rule: (rule.shape_order, rule.order, rule.iri, rule.target)))


def _rules(graph: Graph, base: RuleBase, one: GraphRule) -> Iterator[Rule]:
    """A batched rule for each of its classes, or else one rule with all its targets."""
    shape_order, order = one.order
    labels = graph.objects(one.iri, node(RDFS + "label"))
    label = text_of(next(iter(labels), one.iri))
    classes = [text_of(target.term) for target in one.targets if target.kind == "class"]
    if one.text and not one.conditions and len(classes) == len(one.targets) and is_joined(one.text, "this"):
        yield from (Rule(text_of(one.iri), label, order, cls, one.text, shape_order) for cls in classes)
    else:
        alone = RuleBase((one,), base.shapes)
        yield Rule(text_of(one.iri), label, order, next(iter(classes), ""), one.text, shape_order, alone)


def apply_rules(
    store: Store, rules: Sequence[Rule], graph: NamedNode, focus: Iterable[NamedNode] | None = None
) -> list[Triple]:
    """Run ``rules`` over all graphs of ``store``, add what they conclude to ``graph`` and return it.

    ``focus`` restricts the nodes that may fire; by default all instances of each rule's target class do.

    Raises:
        OntoError: RUN001 if a rule is not a SPARQL CONSTRUCT query; SHP002 if another rule cannot run.
    """
    allowed = None if focus is None else set(focus)
    concluded: list[Triple] = []
    known: dict[str, list[NamedNode]] = {}  # the instances of each target class, until a rule concludes a type
    for order in sorted({(rule.shape_order, rule.order) for rule in rules}):
        chosen = [rule for rule in rules if (rule.shape_order, rule.order) == order]
        fresh = [triple for rule in chosen if rule.general is None for triple in _batch(store, rule, allowed, known)]
        general = [rule.general for rule in chosen if rule.general is not None]
        if general:
            data = Graph.of_store(store)
            fresh += [triple for base in general for triple in base.conclude(data, allowed)]
        store.extend(Quad(t.subject, t.predicate, t.object, graph) for t in fresh)
        if any(triple.predicate in _TYPING for triple in fresh):
            known.clear()
        concluded += fresh
    return concluded


def _batch(store: Store, rule: Rule, allowed: set[NamedNode] | None, known: dict[str, list[NamedNode]]) -> list[Triple]:
    if rule.target not in known:
        known[rule.target] = _instances(store, rule.target, allowed)
    return _construct(store, rule, known[rule.target])


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
        raise OntoError.of("RUN001", f"rule {rule.iri} is not a SPARQL CONSTRUCT query: {error}") from error
