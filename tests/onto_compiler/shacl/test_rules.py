"""Rules of every kind conclude what SHACL-AF says they do, node by node or all nodes at once."""

import pytest
from pyoxigraph import NamedNode, RdfFormat, Store

from onto_compiler.problems import OntoError
from onto_compiler.rules import apply_rules, read_rules

PREFIXES = """@prefix ex: <https://example.org/> . @prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . """
EX = "https://example.org/"
CONCLUDED = NamedNode("urn:concluded")
DATA = "ex:a a ex:Thing ; ex:p 1 , 2 ; ex:q ex:b . ex:b a ex:Thing ; ex:p 3 . "


def concluded(rules, focus=None):
    store = Store()
    store.load((PREFIXES + DATA + rules).encode(), format=RdfFormat.TURTLE)
    found = apply_rules(store, read_rules(store), CONCLUDED, focus)
    assert {q.triple for q in store.quads_for_pattern(None, None, None, CONCLUDED)} == set(found)
    return {
        tuple(str(part).replace(EX, "").replace("^^<http://www.w3.org/2001/XMLSchema#integer>", "") for part in t)
        for t in found
    }


def rule(body, shape="sh:targetClass ex:Thing"):
    return f"ex:S a sh:NodeShape ; {shape} ; sh:rule [ {body} ] ."


def test_a_triple_rule_takes_every_combination():
    body = "a sh:TripleRule ; sh:subject sh:this ; sh:predicate ex:r ; sh:object [ sh:path ex:p ]"
    assert concluded(rule(body)) == {("<a>", "<r>", '"1"'), ("<a>", "<r>", '"2"'), ("<b>", "<r>", '"3"')}


def test_a_literal_is_no_subject():
    assert (
        concluded(rule("a sh:TripleRule ; sh:subject [ sh:path ex:p ] ; sh:predicate ex:r ; sh:object ex:x")) == set()
    )


def test_conditions_choose_the_nodes():
    body = 'sh:construct "CONSTRUCT { $this a <urn:Lone> } WHERE { $this ?p ?v }" ; a sh:SPARQLRule ; '
    condition = "sh:condition [ sh:property [ sh:path ex:p ; sh:maxCount 1 ] ]"
    assert {t[0] for t in concluded(rule(body + condition))} == {"<b>"}
    assert {t[0] for t in concluded(rule(body))} == {"<a>", "<b>"}


@pytest.mark.parametrize(
    "off",
    [
        (
            "a sh:TripleRule ; sh:subject sh:this ; sh:predicate ex:r ; sh:object 1 ; sh:deactivated true",
            "sh:targetNode ex:a",
        ),
        (
            "a sh:TripleRule ; sh:subject sh:this ; sh:predicate ex:r ; sh:object 1",
            "sh:targetNode ex:a ; sh:deactivated true",
        ),
    ],
)
def test_what_is_deactivated_concludes_nothing(off):
    assert concluded(rule(*off)) == set()
    assert len(concluded(rule(*(part.replace("deactivated true", "deactivated false") for part in off)))) == 1


def test_a_later_order_reads_what_an_earlier_one_concluded():
    first = "a sh:TripleRule ; sh:order 1 ; sh:subject sh:this ; sh:predicate ex:r ; sh:object ex:x"
    second = "a sh:TripleRule ; sh:order 2 ; sh:subject sh:this ; sh:predicate ex:s ; sh:object [ sh:path ex:r ]"
    both = f"ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:rule [ {first} ] , [ {second} ] ."
    assert concluded(both) == {("<a>", "<r>", "<x>"), ("<a>", "<s>", "<x>")}
    assert concluded(both.replace("sh:order 2", "sh:order 1")) == {("<a>", "<r>", "<x>")}


def test_expressions_unite_intersect_filter_and_choose():
    parts = {
        "union": "[ sh:union ( [ sh:path ex:p ] ex:x ) ]",
        "intersection": "[ sh:intersection ( [ sh:path ex:p ] [ sh:union ( 2 7 ) ] ) ]",
        "filter": "[ sh:filterShape [ sh:minInclusive 2 ] ; sh:nodes [ sh:path ex:p ] ]",
        "count": "[ sh:count [ sh:path ex:p ] ]",
        "max": "[ sh:max [ sh:path ex:p ] ]",
        "if": "[ sh:if [ sh:exists [ sh:path ex:q ] ] ; sh:then ex:yes ; sh:else ex:no ]",
    }
    rules = " , ".join(
        f"[ a sh:TripleRule ; sh:subject sh:this ; sh:predicate ex:{name} ; sh:object {text} ]"
        for name, text in parts.items()
    )
    found = concluded(f"ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:rule {rules} .")
    assert {(p, o) for _, p, o in found} == {
        *(("<union>", value) for value in ('"1"', '"2"', "<x>")),
        ("<intersection>", '"2"'),
        ("<filter>", '"2"'),
        ("<count>", '"2"'),
        ("<max>", '"2"'),
        ("<if>", "<yes>"),
    }


def test_focus_restricts_every_kind_of_rule():
    body = "a sh:TripleRule ; sh:subject sh:this ; sh:predicate ex:r ; sh:object ex:x"
    assert {t[0] for t in concluded(rule(body), [NamedNode(EX + "b")])} == {"<b>"}


@pytest.mark.parametrize(
    "body",
    [
        "a sh:TripleRule ; sh:subject sh:this",
        "a sh:SPARQLRule",
        "a ex:Rule",
        'a sh:SPARQLRule ; sh:construct "CONSTRUCT" ; sh:condition [ sh:nodeKind sh:IRI ]',
        'a sh:SPARQLRule ; sh:construct "SELECT * WHERE {}"',
        'a sh:TripleRule ; sh:order "first" ; sh:subject sh:this ; sh:predicate ex:r ; sh:object 1',
    ],
)
def test_a_rule_that_cannot_run_is_a_problem(body):
    with pytest.raises(OntoError, match="SHP002"):
        concluded(rule(body))
