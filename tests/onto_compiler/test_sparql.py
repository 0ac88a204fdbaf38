"""No query of a person's reaches the network, however its keyword is written; what only looks like it is asked."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import Store

from benchmarks.listening import listening
from onto_compiler.sparql import refusal

PREFIX = "PREFIX service: <http://example.org/service#> PREFIX e: <http://example.org/> "
CALLS = [
    "SELECT * { SERVICE <URL> { ?s ?p ?o } }",
    "ASK { service silent <URL> { ?s ?p ?o } }",
    "CONSTRUCT { ?s ?p ?o } WHERE { SERVICE<URL>{ ?s ?p ?o } }",
    "DESCRIBE ?s { { SELECT * { SERVICE <URL> { ?s ?p ?o } } } }",
    "SELECT * { # nothing\rSERVICE <URL> { ?s ?p ?o } }",
    "PREFIX : <URL> SELECT * { SERVICE:x { ?s ?p ?o } }",
    "SELECT * { SERVICESILENT<URL> { ?s ?p ?o } }",
    "SELECT * { ?s ?p trueSERVICE<URL> { ?s ?p ?o } }",
    "SELECT * { VALUES ?v { UNDEF }SERVICE<URL> { ?s ?p ?o } }",
    "SELECT * { OPTIONAL { ?s <e:it's> ?o } SERVICE <URL> { ?s ?p ?o } }",
    PREFIX + "SELECT * { OPTIONAL { ?s ?p e:it\\'s } SERVICE <URL> { ?s ?p ?o } }",
    "SELECT * { FILTER EXISTS { SERVICE <URL> { ?s ?p ?o } } }",
    "SELECT * { VALUES ?v { <URL> } LATERAL { SERVICE ?v { ?s ?p ?o } } }",
    "SELECT * { BIND (<URL> AS ?v) FILTER(1<2)SERVICE#>\n<URL> { ?s ?p ?o } }",
]
QUIET = [
    'SELECT * { ?s <http://example.org/service> "SERVICE <URL> {" } # SERVICE <URL> { }',
    "SELECT ?service $SERVICE { ?service ?p '''a\nSERVICE <URL> {''' }",
    PREFIX + "SELECT * { GRAPH service:graph { ?s service:SERVICE service:object } }",
    PREFIX + "SELECT * FROM service:graph { ?s ?p ?o }",  # noqa: S608 - SPARQL
    "SELECT * { ?s ?p 'a'@service-desk ; <urn:service:x> _:service }",
]


@pytest.fixture(scope="module")
def listener():
    """An address of this machine, and the connections that were made to it."""
    with listening() as (address, made):
        yield address, made


def connects(query, made):
    """Whether Oxigraph, asked without a guard, makes a connection."""
    made.clear()
    try:
        answer = Store().query(query)
        list(answer if hasattr(answer, "__iter__") else [])
    except (OSError, RuntimeError, SyntaxError, ValueError):
        pass
    return bool(made)


def refused(query):
    try:
        return refusal(query, graphs={"http://example.org/service#graph"}) is not None
    except SyntaxError:
        return True


@pytest.mark.parametrize("query", CALLS)
def test_a_call_is_refused_however_it_is_written(query, listener):
    assert refused(query.replace("URL", listener[0]))


def test_the_calls_are_calls(listener):
    """Otherwise the test above would prove nothing."""
    url, made = listener
    assert sum(connects(query.replace("URL", url), made) for query in CALLS) >= 10


@pytest.mark.parametrize("query", QUIET)
def test_what_only_looks_like_a_call_is_asked(query, listener):
    url, made = listener
    assert not refused(query.replace("URL", url))
    assert not connects(query.replace("URL", url), made)


PIECES = [
    *("SERVICE", "service", "SILENT", "{", "}", "(", ")", "<URL>", "?s", "$v", "true", "1", "1.", "#", "\n", "\r"),
    *('"', "'", '"""', "<", ">", " ", ".", ";", "e:it\\'s", "_:b", "e:", "@en", "FILTER", "BIND", "AS", "OPTIONAL"),
    *("?s ?p ?o", "EXISTS", "UNDEF", "VALUES ?v", "GRAPH", "\\u0053", "<e:it's>", "^^", "|", "/", "*", "SELECT *"),
]


@settings(max_examples=300, deadline=None)
@given(st.lists(st.sampled_from(PIECES), max_size=8), st.lists(st.sampled_from(PIECES), max_size=8))
def test_what_is_not_refused_makes_no_connection(listener, before, after):
    url, made = listener
    query = f"{PREFIX} SELECT * {{ {''.join(before)}SERVICE <URL> {{ ?s ?p ?o }} {''.join(after)} }}"
    query = query.replace("URL", url)
    assert refused(query) or not connects(query, made)


@pytest.mark.parametrize("word", ["ADD", "CLEAR", "COPY", "CREATE", "DELETE", "DROP", "INSERT", "LOAD", "MOVE", "WITH"])
def test_an_update_is_told_from_a_query(word):
    query = f"# first\nPREFIX e: <http://example.org/>\nBASE <http://example.org/>\n{word.lower()} <x>"
    found = refusal(query)
    assert (found.code, found.word) == ("QRY002", word)
    start, length = found.place(query)
    assert query[start : start + length] == word.lower()


@pytest.mark.parametrize("source", ["FROM <http://example.org/b>", "FROM e:a FROM NAMED e:b", "FROM NAMED e:b"])
def test_a_graph_that_is_not_here_is_refused(source):
    query = f"{PREFIX} SELECT * {source} WHERE {{ ?s ?p ?o }}"
    assert refusal(query, graphs={"http://example.org/a"}).code == "QRY003"
    assert refusal(query, graphs={"http://example.org/a", "http://example.org/b"}) is None
