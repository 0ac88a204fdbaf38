"""What the comparisons of shape engines share: small graphs, shapes that use many components, and pySHACL's word."""

import pyshacl
from hypothesis import strategies as st
from pyoxigraph import BlankNode, Literal, NamedNode, RdfFormat, Store

from benchmarks.shapes_pyshacl import as_graph, read_report
from onto_compiler.rdf import RDF, XSD, node
from onto_compiler.turtle.source_map import canonical

EX = "https://example.org/"
PREFIXES = """
@prefix ex: <https://example.org/> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
"""
VALUE_SHAPE = """
ex:Shape a sh:NodeShape ; sh:targetClass ex:Thing ; sh:targetSubjectsOf ex:p ; sh:targetObjectsOf ex:q ;
    sh:nodeKind sh:IRI ; sh:class ex:Thing ; sh:pattern "^https" ; sh:in ( ex:a ex:b ex:c ) ; sh:hasValue ex:a ;
    sh:property [ sh:path ex:p ; sh:minCount 1 ; sh:maxCount 2 ; sh:datatype xsd:integer ] ,
        [ sh:path ex:p ; sh:minCount 2 ; sh:nodeKind sh:Literal ; sh:minInclusive 1 ; sh:maxExclusive 5 ] ,
        [ sh:path ex:p ; sh:minExclusive 1 ; sh:maxInclusive 2 ; sh:datatype xsd:boolean ] ,
        [ sh:path ex:q ; sh:class ex:Thing ; sh:nodeKind sh:BlankNodeOrIRI ; sh:in ( ex:a ex:b ) ] ,
        [ sh:path [ sh:inversePath ex:q ] ; sh:minCount 1 ; sh:class ex:Part ] ,
        [ sh:path ex:r ; sh:hasValue "x" ; sh:pattern "^X" ; sh:flags "i" ; sh:minLength 2 ; sh:maxLength 3 ] ,
        [ sh:path ex:r ; sh:uniqueLang true ; sh:languageIn ( "en" "fr" ) ; sh:nodeKind sh:IRIOrLiteral ] .
"""
"""The components that test values one by one or count them, without paths and references to other shapes."""

NODES = [NamedNode(EX + name) for name in "abcd"] + [BlankNode("x")]
# No booleans: rdflib reads a malformed one as false, and pySHACL compares them with numbers as Python does.
VALUES = [
    *NODES,
    *(Literal(n) for n in (0, 1, 2, 5)),
    Literal("x"),
    Literal("xy"),
    Literal("long text"),
    Literal("one", language="en"),
    Literal("two", language="en"),
    Literal("deux", language="fr"),
    Literal("many", datatype=NamedNode(XSD + "integer")),
    Literal(1.5),
]
PATHS = [NamedNode(EX + name) for name in "pqr"]
TYPE = node(RDF + "type")
CLASSES = [NamedNode(EX + "Thing"), NamedNode(EX + "Part")]
STATEMENTS = (
    st.tuples(st.sampled_from(NODES), st.sampled_from(PATHS), st.sampled_from(VALUES)),
    st.tuples(st.sampled_from(NODES), st.just(TYPE), st.sampled_from(CLASSES)),
)


def store_of(text):
    """A store of ``text``, before which stand the prefixes."""
    store = Store()
    store.load((PREFIXES + text).encode(), format=RdfFormat.TURTLE, base_iri=EX)
    return store


def plain(term):
    """A term as both engines agree on it: no blank node's name, no lexical form."""
    return "blank" if isinstance(term, BlankNode) else canonical(term) if term is not None else None


def rows(results):
    """Focus node, path, value and component of each result."""
    return {(plain(r.focus), plain(r.path), plain(r.value), r.component) for r in results}


def by_pyshacl(data, shapes):
    """The same of pySHACL's results, which are there exactly where it says that ``data`` do not conform."""
    graph = as_graph(data)
    other = graph if shapes is data else as_graph(shapes)
    options = {"inference": "none", "advanced": False, "inplace": True, "meta_shacl": False}
    conforms, report, _ = pyshacl.validate(graph, shacl_graph=other, **options)
    found = {(plain(row[0]), plain(row[1]), plain(row[2]), row[3]) for row in read_report(report)}
    assert conforms == (not found)
    return found


def assert_same(ours, theirs):
    """Both sides have the same rows; says which side has what the other lacks."""
    assert ours == theirs, f"only ours {ours - theirs}, only pySHACL's {theirs - ours}"
