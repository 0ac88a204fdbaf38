"""A pre-bound variable has its value everywhere in a query, whatever kind of term it is."""

import pytest
from pyoxigraph import BlankNode, Literal, NamedNode, Quad, Store

from onto_compiler.shacl.prebinding import is_joined, read_query, unsupported

P = NamedNode("urn:p")
A, B = NamedNode("urn:a"), BlankNode("b")
STORE = Store()
STORE.extend([Quad(A, P, Literal(1)), Quad(B, P, Literal(2)), Quad(A, P, B)])


def ask(text, term):
    query, functions = read_query(text, ("this",)).bind({"this": term})
    rows = STORE.query(query, custom_functions=functions or None)
    if not hasattr(rows, "variables"):
        return bool(rows)
    return [{v.value: row[v] for v in rows.variables if row[v] is not None} for row in rows]


@pytest.mark.parametrize("term", [A, B, Literal("x")], ids=["iri", "blank", "literal"])
@pytest.mark.parametrize(
    "body",
    [
        "FILTER bound($this)",
        "FILTER (bound($this) && sameTerm($this, $this))",
        "{ { FILTER (bound($this)) } FILTER bound(?this) }",
        "BIND ($this AS ?other) FILTER bound(?other)",
        "{ SELECT $this WHERE { BIND ($this AS ?x) FILTER bound(?x) } }",
        "{ FILTER (false) } UNION { FILTER bound($this) }",
        "OPTIONAL { BIND ($this AS ?x) } FILTER bound(?x)",
        "FILTER NOT EXISTS { FILTER (!bound($this)) }",
    ],
)
def test_it_is_bound_at_every_depth(body, term):
    assert ask(f"ASK {{ {body} }}", term) is True
    assert [row["this"] for row in ask(f"SELECT $this WHERE {{ {body} }}", term)] == [term]


@pytest.mark.parametrize(("term", "values"), [(A, {Literal(1), B}), (B, {Literal(2)})], ids=["iri", "blank"])
def test_patterns_match_the_node_alone(term, values):
    assert {row["v"] for row in ask("SELECT $this ?v WHERE { $this <urn:p> ?v }", term)} == values
    grouped = (
        "SELECT $this (COUNT(?v) AS ?n) WHERE { $this <urn:p> ?v } GROUP BY $this HAVING (COUNT(?v) > 0) ORDER BY $this"
    )
    assert ask(grouped, term) == [{"this": term, "n": Literal(len(values))}]


def test_a_variable_without_a_value_stays_one():
    text, functions = read_query("ASK { FILTER (COALESCE(?other, 1) = 1) }", ("this", "other")).bind({"this": A})
    assert (text, functions) == ("ASK { FILTER (COALESCE(?other, 1) = 1) }", {})


def test_names_in_strings_and_comments_are_left_alone():
    text = 'SELECT ?x WHERE { # $this\n BIND ("$this" AS ?x) }'
    assert ask(text, A) == [{"x": Literal("$this")}]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("SELECT $this WHERE { $this ?p ?o }", ""),
        ("SELECT $this WHERE { { SELECT $this ?o WHERE { $this ?p ?o } } }", ""),
        ("SELECT $this WHERE { { SELECT * WHERE { $this ?p ?o } } }", ""),
        ("SELECT $this WHERE { { SELECT * WHERE { FILTER ($this = 1) } } }", "`$this`"),
        ("SELECT $this WHERE { { SELECT ?o WHERE { $this ?p ?o } } }", "`$this`"),
        ("SELECT $this WHERE { ?s ?p ?o MINUS { $this ?p 1 } }", "MINUS"),
        ("SELECT $this WHERE { VALUES ?x { 1 } }", "VALUES"),
        ("SELECT (1 AS ?this) WHERE { }", "assigned"),
        ('SELECT $this WHERE { $this ?p "MINUS" }', ""),
    ],
)
def test_what_may_not_stand_beside_it_is_named(text, said):
    found = (unsupported(text, ("this", "shapesGraph")) or ("",))[0]
    assert (said in found) if said else found == ""


@pytest.mark.parametrize(
    ("where", "joined"),
    [
        ("$this <urn:p> ?v", True),
        ("$this <urn:p> ?v FILTER (?v > 1)", True),
        ("?v <urn:p> 1", False),
        ("$this <urn:p> ?v FILTER ($this != ?v)", False),
        ("$this <urn:p> ?v OPTIONAL { $this <urn:q> ?w }", False),
        ("BIND ($this AS ?v)", False),
    ],
)
def test_a_rule_is_asked_for_all_nodes_only_where_that_is_the_same(where, joined):
    assert is_joined(f"CONSTRUCT {{ $this <urn:r> ?v }} WHERE {{ {where} }}", "this") == joined
