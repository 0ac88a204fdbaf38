"""Every term is shown as Turtle writes it, and differently from every other term."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import BaseDirection, BlankNode, Literal, NamedNode, RdfFormat, Triple, parse

from onto_compiler.rdf import XSD
from onto_compiler.terms import ShapeOf, sentence, show, text_of

EX = "http://example.org/"
A, B = NamedNode(EX + "a"), NamedNode(EX + "b")
PREFIXES = (("ex", EX),)


def typed(text, kind):
    return Literal(text, datatype=NamedNode(XSD + kind))


@pytest.mark.parametrize(
    ("term", "shown"),
    [
        (A, "ex:a"),
        (NamedNode("http://example.com/x/y"), "<http://example.com/x/y>"),
        (NamedNode("http://www.w3.org/2004/02/skos/core#note"), "skos:note"),
        (BlankNode("x"), "[]"),
        (typed("1", "integer"), "1"),
        (Literal("1"), '"1"'),
        (typed("01", "integer"), "01"),
        (typed("1", "decimal"), '"1"^^xsd:decimal'),
        (typed("1.", "decimal"), '"1."^^xsd:decimal'),
        (typed("1.50", "decimal"), "1.50"),
        (typed("1E1", "double"), "1E1"),
        (typed("INF", "double"), '"INF"^^xsd:double'),
        (typed("true", "boolean"), "true"),
        (typed("1", "boolean"), '"1"^^xsd:boolean'),
        (typed("x", "integer"), '"x"^^xsd:integer'),
        (Literal("a", language="en"), '"a"@en'),
        (Literal("a", language="ar", direction=BaseDirection.RTL), '"a"@ar--rtl'),
        (Literal("a", datatype=B), '"a"^^ex:b'),
        (Literal('say "a"\n'), '"say \\"a\\"\\n"'),
        (Triple(A, B, typed("007", "integer")), "<<( ex:a ex:b 007 )>>"),
        (Triple(A, B, Triple(A, B, Literal("x"))), '<<( ex:a ex:b <<( ex:a ex:b "x" )>> )>>'),
    ],
)
def test_a_term_is_shown_as_turtle_writes_it(term, shown):
    assert show(term, PREFIXES) == shown
    assert show(term, iter(PREFIXES)) == shown, "prefixes that can be read once are enough"
    assert isinstance(text_of(term), str)


FORMS = st.sampled_from(["1", "01", "1.0", "1.", "1e0", "true", "x", "a\\b", "é\n"])
KINDS = st.sampled_from(["integer", "decimal", "double", "boolean", "string", "date"])
TAGGED = st.builds(lambda text, tag: Literal(text, language=tag), FORMS, st.sampled_from(["en", "de"]))
PLAIN = st.one_of(st.builds(typed, FORMS, KINDS), TAGGED, st.sampled_from([A, B]))
TERMS = st.recursive(PLAIN, lambda inner: st.builds(lambda o: Triple(A, B, o), inner), max_leaves=3)


@given(TERMS)
def test_what_is_shown_reads_back(term):
    prefixes = f"@prefix ex: <{EX}> . @prefix xsd: <{XSD}> . "
    (read,) = parse(f"{prefixes} ex:s ex:p {show(term, PREFIXES)} .".encode(), format=RdfFormat.TURTLE)
    assert read.object == term


def test_a_sentence_names_its_terms_and_shapes():
    said = ("must be one of ", A, ", ", Literal("1"), " or meet ", ShapeOf(BlankNode("s")))
    words = sentence(said, lambda term: show(term, PREFIXES), lambda _: "the node shape at 3:4")
    assert words == 'must be one of `ex:a`, `"1"` or meet the node shape at 3:4'
    assert sentence("must be", str, str) == "must be"
