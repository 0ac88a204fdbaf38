"""The syntax of what a shapes graph holds beside shapes: prefixes, components, functions, targets and rules.

Source: SHACL, sections 5.2.1 and 6; SHACL-AF, sections 3, 5 and 8.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from pyoxigraph import Literal, NamedNode, Triple

from onto_compiler.rdf import RDF, SH
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.model import ShapeFault
from onto_compiler.shacl.reader import Reader
from onto_compiler.shacl.syntax import (
    BOOLEAN,
    IRI,
    NAMESPACE,
    NODE,
    NUMBER,
    SHAPE,
    STRING,
    TERM,
    TEXT,
    Rule,
    Triple3,
    broken,
    form_of,
)
from onto_compiler.terms import show, text_of

__all__ = ["NO_RULE", "declaration_faults", "rule_faults", "rule_kind"]

NO_RULE = "a sh:rule is neither a sh:TripleRule nor a sh:SPARQLRule"
_TYPE, _RULES, _JS_RULE = NamedNode(RDF + "type"), NamedNode(SH + "Rules"), NamedNode(SH + "JSRule")
_FORMS = {"ask": "ASK", "construct": "CONSTRUCT", "select": "SELECT"}
_OTHERS = (
    *("js", "values", "singleLine", "subsetOf", "someValue", "memberShape", "minListLength", "maxListLength"),
    *("uniqueMembers", "reifierShape", "reificationRequired", "rootClass", "nodeByExpression", "targetWhere"),
)
"""Parameters of SHACL-JS, of property value rules and of the drafts of SHACL 1.2."""
_DECLARATION = {
    "prefix": Rule(*STRING, single=True, required=True),
    "namespace": Rule(*NAMESPACE, single=True, required=True),
}
_PARAMETER = {
    "path": Rule(*IRI, single=True, required=True),
    "optional": Rule(*BOOLEAN, single=True),
    "order": Rule(*NUMBER, single=True),
}
_COMPONENT = {"parameter": Rule(*NODE, required=True), "labelTemplate": Rule(*TEXT)}
_FUNCTION = {"parameter": Rule(*NODE), "returnType": Rule(*IRI, single=True)}
_RULE = {
    "deactivated": Rule(*BOOLEAN, single=True),
    "order": Rule(*NUMBER, single=True),
    "condition": Rule(*SHAPE),
}
_TRIPLE_RULE = {
    **_RULE,
    **{name: Rule(*TERM, single=True, required=True) for name in ("subject", "predicate", "object")},
}
_SPARQL_RULE = {**_RULE, "construct": Rule(*STRING, single=True, required=True)}
Found = Iterator[tuple[ShapeFault, Triple3 | None]]


def declaration_faults(graph: Graph) -> Found:
    """Each fault, with the triple to leave out for it where something would else run that its author did not mean."""
    reader = Reader(graph)
    yield from _prefixes(reader)
    yield from _components(reader)
    yield from _forms(reader)
    for shape, values in graph.holders(NamedNode(SH + "target")).items():
        for target in values:
            yield from _target(reader, shape, target)
    yield from _not_run(reader)


def rule_faults(graph: Graph) -> Iterator[tuple[ShapeFault, Triple3]]:
    """Each fault of a rule, with the triple by which its shape has it."""
    reader = Reader(graph)
    for shape, rule in _values_of(reader, "rule"):
        triple = (shape, NamedNode(SH + "rule"), rule)
        yield from ((fault, triple) for fault in _rule(reader, shape, rule))


def _by_table(reader: Reader, node: Term, noun: str, table: Mapping[str, Rule]) -> Iterator[ShapeFault]:
    for name, rule in table.items():
        values = reader.values(node, name)
        if rule.required and not values:
            yield ShapeFault(f"{noun} has no sh:{name}", node)
        yield from (ShapeFault(said, node, name, value) for said, value in broken(reader, node, name, rule, values))


def _values_of(reader: Reader, name: str) -> Iterator[tuple[Term, Term]]:
    """The nodes that have sh:``name``, each with one of its values."""
    for holder, values in reader.graph.holders(NamedNode(SH + name)).items():
        yield from ((holder, value) for value in values)


def _prefixes(reader: Reader) -> Found:
    for name in ("declare", "prefixes"):
        for holder, value in _values_of(reader, name):
            if isinstance(value, (Literal, Triple)):
                yield ShapeFault(f"the value of sh:{name} must be a node that is described", holder, name, value), None
            elif name == "declare":
                yield from ((fault, None) for fault in _by_table(reader, value, "a sh:declare", _DECLARATION))
    reported = set[tuple[Term, str]]()
    for holder in reader.graph.holders(NamedNode(SH + "prefixes")):
        known: dict[str, str] = {}
        for declaration in sorted(reader.declarations(holder), key=lambda node: text_of(_namespace(reader, node))):
            prefix, namespace = reader.one(declaration, "prefix"), _namespace(reader, declaration)
            if prefix is None:
                continue
            other = known.setdefault(text_of(prefix), text_of(namespace))
            if other != text_of(namespace) and (declaration, other) not in reported:
                reported.add((declaration, other))
                here = f"`{text_of(prefix)}:` stands for <{text_of(namespace)}>"
                said = f"the prefix {here} here, and for <{other}> elsewhere"
                yield ShapeFault(said, declaration, "namespace", namespace), None


def _namespace(reader: Reader, declaration: Term) -> Term:
    return reader.one(declaration, "namespace") or Literal("")


def _components(reader: Reader) -> Found:
    graph = reader.graph
    for _, parameter in _values_of(reader, "parameter"):
        yield from ((fault, None) for fault in _by_table(reader, parameter, "a sh:parameter", _PARAMETER))
    for noun, table, kind in (
        ("a component", _COMPONENT, NamedNode(SH + "ConstraintComponent")),
        ("a function", _FUNCTION, NamedNode(SH + "SPARQLFunction")),
    ):
        for one in graph.instances(kind):
            if not text_of(one).startswith(SH):
                yield from ((fault, None) for fault in _by_table(reader, one, noun, table))
                if not isinstance(one, NamedNode):
                    yield ShapeFault(f"{noun} has no IRI", one), None
    for function in graph.instances(NamedNode(SH + "SPARQLFunction")):
        bodies = [*reader.values(function, "select"), *reader.values(function, "ask")]
        if len(bodies) != 1:
            said = "has neither sh:select nor sh:ask" if not bodies else "has more than one query"
            yield ShapeFault(f"the function {show(function)} {said}", function), None


def _forms(reader: Reader) -> Found:
    """Queries of another form than the property says; constraints and rules are judged where they stand."""
    elsewhere = {holder for name in ("sparql", "rule") for _, holder in _values_of(reader, name)}
    for name, wanted in _FORMS.items():
        for holder, query in _values_of(reader, name):
            if holder in elsewhere:
                continue
            if not STRING[0](reader.graph, query):
                yield ShapeFault(f"the value of sh:{name} must be a plain string", holder, name, query), None
            elif form_of(query) not in {wanted, ""}:
                said = f"sh:{name} holds a query of the form {form_of(query)}, not {wanted}"
                yield ShapeFault(said, holder, name, query), (holder, NamedNode(SH + name), query)


def _target(reader: Reader, shape: Term, target: Term) -> Found:
    triple = (shape, NamedNode(SH + "target"), target)
    if isinstance(target, (Literal, Triple)):
        yield ShapeFault("the value of sh:target must be a node with a sh:select", shape, "target", target), triple
        return
    holders = (target, *reader.values(target, _TYPE))
    holder = next((one for one in holders if reader.values(one, "select")), None)
    if holder is None:
        yield ShapeFault("the sh:target has no sh:select", shape, "target", target), triple
        return
    try:
        reader.query(holder, "select", what="the query of a target")
    except ShapeFault as fault:
        yield fault, triple


def rule_kind(reader: Reader, rule: Term) -> str:
    """``SPARQLRule`` or ``TripleRule``, as the rule says or as its parts do; empty where it is neither."""
    kinds = {text_of(kind).removeprefix(SH) for kind in reader.values(rule, _TYPE)}
    parts = {"SPARQLRule": "construct", "TripleRule": "subject"}
    return next((kind for kind, part in parts.items() if kind in kinds or reader.values(rule, part)), "")


def _rule(reader: Reader, shape: Term, rule: Term) -> Iterator[ShapeFault]:
    if isinstance(rule, (Literal, Triple)):
        yield ShapeFault("the value of sh:rule must be a node that is described", shape, "rule", rule)
    elif _JS_RULE in reader.values(rule, _TYPE):
        yield ShapeFault("a sh:JSRule is JavaScript, which is not run", shape, "rule", rule)
    elif (kind := rule_kind(reader, rule)) == "SPARQLRule":
        yield from _by_table(reader, rule, "a sh:SPARQLRule", _SPARQL_RULE)
        try:
            reader.query(rule, "construct", what="the rule")
        except ShapeFault as fault:
            yield fault
        form = form_of(reader.one(rule, "construct") or Literal(""))
        if form not in {"CONSTRUCT", ""}:
            said = f"sh:construct holds a query of the form {form}, not CONSTRUCT"
            yield ShapeFault(said, rule, "construct", reader.one(rule, "construct"))
    elif kind == "TripleRule":
        yield from _by_table(reader, rule, "a sh:TripleRule", _TRIPLE_RULE)
    else:
        yield ShapeFault(NO_RULE, shape, "rule", rule)


def _not_run(reader: Reader) -> Found:
    """What SHACL knows and this validator does not run."""
    for name in _OTHERS:
        for holder, value in _values_of(reader, name):
            yield (
                ShapeFault(f"sh:{name} is not run by this validator, so that it checks nothing", holder, name, value),
                None,
            )
    for holder, regime in _values_of(reader, "entailment"):
        if regime != _RULES:
            said = f"the entailment regime {show(regime)} is not supported; write what it entails into the data"
            yield ShapeFault(said, holder, "entailment", regime), None
