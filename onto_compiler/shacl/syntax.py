"""The syntax rules of SHACL's parameters (SHACL, sections 2 to 5): which values each may have, and on which shapes."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from onto_compiler.rdf import RDF, SH, XSD
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.paths import read_path
from onto_compiler.shacl.reader import Reader
from onto_compiler.shacl.values import is_well_formed, number

__all__ = [
    "BOOLEAN",
    "IRI",
    "NAMESPACE",
    "NODE",
    "NUMBER",
    "PARAMETERS",
    "SHAPE",
    "STRING",
    "TERM",
    "TEXT",
    "Rule",
    "Triple3",
    "broken",
    "form_of",
    "is_shape",
    "query_faults",
]

_FIRST, _REST, _NIL = (NamedNode(RDF + name) for name in ("first", "rest", "nil"))
_ALTERNATIVE = NamedNode(SH + "alternativePath")
_FORMS = (
    _ALTERNATIVE,
    *(NamedNode(SH + name) for name in ("inversePath", "zeroOrMorePath", "oneOrMorePath", "zeroOrOnePath")),
)
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


def is_shape(graph: Graph, term: Term) -> bool:
    """Whether the graph describes a shape; ``[]`` is one that everything conforms to."""
    # A name without a description is most likely misspelt.
    return isinstance(term, BlankNode) or (isinstance(term, NamedNode) and bool(graph.predicates(term)))


def _is_property_shape(graph: Graph, term: Term) -> bool:
    return is_shape(graph, term) and bool(graph.objects(term, NamedNode(SH + "path")))


def _is_path(graph: Graph, term: Term) -> bool:
    return read_path(graph, term) is not None and _has_one_form(graph, term)


def _has_one_form(graph: Graph, term: Term) -> bool:
    """Whether a path and its parts have one form each, and its lists two members or more (section 2.3.1)."""
    if not isinstance(term, BlankNode):
        return True
    forms = [(name, value) for name in _FORMS for value in graph.objects(term, name)]
    if len(forms) + bool(graph.objects(term, _FIRST)) != 1:
        return False
    if not forms or forms[0][0] == _ALTERNATIVE:
        head = forms[0][1] if forms else term
        members = graph.items(head) or ()
        return len(members) > 1 and _is_list(graph, head) and all(_has_one_form(graph, one) for one in members)
    return _has_one_form(graph, forms[0][1])


def _is_list(graph: Graph, head: Term) -> bool:
    """Whether a term is a list of which each part has one member and one rest."""
    if isinstance(head, (Literal, Triple)) or graph.items(head) is None:
        return False
    while head != _NIL:
        rest = graph.objects(head, _REST)
        if len(rest) != 1 or len(graph.objects(head, _FIRST)) != 1:
            return False
        head = next(iter(rest))
    return True


def _is_namespace(_: Graph, term: Term) -> bool:
    return _typed(term, "anyURI")


def _is_number(_: Graph, term: Term) -> bool:
    return isinstance(term, Literal) and number(term) is not None


def _list_of(test: Test, *, least: int = 0) -> Test:
    def is_list(graph: Graph, term: Term) -> bool:
        members = (graph.items(term) or ()) if _is_list(graph, term) else None
        return members is not None and len(members) >= least and all(test(graph, member) for member in members)

    return is_list


IRI, COUNT = (_is_iri, "an IRI"), (_is_count, "a whole number of 0 or more, such as 1")
BOOLEAN, STRING, TEXT = (_is_boolean, "true or false"), (_is_string, "a plain string"), (_is_text, "a text")
BOUND, NUMBER = (_is_bound, "a well-formed literal"), (_is_number, "a number")
NAMESPACE = (_is_namespace, 'an IRI as a literal: "http://example.org/"^^xsd:anyURI')
TERM = (_is_term, "an RDF term")
NODE, SHAPE = (_is_node, "a node that is described"), (is_shape, "a shape that the shapes graph describes")
SHAPES = (_list_of(is_shape, least=1), "a list of shapes that the shapes graph describes, such as ( ex:A ex:B )")


@dataclass(frozen=True, slots=True)
class Rule:
    """What the syntax of one parameter is; ``wants`` are parameters of which one must stand beside it.

    A ``required`` one must be there.
    """

    test: Test
    expected: str
    single: bool = False
    on_property: bool = False
    wants: tuple[str, ...] = ()
    required: bool = False


PARAMETERS: Mapping[str, Rule] = {
    "and": Rule(*SHAPES),
    "class": Rule(*IRI),
    "closed": Rule(*BOOLEAN, single=True),
    "datatype": Rule(*IRI, single=True),
    "deactivated": Rule(*BOOLEAN, single=True),
    "disjoint": Rule(*IRI),
    "equals": Rule(*IRI),
    "flags": Rule(*STRING, single=True, wants=("pattern",)),
    "hasValue": Rule(*TERM),
    "ignoredProperties": Rule(_list_of(_is_iri), "a list of IRIs: ( rdf:type )", single=True, wants=("closed",)),
    "in": Rule(_list_of(_is_term), "a list, such as ( ex:a ex:b )", single=True),
    "languageIn": Rule(_list_of(_is_string), 'a list of languages, such as ( "en" "de" )', single=True),
    "lessThan": Rule(*IRI, on_property=True),
    "lessThanOrEquals": Rule(*IRI, on_property=True),
    "maxCount": Rule(*COUNT, single=True, on_property=True),
    "maxExclusive": Rule(*BOUND, single=True),
    "maxInclusive": Rule(*BOUND, single=True),
    "maxLength": Rule(*COUNT, single=True),
    "message": Rule(*TEXT),
    "minCount": Rule(*COUNT, single=True, on_property=True),
    "minExclusive": Rule(*BOUND, single=True),
    "minInclusive": Rule(*BOUND, single=True),
    "minLength": Rule(*COUNT, single=True),
    "node": Rule(*SHAPE),
    "nodeKind": Rule(_is_node_kind, f"one of {', '.join(f'sh:{kind}' for kind in sorted(_KINDS))}", single=True),
    "not": Rule(*SHAPE),
    "or": Rule(*SHAPES),
    "path": Rule(_is_path, "a property path of one form, whose lists have two paths or more", single=True),
    "pattern": Rule(*STRING, single=True),
    "property": Rule(_is_property_shape, "a property shape, which has a sh:path"),
    "qualifiedMaxCount": Rule(*COUNT, single=True, wants=("qualifiedValueShape",)),
    "qualifiedMinCount": Rule(*COUNT, single=True, wants=("qualifiedValueShape",)),
    "qualifiedValueShape": Rule(
        *SHAPE, single=True, on_property=True, wants=("qualifiedMinCount", "qualifiedMaxCount")
    ),
    "qualifiedValueShapesDisjoint": Rule(*BOOLEAN, single=True, wants=("qualifiedValueShape",)),
    "severity": Rule(_is_iri, "an IRI, such as sh:Warning", single=True),
    "sparql": Rule(_is_node, "a node with a sh:select"),
    "targetClass": Rule(*IRI),
    "targetNode": Rule(_is_named, "an IRI or a literal"),
    "targetObjectsOf": Rule(*IRI),
    "targetSubjectsOf": Rule(*IRI),
    "uniqueLang": Rule(*BOOLEAN, single=True, on_property=True),
    "xone": Rule(*SHAPES),
}


def broken(
    reader: Reader, shape: Term, name: str, rule: Rule, values: list[Term], *, has_path: bool = True
) -> Iterator[tuple[str, Term]]:
    """How ``values`` of sh:``name`` break its rule: a sentence and the value for each fault."""
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


def query_faults(reader: Reader, constraint: Term) -> Iterator[tuple[str, Term, str, Term | None]]:
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


def form_of(query: Term) -> str:
    """The word that says what a query is (``SELECT``, ...); empty where there is none, which the parser says better."""
    found = _FORM.search(_SKIPPED.sub(" ", query.value)) if isinstance(query, Literal) else None
    return found[1].upper() if found else ""


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
