"""Other people's data, shapes and queries: forms are kept, terms are shown, and a fault stands where it was made."""

import argparse
import json
from pathlib import Path

import pyshacl
import pytest
import rdflib
from pydantic_sarif.model import StaticAnalysisResultsFormatSarifVersion210JsonSchema as SarifSchema
from pyoxigraph import BlankNode, Literal, NamedNode, RdfFormat, Triple, parse, serialize
from rdflib import Graph as RdflibGraph
from rdflib.compare import isomorphic

from onto_compiler.check.command import CHECK
from onto_compiler.check.data import check_data
from onto_compiler.command import CLEAN, FINDINGS, MISUSE
from onto_compiler.diff.command import DIFF
from onto_compiler.problems import OntoError
from onto_compiler.rdf import SH
from runtime.trace.sparql import ask
from runtime.trace.store import open_trace

CASES = Path(__file__).parent / "cases"
PREFIXES = """@prefix ex: <http://example.org/> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
"""


@pytest.fixture
def put(tmp_path):
    def write(name, text):
        path = tmp_path / name
        path.write_text(PREFIXES + text if name.endswith(".ttl") else text, encoding="utf-8")
        return path

    return write


def problems(data, shapes):
    return check_data([data], [shapes]).problems


def run(*words, command=CHECK):
    parser = argparse.ArgumentParser()
    command.configure(parser)
    return command.run(parser.parse_args([str(word) for word in words]))


# Lexical forms


def test_a_query_sees_what_the_file_says():
    found = problems(CASES / "lexical_forms/data.ttl", CASES / "lexical_forms/shapes.ttl")
    spelt = {p.message.partition("value spelt ")[2] for p in found if "spelt" in p.message}
    (data,) = {p.file for p in found}
    forms = [value.object.value for value in parse(Path(data).read_bytes(), format=RdfFormat.TURTLE)][1:]
    assert {"007", "1.50", "1.0E1", "05", "1e400", "2024-01-01+00:00"} < set(forms)
    assert spelt == {f"{form} (of {form})" for form in forms}
    # The Core constraint beside it shows the same forms, each at its place.
    pattern = [p for p in found if "must match the pattern" in p.message]
    assert len(pattern) == len(forms)
    assert all(any(form in p.message for p in pattern) for form in forms)


COUNTED = """ex:S a sh:NodeShape ; sh:targetSubjectsOf ex:v ; sh:sparql [ sh:select "SELECT $this ?value WHERE { $this \
<http://example.org/v> ?value . FILTER %s }" ] ; sh:property [ sh:path ex:v ; %s ] ."""
VALUES = """ex:a ex:v 7 , 007 , 7.0 , 7.00 , "7"^^xsd:byte , "+7"^^xsd:integer , 7e0 , "07" , true , "1"^^xsd:boolean ,
    "2024-01-01T00:00:00.0Z"^^xsd:dateTime , 8 , 12345678901234567890123 , "7"^^xsd:positiveInteger ."""


@pytest.mark.parametrize(
    ("query", "core"),
    [
        ("(DATATYPE(?value) != xsd:integer)", "sh:datatype xsd:integer"),
        ("(!REGEX(STR(?value), '^0'))", 'sh:pattern "^0"'),
        ("(STRLEN(STR(?value)) > 2)", "sh:maxLength 2"),
        ("(STRLEN(STR(?value)) < 3)", "sh:minLength 3"),
        ("(!sameTerm(?value, 007) && !sameTerm(?value, 7.0))", "sh:in ( 007 7.0 )"),
        ("(!COALESCE(?value < 8, false))", "sh:maxExclusive 8"),
        ("(!COALESCE(?value >= 7.5, false))", "sh:minInclusive 7.5"),
    ],
)
def test_core_and_sparql_agree(put, query, core):
    text = COUNTED % (query.replace("xsd:integer", "<http://www.w3.org/2001/XMLSchema#integer>"), core)
    data = put("data.ttl", VALUES)
    found = [p.result for p in problems(data, put("shapes.ttl", text))]
    sparql = "SPARQLConstraintComponent"
    by_query = {json.dumps(r["value"]) for r in found if r["sourceConstraintComponent"].endswith(sparql)}
    by_core = {json.dumps(r["value"]) for r in found if not r["sourceConstraintComponent"].endswith(sparql)}
    assert by_query == by_core != set()


FUNCTION = '''ex:spell a sh:SPARQLFunction ; sh:parameter [ sh:path ex:arg ] ; sh:returnType xsd:string ;
    sh:select "SELECT ?s WHERE { BIND(CONCAT('<', STR($arg), '>') AS ?s) }" .
ex:S a sh:NodeShape ;
    sh:target [ a sh:SPARQLTarget ; sh:select "SELECT ?this WHERE { ?this ?p ?v FILTER(STR(?v) = '007') }" ] ;
    sh:sparql [ sh:message "{?s}" ; sh:select """SELECT $this ?s WHERE {
        $this <http://example.org/v> ?v . BIND (<http://example.org/spell>(?v) AS ?s) }""" ] .
'''


def test_forms_reach_targets_and_functions(put):
    data = put("data.ttl", "ex:a ex:v 007 . ex:b ex:v 7 .")
    found = [p.message for p in problems(data, put("shapes.ttl", FUNCTION))]
    assert found == ["`ex:a` violates the shape `ex:S`: <007>"]


def as_rdflib(text, rdf_format=RdfFormat.TURTLE):
    """A graph with its forms: rdflib makes Python's numbers of what Turtle writes without quotation marks."""
    before = PREFIXES if rdf_format == RdfFormat.TURTLE else ""
    triples = (Triple(*one[:3]) for one in map(tuple, parse((before + text).encode(), format=rdf_format)))
    return RdflibGraph().parse(data=serialize(triples, format=RdfFormat.N_TRIPLES), format="nt")


QUERIES = [
    ("(STRLEN(STR(?value)) > 2)", "sh:maxLength 2"),
    ("REGEX(STR(?value), '[.+]')", "sh:maxCount 3"),
    ("(DATATYPE(?value) != xsd:integer && isNumeric(?value))", "sh:datatype xsd:integer"),
    ("(?value = 7 && STR(?value) != '7')", "sh:hasValue 07"),
    ("(isNumeric(?value) && ?value * 2 > 14)", "sh:in ( 7 007 7.00 )"),
]


@pytest.mark.parametrize(("query", "core"), QUERIES)
def test_pyshacl_keeps_the_same_forms(put, monkeypatch, query, core):
    monkeypatch.setattr(rdflib, "NORMALIZE_LITERALS", False)
    shapes = COUNTED % (query.replace("xsd:integer", "<http://www.w3.org/2001/XMLSchema#integer>"), core)
    _, report, _ = pyshacl.validate(as_rdflib(VALUES), shacl_graph=as_rdflib(shapes), advanced=False)
    asked = f"SELECT ?v ?c {{ ?r <{SH}sourceConstraintComponent> ?c OPTIONAL {{ ?r <{SH}value> ?v }} }}"
    theirs = sorted((str(value), str(component)) for value, component in report.query(asked))
    found = [p.result for p in problems(put("d.ttl", VALUES), put("s.ttl", shapes))]
    ours = sorted((str((r["value"] or {}).get("value")), r["sourceConstraintComponent"]) for r in found)
    assert ours == theirs != []


def test_a_trace_query_sees_what_the_file_says():
    answer = open_trace(CASES / "lexical_forms/data.ttl").query(
        "SELECT ?s { ?x <http://example.org/l#v> ?v BIND(STR(?v) AS ?s) FILTER(isNumeric(?v) && ?v = 7) }"
    )
    assert answer.records() == [{"s": "007"}]


def test_a_value_that_is_none_of_its_datatype_is_no_traceback(put):
    trace = open_trace(put("t.ttl", 'ex:a ex:v "abc"^^xsd:integer , "1"^^xsd:boolean , 007 .'))
    found = {row["v"] for row in trace.query("SELECT ?v { ?s <http://example.org/v> ?v }").records()}
    assert found == {"abc", True, 7}


# Terms


CONSTRAINTS = [
    "sh:class ex:T", "sh:datatype xsd:integer", "sh:nodeKind sh:IRI", "sh:minInclusive 1", "sh:maxExclusive 1",
    "sh:minLength 99", "sh:maxLength 1", 'sh:pattern "^x"', 'sh:languageIn ( "en" )', "sh:in ( 1 ex:x )",
    "sh:hasValue 1", "sh:not [ sh:nodeKind sh:Literal ]", "sh:node [ sh:class ex:T ]", "sh:equals ex:q",
    "sh:and ( [ sh:class ex:T ] )", "sh:property [ sh:path ex:p ; sh:minCount 1 ]", "sh:maxCount 0", "sh:lessThan ex:q",
    'sh:sparql [ sh:select "SELECT $this ?value { $this ?p ?value }" ]',
    "sh:in ( <<( ex:a ex:b ex:d )>> )", "sh:hasValue <<( ex:a ex:b 01 )>>", "sh:disjoint rdf:reifies",
]  # fmt: skip


@pytest.mark.parametrize("constraint", CONSTRAINTS)
def test_a_triple_term_is_validated_and_shown(put, constraint):
    data = put("data.ttl", 'ex:r rdf:reifies <<( ex:a ex:b "x"@en )>> ; ex:q 1 .')
    shapes = put(
        "shapes.ttl", f"ex:S a sh:NodeShape ; sh:targetNode ex:r ; sh:property [ sh:path rdf:reifies ; {constraint} ] ."
    )
    found = problems(data, shapes)
    if constraint.startswith("sh:not"):
        assert found == ()
        return
    assert {p.code for p in found} == {"SHP001"}
    assert {p.severity for p in found} == {"error"}
    if not constraint.startswith(("sh:maxCount", "sh:hasValue")):
        assert any('<<( ex:a ex:b "x"@en )>>' in p.message for p in found), found
        assert any((p.line, p.column) == (7, 18) for p in found)


@pytest.mark.parametrize("constraint", CONSTRAINTS)
def test_a_triple_term_may_be_a_focus_node(put, constraint):
    data = put("data.ttl", "ex:r rdf:reifies <<( ex:a ex:b 007 )>> , <<( ex:a ex:b _:x )>> . _:x ex:p ex:r .")
    constraint = "sh:nodeKind sh:IRI" if "Count" in constraint or "lessThan" in constraint else constraint
    shapes = put("shapes.ttl", f"ex:S a sh:NodeShape ; sh:targetObjectsOf rdf:reifies ; {constraint} .")
    assert not any("internal" in p.message or p.code != "SHP001" for p in problems(data, shapes))


@pytest.mark.parametrize("shape", ["k2", "k3"])
def test_the_reported_shapes_run_on_triple_terms(shape):
    (problem,) = problems(CASES / "triple_terms/ttl_1_2.ttl", CASES / f"triple_terms/{shape}.ttl")
    assert "<<( s:a s:b s:c )>>" in problem.message
    assert (problem.line, problem.column) == (3, 25)


@pytest.mark.parametrize(
    "text",
    ["<< ex:a ex:b ex:c >> ex:p ex:v .", "ex:a ex:b ex:c {| ex:p ex:v |} .", "ex:a ex:b ex:c ~ ex:w {| ex:p ex:v |} ."],
)
def test_annotations_have_places(put, text):
    data = put("data.ttl", text + "\nex:z ex:p ex:y .\n")
    shapes = put(
        "shapes.ttl", "ex:S a sh:NodeShape ; sh:targetSubjectsOf ex:p ; sh:property [ sh:path ex:p ; sh:in ( 1 ) ] ."
    )
    assert sorted(p.line for p in problems(data, shapes)) == [7, 8]


def test_no_command_stumbles_over_a_triple_term(put, capsys):
    shape = "ex:S a sh:NodeShape ; sh:targetObjectsOf rdf:reifies ; sh:class ex:T ."
    texts = (f"ex:r a ex:C ; rdf:reifies <<( ex:a ex:b {value} )>> . {shape}" for value in ("007", "ex:c"))
    first, second = map(put, ("first.ttl", "second.ttl"), texts)
    run(first, "--json")
    found = [p for p in json.loads(capsys.readouterr().out)["problems"] if p["code"] == "SHP001"]
    assert [(p["line"], p["column"]) for p in found] == [(7, 27)]
    assert "<<( ex:a ex:b 007 )>>" in found[0]["message"]
    assert run(first, second, command=DIFF) in {CLEAN, FINDINGS}
    assert "<<( " in capsys.readouterr().out
    rows = open_trace(first).query("SELECT ?t { ?r rdf:reifies ?t }").records()
    (term,) = (row["t"] for row in rows)
    assert term.startswith("<<( <http://example.org/a> <http://example.org/b> ")
    assert '"007"^^' in term


def test_the_words_of_turtle_1_2_have_places(put):
    data = put("data.ttl", 'VERSION "1.2"\n@version "1.2" .\nex:a ex:p "x"@en--ltr , "x"@en .\n')
    shapes = put(
        "shapes.ttl", "ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:property [ sh:path ex:p ; sh:maxLength 0 ] ."
    )
    found = [(p.line, p.column, p.message.partition("value ")[2].partition(" of")[0]) for p in problems(data, shapes)]
    assert found == [(9, 11, '`"x"@en--ltr`'), (9, 25, '`"x"@en`')]


def test_values_that_look_alike_are_told_apart():
    found = [p.message for p in problems(CASES / "lexical_forms/data.ttl", CASES / "messages/in.ttl")]
    assert '`l:a` violates the shape `l:S`: `l:v` must have the value `"x"@en`' in found
    assert '`l:a` violates the shape `l:S`: the value `007` of `l:v` must be one of `"a"@en`, `"1"`' in found
    assert "`l:a` violates the shape `l:S`: the value `007` of `l:v` must be an instance of `m:T`" in found


def test_a_shape_without_a_name_is_called_what_it_is(put):
    data = put("data.ttl", "ex:a ex:p 1 .")
    shapes = put(
        "shapes.ttl",
        """ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:node [ sh:nodeKind sh:Literal ] ;
    sh:not [ sh:path ex:p ; sh:minCount 1 ] ; sh:node ex:N .
ex:N a sh:NodeShape ; sh:nodeKind sh:Literal .
[] a sh:PropertyShape ; sh:path ( ex:p ex:q ) ; sh:targetNode ex:a ; sh:minCount 1 .
""",
    )
    assert sorted(p.message for p in problems(data, shapes)) == [
        "`ex:a` violates the property shape of `(ex:p/ex:q)` at 10:1: `(ex:p/ex:q)` must have at least 1 value",
        "`ex:a` violates the shape `ex:S`: must conform to the node shape at 7:52",
        "`ex:a` violates the shape `ex:S`: must conform to the shape `ex:N`",
        "`ex:a` violates the shape `ex:S`: must not conform to the property shape of `ex:p` at 8:12",
    ]


def test_an_iri_reference_may_hold_what_is_escaped_in_it():
    found = [
        p.message for p in problems(CASES / "messages/datatypes_data.ttl", CASES / "messages/datatypes_shapes.ttl")
    ]
    assert not any("anyURI" in message for message in found)
    assert len(found) == 55
    assert sum("gYear" in message for message in found) == 1


# Queries


@pytest.mark.parametrize(
    ("name", "place", "message"),
    [
        ("pfx.rq", (1, 22), "not SPARQL: the prefix `foo:` is not declared"),
        ("syn.rq", (2, 7), "not SPARQL: the `{` is not closed: the query ends before it is complete"),
    ],
)
def test_a_fault_stands_in_the_persons_query(name, place, message):
    trace = open_trace(CASES / "queries/d3.ttl")
    with pytest.raises(OntoError) as raised:
        trace.query((CASES / "queries" / name).read_text(), file=name)
    (problem,) = raised.value.problems
    assert (problem.code, problem.line, problem.column, problem.message) == ("TRC004", *place, message)


def test_a_byte_order_mark_is_no_fault():
    trace = open_trace(CASES / "queries/d3.ttl")
    assert len(trace.query((CASES / "queries/bom.rq").read_bytes().decode()).rows) == 2
    assert ask(trace.store, "\ufeff# a question\nASK { ?s ?p ?o }").question == "a question"


def test_a_fault_in_a_constraint_stands_in_the_turtle_file():
    (problem,) = problems(CASES / "queries/d3.ttl", CASES / "queries/s3.ttl")
    assert (problem.code, problem.line, problem.column) == ("SHP002", 9, 47)
    assert problem.message == "the query cannot run: the prefix `f:` is not declared"
    assert 'sh:prefix "f" ; sh:namespace "http://example.org/f#"' in problem.hint


def test_without_places_the_line_of_the_query_is_told(put):
    shape = {
        "@id": "http://example.org/S",
        "@type": SH + "NodeShape",
        SH + "targetNode": {"@id": "http://example.org/a"},
        SH + "sparql": {SH + "select": "SELECT $this\nWHERE { $this ex:p 1 }"},
    }
    (problem,) = problems(put("data.ttl", "ex:a ex:p 1 ."), put("shapes.jsonld", json.dumps(shape)))
    assert (problem.code, problem.line) == ("SHP002", 0)
    assert problem.file.endswith("shapes.jsonld")
    assert problem.message.endswith("the prefix `ex:` is not declared (line 2, column 15 of the query)")


QUERY = '''"""
    SELECT $this
    WHERE { $this %s ?v . FILTR(?v > 1) }
"""'''
VALIDATOR = """sh:targetNode ex:a ; ex:most 1 .
ex:C a sh:ConstraintComponent ; sh:parameter [ sh:path ex:most ] ; sh:nodeValidator [ sh:select {} ]"""
HOLDERS = [
    "sh:targetNode ex:a ; sh:sparql [ sh:select {} ]",
    "sh:targetNode ex:a ; sh:property [ sh:path ex:v ; sh:sparql [ sh:select {} ] ]",
    "sh:target [ a sh:SPARQLTarget ; sh:select {} ]",
    "sh:targetNode ex:a . ex:f a sh:SPARQLFunction ; sh:select {}",
    VALIDATOR,
]


@pytest.mark.parametrize("shape", HOLDERS)
@pytest.mark.parametrize("path", ["ex:v", "$PATH", "$PATH/ex:v"])
def test_every_query_of_a_shape_is_placed(put, shape, path):
    if "PATH" in path and "sh:path ex:v" not in shape:
        path = "ex:v"
    declared = "ex: sh:declare [ sh:prefix \"ex\" ; sh:namespace 'http://example.org/'^^xsd:anyURI ] .\n"
    text = shape.replace("sh:select {}", f"sh:prefixes ex: ; sh:select {QUERY % path}")
    (problem,) = problems(
        put("data.ttl", "ex:a ex:v 1 ."), put("shapes.ttl", f"{declared}ex:S a sh:NodeShape ; {text} .")
    )
    assert (problem.code, problem.line) == ("SHP002", 11 if shape == VALIDATOR else 10)
    assert problem.column == QUERY.splitlines()[2].replace("%s", path).index("FILTR") + 1
    assert problem.message.endswith("cannot run: `FILTR` cannot stand here")
    assert problem.hint == "did you mean `FILTER`?; see `onto explain SHP002`"


def test_what_may_not_stand_beside_given_variables_is_placed(put):
    query = '"""SELECT $this\nWHERE { $this ?p 1 MINUS { ?s ?p 2 } }"""'
    shapes = put("shapes.ttl", f"ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:sparql [ sh:select {query} ] .")
    (problem,) = problems(put("data.ttl", "ex:a ex:v 1 ."), shapes)
    assert (problem.code, problem.line, problem.column) == ("SHP002", 8, 20)


# Results as data


SHAPES = """ex:Blocker a sh:Severity ; rdfs:subClassOf ex:Grave . ex:Grave rdfs:subClassOf sh:Violation .
ex:Remark a sh:Severity ; rdfs:subClassOf sh:Info . ex:Odd a sh:Severity .
ex:S a sh:NodeShape ; rdfs:label "a thing"@en ; sh:targetClass ex:T ;
    sh:property [ sh:path ex:p ; sh:minCount 1 ; sh:severity sh:Info ; sh:message "no p"@en , "kein p"@de ] ,
        [ sh:path [ sh:inversePath ex:q ] ; sh:minCount 1 ; sh:severity ex:Blocker ] ,
        [ sh:path ex:r ; sh:maxCount 0 ; sh:severity ex:Remark ] ,
        [ sh:path ex:s ; sh:maxCount 0 ; sh:severity ex:Odd ] ,
        [ sh:path ex:t ; sh:in ( 1 ) ; sh:severity sh:Warning ] ;
    sh:sparql ex:Rule .
ex:Rule sh:message "{$this} has {?value}"@en ;
    sh:select "SELECT $this ?value ?day { $this <http://example.org/u> ?value BIND('Monday' AS ?day) }" ;
    sh:resultAnnotation [ sh:annotationProperty ex:day ] , [ sh:annotationProperty ex:by ; sh:annotationValue ex:me ] .
"""
DATA = "ex:a a ex:T ; ex:r 1 ; ex:s 1 ; ex:t 01 ; ex:u 1.50 ."


def test_json_has_the_whole_result(put, capsys):
    assert run(put("data.ttl", DATA), "--shapes", put("shapes.ttl", SHAPES), "--json") == FINDINGS
    found = {p["result"]["shape"]["name"]: p for p in json.loads(capsys.readouterr().out)["problems"]}
    assert {name: p["severity"] for name, p in found.items()} == {
        "ex:S/ex:p": "info",
        "ex:S/(^ex:q)": "error",
        "ex:S/ex:r": "info",
        "ex:S/ex:s": "error",
        "ex:S/ex:t": "warning",
        "ex:S": "error",
    }
    assert found["ex:S/ex:p"]["result"]["resultMessage"] == {"en": ["no p"], "de": ["kein p"]}
    assert found["ex:S/(^ex:q)"]["result"]["resultPath"] == {"type": "path", "value": "(^<http://example.org/q>)"}
    assert found["ex:S/(^ex:q)"]["result"]["resultSeverity"] == "http://example.org/Blocker"
    assert found["ex:S/ex:t"]["result"]["value"] == {
        "type": "literal",
        "value": "01",
        "datatype": "http://www.w3.org/2001/XMLSchema#integer",
    }
    sparql = found["ex:S"]["result"]
    assert sparql["focusNode"] == {"type": "uri", "value": "http://example.org/a"}
    assert sparql["sourceShape"] == {"type": "uri", "value": "http://example.org/S"}
    assert sparql["sourceConstraintComponent"] == SH + "SPARQLConstraintComponent"
    assert sparql["resultMessage"] == {"en": ["http://example.org/a has 1.50"]}
    assert sparql["shape"]["label"] == "a thing"
    assert {name: [v["value"] for v in values] for name, values in sparql["resultAnnotation"].items()} == {
        "http://example.org/day": ["Monday"],
        "http://example.org/by": ["http://example.org/me"],
    }


@pytest.mark.parametrize("ending", [".ttl", ".jsonld"])
def test_the_report_is_the_w3c_s(put, tmp_path, monkeypatch, ending):
    monkeypatch.setattr(rdflib, "NORMALIZE_LITERALS", False)
    report = tmp_path / f"report{ending}"
    assert run(put("data.ttl", DATA), "--shapes", put("shapes.ttl", SHAPES), "--report", report) == FINDINGS
    ours = as_rdflib(report.read_text(), RdfFormat.TURTLE if ending == ".ttl" else RdfFormat.JSON_LD)
    _, theirs, _ = pyshacl.validate(as_rdflib(DATA), shacl_graph=as_rdflib(SHAPES), advanced=False)
    ask_for = f"""SELECT ?focus ?value ?component ?severity {{ ?r a <{SH}ValidationResult> ; <{SH}focusNode> ?focus ;
        <{SH}sourceConstraintComponent> ?component ; <{SH}resultSeverity> ?severity ; <{SH}sourceShape> ?shape ;
        <{SH}resultMessage> ?any . OPTIONAL {{ ?r <{SH}value> ?value }} }}"""
    rows = [{tuple(map(str, row)) for row in graph.query(ask_for)} for graph in (ours, theirs)]
    assert rows[0] == rows[1] != set()
    assert ours.query(f"ASK {{ ?r a <{SH}ValidationReport> ; <{SH}conforms> false }}").askAnswer
    assert ours.query(
        "ASK { ?r <http://example.org/day> 'Monday' ; <http://example.org/by> <http://example.org/me> }"
    ).askAnswer
    assert ours.query(f"ASK {{ ?r <{SH}resultPath>/<{SH}inversePath> <http://example.org/q> }}").askAnswer
    assert ours.query(f"ASK {{ ?r <{SH}sourceConstraint> <http://example.org/Rule> }}").askAnswer


def test_both_forms_of_a_report_say_the_same(put, tmp_path):
    data, shapes = put("data.ttl", DATA), put("shapes.ttl", SHAPES)
    reports = [tmp_path / "r.ttl", tmp_path / "r.jsonld"]
    for report in reports:
        run(data, "--shapes", shapes, "--report", report)
    first, second = (RdflibGraph().parse(report) for report in reports)
    assert isomorphic(first, second)


def test_a_clean_report_conforms_and_keeps_triple_terms_in_json_ld(put, tmp_path):
    shapes = put("shapes.ttl", "ex:S a sh:NodeShape ; sh:targetObjectsOf rdf:reifies ; sh:nodeKind sh:IRI .")
    report = tmp_path / "deep/er/r.jsonld"
    assert run(put("data.ttl", "ex:a ex:p 1 ."), "--shapes", shapes, "--report", report) == CLEAN
    assert json.loads(report.read_text())[0][SH + "conforms"][0]["@value"] == "true"
    data = put("more.ttl", "ex:r rdf:reifies <<( ex:a ex:b <<( ex:a ex:b 1 )>> )>> .")
    assert run(data, "--shapes", shapes, "--report", report) == FINDINGS
    triples = list(parse(report.read_bytes(), format=RdfFormat.JSON_LD))
    statement = NamedNode("http://www.w3.org/1999/02/22-rdf-syntax-ns#Statement")
    assert sum(triple.object == statement for triple in triples) == 2
    assert all(isinstance(triple.object, (BlankNode, NamedNode, Literal)) for triple in triples)


def test_where_a_shape_cannot_run_nothing_conforms(put, tmp_path):
    shape = "ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:property [ sh:path ex:p ; sh:minCount ex:x ] ."
    shapes = put("shapes.ttl", shape)
    report = tmp_path / "r.ttl"
    assert run(put("data.ttl", "ex:a ex:p 1 ."), "--shapes", shapes, "--report", report) == FINDINGS
    assert "sh:conforms false" in report.read_text()


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["{data}", "--report", "r.ttl"], "CLI002"),
        (["{data}", "--shapes", "{shapes}", "--report", "r.docx"], "CLI002"),
    ],
)
@pytest.mark.parametrize("form", ["text", "json", "sarif"])
def test_a_report_that_cannot_be_written_is_said(put, capsys, words, code, form):
    names = {"data": put("data.ttl", DATA), "shapes": put("shapes.ttl", SHAPES)}
    given = [word.format(**names) for word in words]
    if form == "text":
        with pytest.raises(OntoError, match=code):
            run(*given)
    else:
        assert run(*given, "--format", form) == MISUSE
        assert code in capsys.readouterr().out


@pytest.mark.parametrize("form", ["text", "json", "sarif"])
def test_what_was_found_is_printed_though_the_report_cannot_be_written(put, capsys, form):
    data, shapes = put("data.ttl", DATA), put("shapes.ttl", SHAPES)
    assert run(data, "--shapes", shapes, "--report", data / "r.ttl", "--format", form) == MISUSE
    printed = capsys.readouterr().out
    assert "CLI009" in printed
    assert "SHP001" in printed


@pytest.mark.parametrize("form", ["json", "sarif"])
@pytest.mark.parametrize("words", [["gone.ttl"], ["{data}", "--shapes", "gone.ttl"], []])
def test_a_format_is_printed_in_every_case(put, capsys, form, words):
    given = [word.format(data=put("data.ttl", DATA)) for word in words] or ["--shapes", put("shapes.ttl", SHAPES)]
    assert run(*given, "--format", form) == MISUSE
    printed = json.loads(capsys.readouterr().out)
    if form == "json":
        (problem,) = printed["problems"]
        assert problem["code"] == ("TTL002" if words else "CLI002")
    else:
        assert len(printed["runs"][0]["results"]) == 1


def test_sarif_has_a_rule_for_each_source_shape(put, capsys):
    assert run(put("data.ttl", DATA), "--shapes", put("shapes.ttl", SHAPES), "--format", "sarif") == FINDINGS
    log = json.loads(capsys.readouterr().out)
    SarifSchema.model_validate(log)
    driver = log["runs"][0]["tool"]["driver"]
    assert driver["version"]
    assert driver["informationUri"].startswith("https://")
    levels = {rule["id"]: rule["defaultConfiguration"]["level"] for rule in driver["rules"]}
    assert levels == {
        "SHP001/ex:S": "error",
        "SHP001/ex:S/(^ex:q)": "error",
        "SHP001/ex:S/ex:p": "note",
        "SHP001/ex:S/ex:r": "note",
        "SHP001/ex:S/ex:s": "error",
        "SHP001/ex:S/ex:t": "warning",
    }
    result = next(one for one in log["runs"][0]["results"] if one["ruleId"] == "SHP001/ex:S")
    assert result["properties"]["value"]["value"] == "1.50"


def test_sarif_has_the_repairs(put, capsys):
    path = put("mine.ttl", "@prefix unused: <http://example.org/unused#> .\r\nex:a ex:b ex:c .\r\n")
    run(path, "--format", "sarif")
    log = json.loads(capsys.readouterr().out)
    SarifSchema.model_validate(log)
    fixes = [fix for result in log["runs"][0]["results"] for fix in result.get("fixes", ())]
    (change,) = [c for fix in fixes for c in fix["artifactChanges"] if "unused" in fix["description"]["text"]][-1:]
    (replacement,) = change["replacements"]
    assert replacement["insertedContent"] == {"text": ""}
    assert replacement["deletedRegion"]["startColumn"] == 1


@pytest.mark.parametrize(("severity", "code"), [("sh:Violation", 1), ("sh:Warning", 0), ("sh:Info", 0), ("ex:Own", 1)])
def test_the_exit_code_follows_the_severity(put, severity, code):
    shapes = put(
        "shapes.ttl", f"ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:nodeKind sh:Literal ; sh:severity {severity} ."
    )
    assert run(put("data.ttl", "ex:a ex:p 1 ."), "--shapes", shapes) == code
