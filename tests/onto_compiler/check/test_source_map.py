"""The source map finds the triples that Oxigraph parses, and each where it is written."""

from pathlib import Path

import pytest
import rdflib
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import (
    BlankNode,
    CanonicalizationAlgorithm,
    Dataset,
    Literal,
    NamedNode,
    Quad,
    RdfFormat,
    Triple,
    parse,
    serialize,
)

import ontology
from onto_compiler.rdf import XSD
from onto_compiler.turtle.source_map import map_text, read_map
from onto_compiler.turtle.tokens import position_in_literal, unescape

HERE = Path(__file__).parent
BASE = "https://example.org/base/file"
READABLE = sorted(path for path in (HERE / "broken").glob("*.ttl") if not path.stem.startswith("ttl00"))
ODD = r"""
@base <https://example.org/x/> .
BASE <https://example.org/y/>
@prefix : <#> .
PREFIX a.b: <../z#>
# a comment with "quotes" and <angles>
:s a :T ; a.b:p "x"@en-GB , 'y' , '''it's "long"''' , ""\"two
lines \"" here""\" ; ; .
<rel> <?q=1> <> , <#f> .
:n :int 1 , -2 , +3.5 , .5 , 1e3 , 1.E-2 , true , false .
[] :p [ :q ( 1 ( ) "two" [ :r :s ] ) ] .
[ :only :this ] .
( :l1 :l2 ) :p _:b.1 .
_:b.1 :p a.b:with\,comma , a.b:pct%20x , a.b:c:d , a.b:dot.dot , a.b: .
:esc :p "tab\t quote\" back\\ \u00e9 \U0001F600" , <https://example.org/\u00e9> .
:typed :p "5"^^<http://www.w3.org/2001/XMLSchema#integer> , "z"^^a.b:dt .
"""


def same(triples, others):
    left, right = (Dataset([Quad(t.subject, t.predicate, t.object) for t in these]) for these in (triples, others))
    left.canonicalize(CanonicalizationAlgorithm.UNSTABLE)
    right.canonicalize(CanonicalizationAlgorithm.UNSTABLE)
    return left == right


def agrees(text, base=BASE):
    return same(map_text(text, "x.ttl", base).triples, parse(text.encode(), format=RdfFormat.TURTLE, base_iri=base))


@pytest.mark.parametrize("path", ontology.turtle_files(), ids=lambda path: path.stem)
def test_every_shipped_file_is_read_as_oxigraph_reads_it(path):
    parsed = list(parse(path=path, format=RdfFormat.TURTLE, base_iri=path.as_uri()))
    assert len(read_map(path).triples) == len(parsed)
    assert same(read_map(path).triples, parsed)


@pytest.mark.parametrize("path", READABLE, ids=lambda path: path.stem)
def test_every_example_is_read_as_oxigraph_reads_it(path):
    assert same(read_map(path).triples, parse(path=path, format=RdfFormat.TURTLE, base_iri=path.as_uri()))


def test_enough_examples_are_read():
    assert len(READABLE) > 110
    assert len(list((HERE / "broken").glob("*.ttl"))) - len(READABLE) == 11, "no Turtle"


def test_the_odd_corners_of_turtle_are_read():
    assert agrees(ODD.replace('""\\"', '"""'))


iris = st.from_regex(r"https://example\.org/[a-z]{1,3}(#[A-Za-z_][A-Za-z0-9_.-]{0,4}[a-z])?", fullmatch=True).map(
    NamedNode
)
blanks = st.sampled_from([BlankNode(name) for name in "abc"])
texts = st.text(st.characters(codec="utf-8", exclude_characters="\x00"), max_size=12)
literals = st.one_of(
    texts.map(Literal),
    st.tuples(texts, st.sampled_from(["en", "de-ch"])).map(lambda pair: Literal(pair[0], language=pair[1])),
    st.integers().map(Literal),
    st.floats(allow_nan=False, allow_infinity=False).map(Literal),
    st.booleans().map(Literal),
    st.decimals(allow_nan=False, allow_infinity=False, places=3).map(
        lambda number: Literal(f"{number:f}", datatype=NamedNode(XSD + "decimal"))
    ),
)
graphs = st.lists(
    st.builds(Triple, st.one_of(iris, blanks), iris, st.one_of(iris, blanks, literals)), min_size=1, max_size=8
)


@settings(max_examples=200, deadline=None)
@given(graphs)
def test_any_graph_that_oxigraph_writes_is_read_back(triples):
    prefixes = {"ex": "https://example.org/", "": "https://example.org/a#"}
    text = serialize(triples, format=RdfFormat.TURTLE, prefixes=prefixes).decode()
    assert agrees(text)


@settings(max_examples=100, deadline=None)
@given(graphs)
def test_any_graph_that_rdflib_writes_is_read_back(triples):
    data = serialize(triples, format=RdfFormat.N_TRIPLES).decode()
    text = rdflib.Graph().parse(data=data, format="nt").serialize(format="turtle")
    assert agrees(text)


@settings(max_examples=200, deadline=None)
@given(st.text(alphabet='ab:<>"@.;,[]()#\\ \n^_1?{', max_size=40))
def test_no_text_breaks_the_source_map(text):
    for triple in map_text(text, "x.ttl", BASE).triples:
        assert text[triple.at_object.start : triple.at_object.end] == triple.at_object.text


def test_spans_point_at_what_is_written():
    source = map_text("@prefix e: <https://e.org/> .\ne:s e:p 1 ,\n  e:o ;\n  a e:T .\n", "x.ttl", BASE)
    places = [
        tuple((source.span(t).line, source.span(t).column) for t in (x.at_subject, x.at_predicate, x.at_object))
        for x in source.triples
    ]
    assert places == [((2, 1), (2, 5), (2, 9)), ((2, 1), (2, 5), (3, 3)), ((2, 1), (4, 3), (4, 5))]


def test_a_number_is_found_whatever_its_lexical_form():
    source = map_text("<https://e.org/s> <https://e.org/p> 0.50 .", "x.ttl", BASE)
    half = Literal("0.5", datatype=NamedNode(XSD + "decimal"))
    assert len(source.find(None, None, half)) == 1


@given(st.text(alphabet='ab\n\t"\\é', max_size=20), st.data())
def test_a_place_in_a_literal_survives_escapes(value, data):
    raw = str(Literal(value))
    index = data.draw(st.integers(0, max(len(value) - 1, 0)))
    at = position_in_literal(raw, index)
    assert unescape(raw[1:at]) == value[:index]


def test_what_cannot_be_read_is_skipped_up_to_the_next_dot():
    source = map_text("<a:s> ! <a:o> . <a:s> <a:p> <a:o> .", "x.ttl", BASE)
    assert len(source.triples) == 1
