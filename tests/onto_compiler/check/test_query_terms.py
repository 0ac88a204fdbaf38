"""A name in a query that nothing declares is reported where it stands, as one in Turtle is."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import NamedNode

import ontology
from onto_compiler.check.data import check_data
from onto_compiler.check.run import check
from onto_compiler.problems import OntoError
from onto_compiler.rdf import CORE, PREFIXES, TRACE
from onto_compiler.sources import load_store
from onto_compiler.sparql_faults.undeclared import StoreVocabulary, undeclared
from runtime.trace.sparql import ask

HEAD = """@prefix core: <https://w3id.org/onto-evwm/core#> .
@prefix ex: <http://example.org/> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
ex: sh:declare [ sh:prefix "core" ; sh:namespace "https://w3id.org/onto-evwm/core#"^^xsd:anyURI ] ,
    [ sh:prefix "ex" ; sh:namespace "http://example.org/"^^xsd:anyURI ] ,
    [ sh:prefix "rdfs" ; sh:namespace "http://www.w3.org/2000/01/rdf-schema#"^^xsd:anyURI ] .
"""
DATA = "ex:a a ex:T ; ex:name 'x' ; ex:p ex:value1 . ex:value2 ex:p 2 ."
PLACES = {
    "constraint": 'ex:S a sh:NodeShape ; sh:targetClass ex:T ; sh:sparql [ sh:prefixes ex: ; sh:select "{}" ] .',
    "target": """ex:S a sh:NodeShape ; sh:nodeKind sh:IRI ; sh:target [ a sh:SPARQLTarget ; sh:prefixes ex: ;
    sh:select "{}" ] .""",
    "function": """ex:S a sh:NodeShape ; sh:targetClass ex:T ; sh:nodeKind sh:IRI . ex:f a sh:SPARQLFunction ;
    sh:prefixes ex: ; sh:parameter [ sh:path ex:p ] ; sh:select "{}" .""",
}


@pytest.fixture(scope="module")
def shipped():
    return StoreVocabulary(load_store())


@pytest.fixture
def found(tmp_path):
    def problems(shapes, data=DATA):
        (tmp_path / "data.ttl").write_text(HEAD + data)
        (tmp_path / "shapes.ttl").write_text(HEAD + shapes)
        reported = check_data([tmp_path / "data.ttl"], [tmp_path / "shapes.ttl"]).problems
        assert {problem.file for problem in reported} <= {str(tmp_path / "shapes.ttl")}
        return [(p.severity, p.code, p.line, p.message.split("`")[1], p.hint) for p in reported]

    return problems


@pytest.mark.parametrize("place", PLACES)
def test_every_query_of_a_shapes_graph_is_read(found, place):
    query = "SELECT ?this WHERE {{ ?this {} ?v }}"
    (one,) = found(PLACES[place].replace("{}", query.format("core:aritty")))
    assert one[:2] == ("error", "VOC001")
    assert one[3:] == ("core:aritty", "did you mean `core:arity`? Otherwise: correct the name, or declare the term")
    (other,) = found(PLACES[place].replace("{}", query.format("rdfs:lable")))
    assert other[:2] + other[3:] == ("error", "VOC011", "rdfs:lable", "did you mean `rdfs:label`?")
    assert found(PLACES[place].replace("{}", query.format("core:arity"))) == []


@pytest.mark.parametrize(
    ("name", "data", "meant"),
    [
        ("ex:nmae", DATA, "ex:name"),
        ("ex:weight", f"{DATA} ex:height a owl:DatatypeProperty .", "ex:height"),
        ("ex:colour", f"{DATA} ex:height a owl:DatatypeProperty .", ""),
        ("ex:colour", DATA, None),
        ("ex:value1", f"{DATA} ex:height a owl:DatatypeProperty .", None),
        ("ex:value9", DATA, None),
    ],
)
def test_names_of_others_are_a_warning_where_their_vocabulary_is_at_hand(found, name, data, meant):
    query = f"SELECT $this WHERE {{ $this ?p ?v FILTER (?p = {name} && 1 = 2) }}"
    problems = found(PLACES["constraint"].replace("{}", query), data)
    hint = "correct the name, or declare the term"
    expected = [("warning", "VOC001", name, f"did you mean `{meant}`? Otherwise: {hint}" if meant else hint)]
    assert [one[:2] + one[3:] for one in problems] == (expected if meant is not None else [])


def test_the_place_is_the_name_in_the_query(found):
    (one,) = found(PLACES["constraint"].replace('"{}"', '"""SELECT $this\n  WHERE { $this core:nothing 1 }"""'))
    assert one[2] == HEAD.count("\n") + 2


def test_a_check_of_an_ontology_reads_its_queries_too(tmp_path):
    path = tmp_path / "shapes.ttl"
    path.write_text(HEAD + PLACES["constraint"].replace("{}", "SELECT $this WHERE { $this a core:Predicat }"))
    problems = [p for p in check([path]).problems if p.code == "VOC001"]
    assert [(p.line, p.severity) for p in problems] == [(9, "error")]
    assert problems[0].hint.startswith("did you mean `core:Predicate`?")


def test_the_shipped_queries_name_declared_terms_alone(shipped):
    texts = [path.read_text() for kind in ("competency", "checks") for path in ontology.query_files(kind)]
    assert len(texts) > 40
    assert [fault for text in texts for fault in undeclared(text, PREFIXES, shipped)] == []


def test_a_query_of_a_trace_is_refused_with_all_its_undeclared_names(shipped):
    query = "# core:No\nSELECT ?e { ?e a core:Epsode ; trace:tsk 'core:No' ; trace:task ?t . <http://x/core:No> ?p ?o }"
    with pytest.raises(OntoError) as raised:
        ask(shipped.store, query, file="question.rq")
    assert [(p.line, p.column, p.message, p.hint.partition(" Oth")[0]) for p in raised.value.problems] == [
        (2, 18, "`core:Epsode` is not declared", "did you mean `trace:Episode`?"),
        (2, 32, "`trace:tsk` is not declared", "did you mean `trace:task`?"),
    ]
    assert ask(shipped.store, query.replace("Epsode", "Entity").replace("tsk", "task")).rows == ()


@given(st.sampled_from([CORE, TRACE]), st.from_regex(r"[A-Za-z][A-Za-z0-9]{0,8}", fullmatch=True), st.booleans())
def test_whole_iris_and_names_are_judged_alike(shipped, namespace, local, whole):
    iri = NamedNode(namespace + local)
    prefix = next(name for name, other in PREFIXES.items() if other == namespace)
    name = str(iri) if whole else f"{prefix}:{local}"
    found = list(undeclared(f"ASK {{ ?s ?p {name} . ?s ?p ?o }}", PREFIXES, shipped))
    assert bool(found) == (next(shipped.store.quads_for_pattern(iri, None, None, None), None) is None)
    assert all((one, fault.length) == (iri.value, len(name)) for one, fault in found)
