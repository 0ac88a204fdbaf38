"""Shapes as SHACL's syntax rules have them (SHACL, sections 2 to 5): every fault of every shape, and the rest to run.

``PARAMETERS`` is the table of the rules: what each parameter may have for a value, how many, and on which shapes.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import cast

from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from onto_compiler.check.vocabularies import TERMS
from onto_compiler.problems import near
from onto_compiler.rdf import RDF, SH, XSD
from onto_compiler.shacl.components import COMPONENTS
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.logic import SHAPE_COMPONENTS
from onto_compiler.shacl.model import ShapeFault
from onto_compiler.shacl.paths import read_path
from onto_compiler.shacl.reader import Parameter, Reader
from onto_compiler.shacl.sparql import sparql_check
from onto_compiler.shacl.values import is_well_formed

__all__ = ["misspelt", "sound_part"]

_TYPE, _PATH, _SPARQL = NamedNode(RDF + "type"), NamedNode(SH + "path"), NamedNode(SH + "sparql")
_NODE_SHAPE, _PROPERTY_SHAPE = NamedNode(SH + "NodeShape"), NamedNode(SH + "PropertyShape")
_KINDS = {"BlankNode", "IRI", "Literal", "BlankNodeOrIRI", "BlankNodeOrLiteral", "IRIOrLiteral"}
_INTEGERS = {"integer", "nonNegativeInteger", "positiveInteger", "long", "int", "short", "byte"} | {
    f"unsigned{size}" for size in ("Long", "Int", "Short", "Byte")
}
_SKIPPED = re.compile(r"\"\"\".*?\"\"\"|'''.*?'''|\"(?:\\.|[^\"\\])*\"|'(?:\\.|[^'\\])*'|<[^<>\s]*>|#[^\n]*", re.DOTALL)
_FORM = re.compile(r"\b(SELECT|ASK|CONSTRUCT|DESCRIBE)\b", re.IGNORECASE)
_GROUP = re.compile(r"\bWHERE\b|\bFROM\b|\{", re.IGNORECASE)
_THIS = re.compile(r"[$?]this\b")
Triple3 = tuple[Term, NamedNode, Term]
Test = Callable[[Graph, Term], bool]


def _typed(term: Term, *datatypes: str) -> bool:
    return isinstance(term, Literal) and term.datatype.value.removeprefix(XSD) in datatypes and is_well_formed(term)


def _is_iri(_: Graph, term: Term) -> bool:
    return isinstance(term, NamedNode)


def _is_count(_: Graph, term: Term) -> bool:
    return isinstance(term, Literal) and _typed(term, *_INTEGERS) and int(term.value) >= 0


def _is_boolean(_: Graph, term: Term) -> bool:
    return _typed(term, "boolean")


def _is_string(_: Graph, term: Term) -> bool:
    return _typed(term, "string")


def _is_text(_: Graph, term: Term) -> bool:
    return isinstance(term, Literal) and (term.language is not None or _typed(term, "string"))


def _is_literal(_: Graph, term: Term) -> bool:
    return isinstance(term, Literal)


def _is_bound(_: Graph, term: Term) -> bool:
    return isinstance(term, Literal) and is_well_formed(term)


def _is_node_kind(_: Graph, term: Term) -> bool:
    return isinstance(term, NamedNode) and term.value.removeprefix(SH) in _KINDS


def _is_named(_: Graph, term: Term) -> bool:
    return not isinstance(term, (BlankNode, Triple))


def _is_term(_: Graph, __: Term) -> bool:
    return True


def _is_node(_: Graph, term: Term) -> bool:
    return isinstance(term, (NamedNode, BlankNode))


def _is_shape(graph: Graph, term: Term) -> bool:
    # `[]` is a shape that everything conforms to; a name without a description is most likely misspelt.
    return isinstance(term, BlankNode) or (isinstance(term, NamedNode) and bool(graph.predicates(term)))


def _is_property_shape(graph: Graph, term: Term) -> bool:
    return _is_shape(graph, term) and bool(graph.objects(term, _PATH))


def _is_path(graph: Graph, term: Term) -> bool:
    return read_path(graph, term) is not None


def _list_of(test: Test, *, least: int = 0) -> Test:
    def is_list(graph: Graph, term: Term) -> bool:
        members = None if isinstance(term, (Literal, Triple)) else graph.items(term)
        return members is not None and len(members) >= least and all(test(graph, member) for member in members)

    return is_list


_IRI, _COUNT = (_is_iri, "an IRI"), (_is_count, "a whole number of 0 or more, such as 1")
_BOOLEAN, _STRING = (_is_boolean, "true or false"), (_is_string, "a plain string")
_BOUND, _SHAPE = (_is_bound, "a well-formed literal"), (_is_shape, "a shape that the shapes graph describes")
_SHAPES = (_list_of(_is_shape, least=1), "a list of shapes that the shapes graph describes, such as ( ex:A ex:B )")


@dataclass(frozen=True, slots=True)
class Rule:
    """What the syntax of one parameter is; ``wants`` are parameters of which one must stand beside it."""

    test: Test
    expected: str
    single: bool = False
    on_property: bool = False
    wants: tuple[str, ...] = ()


PARAMETERS: Mapping[str, Rule] = {
    "and": Rule(*_SHAPES),
    "class": Rule(*_IRI),
    "closed": Rule(*_BOOLEAN, single=True),
    "datatype": Rule(*_IRI, single=True),
    "deactivated": Rule(*_BOOLEAN, single=True),
    "disjoint": Rule(*_IRI),
    "equals": Rule(*_IRI),
    "flags": Rule(*_STRING, single=True, wants=("pattern",)),
    "hasValue": Rule(_is_term, "an RDF term"),
    "ignoredProperties": Rule(_list_of(_is_iri), "a list of IRIs: ( rdf:type )", single=True, wants=("closed",)),
    "in": Rule(_list_of(_is_term), "a list, such as ( ex:a ex:b )", single=True),
    "languageIn": Rule(_list_of(_is_string), 'a list of languages, such as ( "en" "de" )', single=True),
    "lessThan": Rule(*_IRI, on_property=True),
    "lessThanOrEquals": Rule(*_IRI, on_property=True),
    "maxCount": Rule(*_COUNT, single=True, on_property=True),
    "maxExclusive": Rule(*_BOUND, single=True),
    "maxInclusive": Rule(*_BOUND, single=True),
    "maxLength": Rule(*_COUNT, single=True),
    "message": Rule(_is_text, "a text"),
    "minCount": Rule(*_COUNT, single=True, on_property=True),
    "minExclusive": Rule(*_BOUND, single=True),
    "minInclusive": Rule(*_BOUND, single=True),
    "minLength": Rule(*_COUNT, single=True),
    "node": Rule(*_SHAPE),
    "nodeKind": Rule(_is_node_kind, f"one of {', '.join(f'sh:{kind}' for kind in sorted(_KINDS))}", single=True),
    "not": Rule(*_SHAPE),
    "or": Rule(*_SHAPES),
    "path": Rule(_is_path, "a property path", single=True),
    "pattern": Rule(*_STRING, single=True),
    "property": Rule(_is_property_shape, "a property shape, which has a sh:path"),
    "qualifiedMaxCount": Rule(*_COUNT, single=True, wants=("qualifiedValueShape",)),
    "qualifiedMinCount": Rule(*_COUNT, single=True, wants=("qualifiedValueShape",)),
    "qualifiedValueShape": Rule(
        *_SHAPE, single=True, on_property=True, wants=("qualifiedMinCount", "qualifiedMaxCount")
    ),
    "qualifiedValueShapesDisjoint": Rule(*_BOOLEAN, single=True, wants=("qualifiedValueShape",)),
    "severity": Rule(_is_iri, "an IRI, such as sh:Warning", single=True),
    "sparql": Rule(_is_node, "a node with a sh:select"),
    "targetClass": Rule(*_IRI),
    "targetNode": Rule(_is_named, "an IRI or a literal"),
    "targetObjectsOf": Rule(*_IRI),
    "targetSubjectsOf": Rule(*_IRI),
    "uniqueLang": Rule(*_BOOLEAN, single=True, on_property=True),
    "xone": Rule(*_SHAPES),
}
_REFERENCES = ("node", "not", "property", "qualifiedValueShape", "and", "or", "xone")
_NO_SHAPE = {"message", "path", "severity", "deactivated", "sparql", "flags"}  # others have these too
_BUILDERS = {**COMPONENTS, **SHAPE_COMPONENTS}


def sound_part(graph: Graph, faults: list[ShapeFault]) -> Graph:
    """``graph`` without what is ill-formed, each fault of which is appended to ``faults``.

    What refers to a shape with a fault by another parameter than sh:property is left out too: such a shape is not
    the one that its author meant, so that nothing follows from whether a node conforms to it.
    """
    shapes = _shapes(graph)
    found = [*chain.from_iterable(_faults(graph, shape) for shape in shapes)]
    unknown = list(_unknown(graph))  # which are no faults here: see `misspelt`
    found += _failing(_without(graph, [*found, *unknown]), shapes)
    # One fault for all values of a property that are too many, at the last of them.
    faults += {(fault.shape, fault.parameter, str(fault), _many(fault)): fault for fault, _ in found}.values()
    return _without(graph, [*found, *unknown])


def misspelt(graph: Graph) -> list[ShapeFault]:
    """A fault (VOC011) for each use of a term of the SHACL namespace that SHACL does not have."""
    return [fault for fault, _ in _unknown(graph)]


def _without(graph: Graph, found: Iterable[tuple[ShapeFault, Triple3]]) -> Graph:
    """``graph`` without the triples that are at fault, and without what rests on their shapes."""
    left_out = {triple for _, triple in found}
    if not left_out:
        return graph
    pathless = {subject for subject, predicate, _ in left_out if predicate == _PATH}
    left_out |= _resting_on(graph, {subject for subject, _, _ in left_out}, pathless)
    return Graph(
        one for one in graph if one.subject not in pathless and (one.subject, one.predicate, one.object) not in left_out
    )


def _many(fault: ShapeFault) -> Term | None:
    return None if "and may have one" in str(fault) else fault.value


def _shapes(graph: Graph) -> list[Term]:
    """Every node that is declared or used as a shape, or has a target or a constraint."""
    found: set[Term] = {node for kind in (_NODE_SHAPE, _PROPERTY_SHAPE) for node in graph.instances(kind)}
    for name in PARAMETERS.keys() - _NO_SHAPE:
        found.update(graph.holders(NamedNode(SH + name)))
    for _, name, shape in _references(graph):
        if _is_shape(graph, shape) and name != "path":
            found.add(shape)
    return sorted((one for one in found if isinstance(one, (NamedNode, BlankNode))), key=str)


def _references(graph: Graph) -> Iterator[tuple[Triple3, str, Term]]:
    """Each triple that refers to shapes, with its parameter and one of the shapes."""
    for name in _REFERENCES:
        predicate = NamedNode(SH + name)
        for holder, values in graph.holders(predicate).items():
            for value in values:
                members = graph.items(value) or () if name in {"and", "or", "xone"} else (value,)
                for member in members:
                    yield (holder, predicate, value), name, member


def _resting_on(graph: Graph, unsound: set[Term], pathless: set[Term]) -> set[Triple3]:
    """The references to shapes that are not sound, and to those that have such references.

    The sound constraints of a property shape run, unless its path is unsound: it is then one of ``pathless``.
    """
    references, found = list(_references(graph)), set[Triple3]()
    grows = True
    while grows:
        before = len(unsound)
        for triple, name, shape in references:
            if shape in unsound:
                unsound.add(triple[0])
                if name != "property" or shape in pathless:
                    found.add(triple)
        grows = len(unsound) > before
    return found


def _faults(graph: Graph, shape: Term) -> Iterator[tuple[ShapeFault, Triple3]]:
    """What breaks a rule of the table, each with the triple that does."""
    reader = Reader(graph)
    has_path = bool(reader.values(shape, "path")) or bool(graph.subjects(NamedNode(SH + "property"), shape))
    types = graph.objects(shape, _TYPE)
    if _PROPERTY_SHAPE in types and not has_path:
        yield _fault("a property shape has no sh:path", shape, "path"), (shape, _TYPE, _PROPERTY_SHAPE)
    if _NODE_SHAPE in types and reader.values(shape, "path"):
        said = "a node shape has a sh:path, which only a property shape may have"
        for value in reader.values(shape, "path"):
            yield _fault(said, shape, "path", value), (shape, _TYPE, _NODE_SHAPE)
    for name, rule in PARAMETERS.items():
        values = reader.values(shape, name)
        for said, value in _broken(reader, shape, name, rule, values, has_path=has_path):
            yield _fault(said, shape, name, value), (shape, NamedNode(SH + name), value)
    for constraint in reader.values(shape, "sparql"):
        for said, holder, parameter, culprit in _query_faults(reader, constraint):
            yield _fault(said, holder, parameter, culprit), (shape, _SPARQL, constraint)


def _broken(
    reader: Reader, shape: Term, name: str, rule: Rule, values: list[Term], *, has_path: bool
) -> Iterator[tuple[str, Term]]:
    known = [value for value in values if rule.test(reader.graph, value)]
    for value in values:
        if value not in known:
            yield f"the value of sh:{name} must be {rule.expected}", value
    if rule.single and len(values) > 1:
        said = f"sh:{name} has {len(values)} values, and may have one"
        yield from ((said, value) for value in known or values[:1])
    elif known and rule.on_property and not has_path:
        for value in known:
            yield f"sh:{name} stands in a node shape, and only a property shape (with a sh:path) may have it", value
    elif known and rule.wants and not any(reader.values(shape, other) for other in rule.wants):
        wanted = " or ".join(f"sh:{other}" for other in rule.wants)
        yield f"sh:{name} stands without {wanted}, and so means nothing", known[0]


def _query_faults(reader: Reader, constraint: Term) -> Iterator[tuple[str, Term, str, Term | None]]:
    """What is wrong with a ``sh:sparql`` constraint, as its sentence, node, parameter and value."""
    if isinstance(constraint, (Literal, Triple)):
        return
    for name in ("message", "deactivated"):
        rule = PARAMETERS[name]
        for value in reader.values(constraint, name):
            if not rule.test(reader.graph, value):
                yield f"the value of sh:{name} must be {rule.expected}", constraint, name, value
    selects = reader.values(constraint, "select")
    if not selects:
        yield "a sh:sparql constraint has no sh:select", constraint, "select", None
    elif len(selects) > 1:
        yield f"sh:select has {len(selects)} values, and may have one", constraint, "select", selects[-1]
    elif said := _form_fault(selects[0]):
        yield said, constraint, "select", selects[0]


def _form_fault(select: Term) -> str:
    """What is wrong with the form of a query that selects focus nodes, as a sentence, or an empty string."""
    if not isinstance(select, Literal) or not _typed(select, "string"):
        return "the value of sh:select must be a plain string"
    bare = _SKIPPED.sub(" ", select.value)
    form = _FORM.search(bare)
    if form is None:
        return ""  # no SPARQL at all, which the parser says better
    if form[1].upper() != "SELECT":
        return f"sh:select holds a query of the form {form[1].upper()}, not SELECT"
    group = _GROUP.search(bare, form.end())
    selected = bare[form.end() : group.start() if group else None]
    everything = selected.split()[-1:] == ["*"]
    return "" if _THIS.search(bare if everything else selected) else "the query does not select $this, the focus node"


def _failing(graph: Graph, shapes: Iterable[Term]) -> Iterator[tuple[ShapeFault, Triple3]]:
    """What follows the table and yet cannot run: a pattern that is no regular expression, a query that is no SPARQL."""
    reader = Reader(graph)
    for shape in shapes:
        path_node = reader.one(shape, "path")
        path = read_path(graph, path_node) if path_node is not None else None
        for name in (*_BUILDERS, "sparql"):
            for value in reader.values(shape, name):
                triple = (shape, NamedNode(SH + name), value)
                try:
                    if name == "sparql":
                        sparql_check(reader, shape, path, value)
                    else:
                        list(_BUILDERS[name](Parameter(reader, shape, name, value)))
                except ShapeFault as fault:
                    yield fault, triple


def _unknown(graph: Graph) -> Iterator[tuple[ShapeFault, Triple3]]:
    """Each term of the SHACL namespace that SHACL does not have."""
    for one in graph:
        subject, predicate, value = cast("Triple3", (one.subject, one.predicate, one.object))
        for term in (predicate, value):
            if not isinstance(term, NamedNode) or not term.value.startswith(SH):
                continue
            name = term.value.removeprefix(SH)
            if name and name not in TERMS[SH]:
                said = f"`sh:{name}` is no term of its vocabulary"
                hint = f"{_near(name)}"
                culprit = value if term == value else None
                parameter = predicate.value.removeprefix(SH)
                fault = ShapeFault(said, subject, parameter, culprit, code="VOC011", hint=hint)
                yield fault, (subject, predicate, value)


def _near(name: str) -> str:
    same = {known.lower(): known for known in TERMS[SH]}.get(name.lower())
    question = (
        f"did you mean `sh:{same}`?" if same else near(f"sh:{name}", (f"sh:{known}" for known in sorted(TERMS[SH])))
    )
    return question or "write a term that SHACL has."


def _fault(message: str, shape: Term, name: str, value: Term | None = None) -> ShapeFault:
    return ShapeFault(message, shape, name, value)
