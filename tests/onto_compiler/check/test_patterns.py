"""What a rule reads and writes is found in its text."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import Store

from onto_compiler.check.model import load_model
from onto_compiler.check.patterns import read_construct
from onto_compiler.check.rules import check_rules
from onto_compiler.rdf import RDF

PREFIXES = {"e": "https://e.org/"}


def local(iri):
    return {RDF + "type": "a"}.get(iri, iri.removeprefix("https://e.org/"))


def steps(found):
    return [(local(step.subject), local(step.predicate.iri), local(step.object)) for step in found]


@pytest.mark.parametrize(
    ("pattern", "reads"),
    [
        ("$this e:p ?x", [("this", "p", "x")]),
        ("$this e:p ?x , ?y ; e:q e:o .", [("this", "p", "x"), ("this", "p", "y"), ("this", "q", "o")]),
        ("?x a e:T . ?y e:p 3 ; .", [("x", "a", "T"), ("y", "p", "3")]),
        ("$this e:p/e:q ?x", [("this", "p", " 1"), (" 1", "q", "x")]),
        ("$this a/e:sub* ?x", [("this", "a", " 1"), (" 1", "sub", "x")]),
        ("$this (e:p|e:q)+ ?x", [("this", "p", " 1"), (" 1", "q", "x")]),
        ("?s ?p ?o . ?o e:q ?s", [("o", "q", "s")]),
        ("FILTER NOT EXISTS { ?x e:p ?y } ?x e:q ?y", [("x", "p", "y"), ("x", "q", "y")]),
        ("FILTER (?x IN (e:a, e:b)) ?x e:q ?y", [("x", "q", "y")]),
        ("VALUES ?k { e:a e:b } ?x e:q ?k", [("x", "q", "k")]),
        ("VALUES (?k ?l) { (e:a e:b) } ?x e:q ?k", [("x", "q", "k")]),
        ("BIND (STR(?y) AS ?z) ?x e:q ?y", [("x", "q", "y")]),
        (
            "OPTIONAL { ?x e:p ?y } { ?x e:q ?y } UNION { ?x e:r ?y }",
            [("x", "p", "y"), ("x", "q", "y"), ("x", "r", "y")],
        ),
        ("{ SELECT ?x WHERE { ?x e:p ?y } }", [("x", "p", "y")]),
        ("?x <https://e.org/p> 'a ; b . c' # e:no e:no e:no", [("x", "p", "'a ; b . c'")]),
    ],
)
def test_patterns_are_read(pattern, reads):
    text = f"CONSTRUCT {{ $this e:w ?x }} WHERE {{ {pattern}\n}}"
    Store().query("PREFIX e: <https://e.org/> " + text)
    found = read_construct(text, PREFIXES)
    assert steps(found.writes) == [("this", "w", "x")]
    assert steps(found.reads) == reads
    assert found.undeclared == ()


def test_a_prefix_of_the_text_itself_counts():
    found = read_construct("PREFIX f: <https://e.org/> CONSTRUCT { ?x f:p f:o } WHERE { ?x g:p f:o }", {})
    assert steps(found.writes) == [("x", "p", "o")]
    assert [token.text for token in found.undeclared] == ["g:p"]


@given(st.text(alphabet="{}()[];.,/|^*+?$:ae<>\"' \nVALUESFILTER", max_size=60))
def test_no_text_breaks_the_reader(text):
    read_construct(text, PREFIXES)
    read_construct(f"CONSTRUCT {{ {text} }} WHERE {{ {text} }}", PREFIXES)


def test_the_shipped_rules_are_all_read():
    model = load_model()
    assert list(check_rules(model)) == []
    texts = [row["text"].value for row in model.rows("SELECT ?text WHERE { ?rule sh:construct ?text }")]
    assert len(texts) == 15
    for text in texts:
        namespaces = {"core": "c:", "man": "m:", "nav": "n:", "rdfs": "r:", "rule": "u:"}
        found = read_construct(text, namespaces)
        assert found.writes
        assert {step.subject for step in found.writes} == {"this"}
        assert len(found.reads) >= 2
