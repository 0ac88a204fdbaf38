"""Blank nodes of two parses of one file are matched, however much they look alike."""

from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import BlankNode, RdfFormat, parse

from onto_compiler.check.blanks import same_blanks
from onto_compiler.turtle.source_map import map_text

BASE = "https://example.org/"
nodes = st.recursive(
    st.sampled_from(["1", "2", '"x"', "[]", "()", ":a", "_:n", "_:m"]),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3).map(lambda parts: f"( {' '.join(parts)} )"),
        st.lists(inner, min_size=1, max_size=3).map(lambda parts: f"[ {' ; '.join(f':p {part}' for part in parts)} ]"),
    ),
    max_leaves=12,
)
texts = st.lists(nodes, min_size=1, max_size=5).map(
    lambda values: "@prefix : <#> .\n" + "\n".join(f":s :p {value} ." for value in values)
)


def parsed(text):
    return list(parse(text.encode(), format=RdfFormat.TURTLE, base_iri=BASE))


@settings(deadline=None, max_examples=200)
@given(texts)
def test_the_one_graph_becomes_the_other(text):
    ours, theirs = parsed(text), map_text(text, "x.ttl", BASE).triples
    same = same_blanks(ours, theirs)

    def own(term):
        return same[term] if isinstance(term, BlankNode) else term

    assert {(own(t.subject), t.predicate, own(t.object)) for t in ours} == {
        (t.subject, t.predicate, t.object) for t in theirs
    }


def test_nodes_that_look_alike_are_matched_in_their_order():
    text = "@prefix : <#> . :s :p [ :q 1 ] , [ :q 1 ] , [ :q 2 ] ."
    ours, theirs = parsed(text), map_text(text, "x.ttl", BASE).triples
    same = same_blanks(ours, theirs)
    assert [same[t.subject] for t in ours if t.predicate.value.endswith("q")] == [
        t.subject for t in theirs if t.predicate.value.endswith("q")
    ]


def test_what_the_other_parse_does_not_hold_has_no_like():
    assert same_blanks(parsed("[] <#p> 1 ."), parsed("[] <#p> 2 .")) == {}
