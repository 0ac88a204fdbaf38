"""What is wrong with a query is said in a sentence, at the token that a person wrote."""

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import Store

from onto_compiler.rdf import PREFIXES
from onto_compiler.sparql_faults.explain import query_fault
from onto_compiler.sparql_faults.form import unexpected
from onto_compiler.turtle.tokens import tokens
from ontology import query_files

CASES = [
    ("SELECT ?s WHERE { ?s foo:bar ?o }", "foo:bar", "the prefix `foo:` is not declared"),
    ("PREFIX ex: <http://e/> ASK { ?s ex:p ?o ; xe:q 1 }", "xe:q", "the prefix `xe:` is not declared"),
    ("SELECT ?s\nWHERE { ?s a ?t \n", "{", "the `{` is not closed: the query ends before it is complete"),
    ("SELECT ?s WHERE { ?s a ?t FILTER(?s = (1 + 2) }", "}", "`}` cannot stand here; expected `)`"),
    ("SELCT ?s WHERE { ?s a ?t }", "SELCT", "a query begins with SELECT, ASK, CONSTRUCT or DESCRIBE, not with `SELCT`"),
    ("PREFIX e: <http://e/>\nFIND ?s { }", "FIND", "a query begins with SELECT, ASK, CONSTRUCT or DESCRIBE"),
    ("PREFIX e: <http://e/>", "<http://e/>", "the query ends behind its prefixes"),
    ("@prefix e: <http://e/> . ASK {}", "@prefix", "`@prefix` is Turtle, and this is SPARQL"),
    ("PREFIX e <http://e/> ASK {}", "e", "`e` cannot stand here; expected a prefixed name"),
    ("", "", "the query is empty"),
    ("  # only a comment", "", "the query is empty"),
    ("ASK { ?s ?p ?o FILTER(?s > ) }", ")", "what begins with `)` is not understood"),
    ("ASK { ?s ?p }", "}", "`}` cannot stand here; expected a term"),
    ("ASK { ?s ?p ?o ?q }", "?q", "what begins with `?q` is not understood"),
    ("ASK { ?s ?p ?o } }", "}", "the `}` closes nothing"),
    ("ASK { ?s ?p ?o . OPTINAL { ?s ?q ?r } }", "OPTINAL", "`OPTINAL` cannot stand here"),
    ("ASK { FILTER(FOO(?s)) }", "FOO", "`FOO` is no function of SPARQL"),
    ("ASK { FILTER(STRSTART(?s, 'a')) }", "STRSTART", "`STRSTART` is no function of SPARQL"),
    ("ASK { FILTER(STR(?a, ?b)) }", "STR", "`STR` takes 1 argument, not 2"),
    ("ASK { FILTER(CONTAINS(?a)) }", "CONTAINS", "`CONTAINS` takes 2 arguments, not 1"),
    ('ASK { ?s ?p "abc }', '"', 'the text that begins with " does not end'),
    ("ASK { ?s <a b> ?o }", "<a b>", "`<a b>` is no IRI: it holds a space"),
    ("ASK { ?s <rel> ?o }", "<rel>", "`<rel>` is no IRI by itself"),
    ("SELECT ?s { ?s ?p ?t } GROUP BY ?t", "?s", "`?s` is selected, but the groups have no single value for it"),
    ("SELECT * { BIND(1 AS ?x) BIND(2 AS ?x) }", "?x", "`?x` is assigned, but has a value already"),
    ("SELECT (1 AS ?x) { ?x ?p ?o }", "?x", "`?x` is assigned, but has a value already"),
    ("SELECT COUNT(?s) { ?s ?p ?o }", "COUNT", "`COUNT` cannot stand here"),
    ("SELECT (COUNT(?s)) { ?s ?p ?o }", ")", "`)` cannot stand here; expected AS"),
    ("SELECT ?s, ?p { ?s ?p ?o }", ",", "`,` cannot stand here"),
    ("SELECT ?s { ?s ?p ?o } LIMIT x", "x", "`x` cannot stand here; expected a number"),
    ("ASK { { ?s ?p ?o } UNION }", "}", "`}` cannot stand here; expected `{`"),
    ("ASK { ?s <http://e/p>/ ?o }", "?o", "`?o` cannot stand here"),
]


@pytest.mark.parametrize(("query", "at", "message"), CASES)
@pytest.mark.parametrize("before", ["", "\ufeff", "# a comment\n"])
def test_a_fault_is_named_at_its_token(query, at, message, before):
    text = before + query
    fault = query_fault(text)
    assert fault.message.startswith(message)
    assert fault.code == ""
    if at:
        assert text[fault.start : fault.start + fault.length] == at
        assert fault.start >= len(before)


@pytest.mark.parametrize(
    ("query", "hint"),
    [
        ("SELCT * {}", "did you mean `SELECT`?"),
        ("ASK { ?s skos:note ?o }", "add a line `PREFIX skos: <http://www.w3.org/2004/02/skos/core#>`"),
        ("PREFIX owl2: <http://e/> ASK { ?s owl:p ?o }", "did you mean `owl2`? Otherwise: add a line `PREFIX owl:"),
        ("ASK { FILTER(STRSTART(?s, 'a')) }", "did you mean `STRSTARTS`?"),
        ("SELECT ?s WERE { ?s ?p ?o }", "did you mean `WHERE`?"),
        ("SELECT COUNT(?s) { ?s ?p ?o }", "write `(COUNT(...) AS ?name)`"),
        ("ASK { ?s ?p ?o ) }", "close with `}` first"),
    ],
)
def test_the_hint_says_what_to_write(query, hint):
    assert query_fault(query).hint.startswith(hint)


def test_given_prefixes_need_no_declaration():
    assert query_fault("ASK { ?s ex:p ?o }", {"ex": "http://e/"}) is None
    assert query_fault("ASK { ?s ex:p ?o ; ex2:q 1 }", {"ex": "http://e/"}, declare="declare {prefix}").hint.endswith(
        "declare ex2"
    )


def test_a_refusal_keeps_its_code_and_place():
    text = "\ufeffSELECT * { SERVICE <http://127.0.0.1:9/q> { ?s ?p ?o } }"
    fault = query_fault(text)
    assert (fault.code, text[fault.start : fault.start + fault.length]) == ("QRY001", "SERVICE")


def test_sound_queries_have_no_fault():
    files = [*query_files("competency"), *query_files("checks")]
    assert len(files) > 40
    assert [file.name for file in files if query_fault(file.read_text(), PREFIXES)] == []


SOUND = [
    """PREFIX e: <http://e/>
SELECT ?s (COUNT(DISTINCT ?o) AS ?n) WHERE {
    ?s e:p+/^e:q|!(e:r|^a) ?o ; a e:T . OPTIONAL { ?s e:n -1.5e3 } FILTER(?o > 3 && ?o IN (1, 2) || !BOUND(?s))
} GROUP BY ?s HAVING(COUNT(?o) > 1) ORDER BY DESC(?n) LIMIT 3""",
    """CONSTRUCT { ?s ?p [ ?q ( 1 'a'@en "x"^^<http://e/t> ) ] } WHERE {
    GRAPH ?g { ?s ?p ?o } VALUES (?q ?r) { (1 UNDEF) } MINUS { ?s ?p 1 } BIND(IF(?o, 'a', STR(?o)) AS ?z)
    FILTER NOT EXISTS { ?s ?p 2 } }""",
    "DESCRIBE <http://e/a> ?x { ?x ?p ?o { SELECT * { ?x ?q ?r } } UNION { ?x a <http://e/b> } }",
    "ASK { ?s ?p <<( ?a ?b ?c )>> . << ?a ?b ?c ~ ?r >> ?q 1 . ?s ?p ?o ~ ?r {| ?q 2 |} }",
]


@settings(max_examples=300, deadline=None)
@given(
    st.sampled_from(SOUND),
    st.integers(0, 400),
    st.integers(0, 3),
    st.sampled_from(["", "{", "}", "(", " ?v ", "x:y ", "'", "<"]),
)
def test_a_damaged_query_has_a_fault_exactly_where_oxigraph_rejects_it(query, at, length, instead):
    at %= len(query)
    damaged = query[:at] + instead + query[at + length :]
    try:
        Store().query(damaged)
        rejected = False
    except SyntaxError:
        rejected = True
    except (ValueError, RuntimeError):
        rejected = False
    fault = query_fault(damaged)
    assert (fault is not None) == rejected
    if fault is not None:
        assert 0 <= fault.start <= len(damaged)
        assert fault.message
        assert "expected one of" not in fault.message


def test_the_grammar_takes_what_oxigraph_takes():
    """Otherwise it would blame a sound part of a query that is wrong elsewhere."""
    files = [*query_files("competency"), *query_files("checks")]
    for query in [*SOUND, *(file.read_text() for file in files)]:
        assert unexpected(query, list(tokens(query))) is None, query


def test_noise_ends_in_a_fault():
    generator = random.Random(7)  # noqa: S311 - noise
    for _ in range(300):
        text = "".join(generator.choice("SELECT ASK{}()?xy:<>'\"#@^|&!=,.;~0-") for _ in range(generator.randrange(40)))
        assert query_fault(text) is not None or text.upper().startswith(("ASK", "SELECT"))
