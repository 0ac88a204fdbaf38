"""Every command that takes a query, a shape, a function, a target, a validator, a rule or an import stays at home."""

import io
import shutil
import sys

import pytest

from onto_compiler.command import FINDINGS, MISUSE
from runtime.cli import main
from tests.listening import listening

PREFIXES = """@prefix ex: <http://example.org/> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix core: <https://w3id.org/onto-evwm/core#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
"""
CALL = "SERVICE <URL> { ?s ?p ?o }"
SHAPE = "ex:S a sh:NodeShape ; sh:targetNode ex:a ; "
PLACES = {
    "constraint": f'{SHAPE} sh:sparql [ sh:select "SELECT $this {{ {CALL} }}" ] .',
    "target": f'ex:S a sh:NodeShape ; sh:target [ a sh:SPARQLTarget ; sh:select "SELECT ?this {{ {CALL} }}" ] .',
    "target type": f"""ex:T a sh:SPARQLTargetType ; rdfs:subClassOf sh:Target ; sh:select "SELECT ?this {{ {CALL} }}" .
ex:S a sh:NodeShape ; sh:target [ a ex:T ] .""",
    "function": f"""ex:f a sh:SPARQLFunction ; sh:parameter [ sh:path ex:x ] ; sh:ask "ASK {{ {CALL} }}" .
{SHAPE} sh:expression [ ex:f ( sh:this ) ] .""",
    "unused function": f'ex:f a sh:SPARQLFunction ; sh:select "SELECT ?s {{ {CALL} }}" . {SHAPE} sh:nodeKind sh:IRI .',
    "validator": f"""ex:C a sh:ConstraintComponent ; sh:parameter [ sh:path ex:p ] ;
    sh:validator [ a sh:SPARQLAskValidator ; sh:ask "ASK {{ {CALL} }}" ] . {SHAPE} ex:p 1 .""",
    "unused validator": f"""ex:C a sh:ConstraintComponent ; sh:parameter [ sh:path ex:p ] ;
    sh:propertyValidator [ a sh:SPARQLSelectValidator ; sh:select "SELECT * {{ $this $PATH ?v . {CALL} }}" ] .
{SHAPE} sh:nodeKind sh:IRI .""",
    "rule": f"""{SHAPE}
    sh:rule [ a sh:SPARQLRule ; sh:construct "CONSTRUCT {{ $this a ex:B }} WHERE {{ {CALL} }}" ] .""",
    "prefix": f"""ex: sh:declare [ sh:prefix "x" ; sh:namespace "http://x> SELECT * {{ {CALL} }} #" ] .
{SHAPE} sh:sparql [ sh:prefixes ex: ; sh:select "# nothing" ] .""",
}


@pytest.fixture
def listener():
    """The address of a server on this machine, and the connections that were made to it."""
    with listening() as (address, made):
        yield address, made


@pytest.fixture
def put(tmp_path, monkeypatch, listener):
    monkeypatch.chdir(tmp_path)

    def write(name, text):
        (tmp_path / name).write_text(text.replace("URL", listener[0]), encoding="utf-8")
        return name

    return write


def told(capsys):
    out, err = capsys.readouterr()
    return out + err


def test_the_server_would_notice(listener):
    """Otherwise the tests below would prove nothing."""
    from pyoxigraph import Store

    url, made = listener
    with pytest.raises(OSError, match=r"."):
        list(Store().query(f"SELECT * {{ {CALL.replace('URL', url)} }}"))
    assert made


@pytest.mark.parametrize("place", PLACES)
def test_a_query_in_a_file_is_refused_by_every_command_that_reads_it(place, put, listener, capsys):
    shapes = put("shapes.ttl", f"{PREFIXES}{PLACES[place]}")
    data = put("data.ttl", f"{PREFIXES}ex:a ex:p 1 .")
    for words in (["check", data, "--shapes", shapes], ["check", shapes]):
        assert main(words) == FINDINGS
        text = told(capsys)
        assert "error[QRY001]" in text
        assert "shapes.ttl:" in text
    for words in (["docs", "--out", "site", "--ontology", shapes], ["schema", "--emit", "dense", "--ontology", shapes]):
        if main(words) != 0:
            text = told(capsys)
            assert "error[QRY001]" in text
            assert "shapes.ttl:" in text
    assert listener[1] == []


@pytest.mark.parametrize(
    "query", ["SELECT * { SERVICE <URL> { ?s ?p ?o } }", "LOAD <URL>", "ASK FROM <URL> { ?s ?p ?o }"]
)
def test_a_query_of_a_trace_is_refused(query, put, listener, capsys, monkeypatch):
    trace = put("trace.ttl", f"{PREFIXES}ex:a ex:p 1 .")
    file = put("question.rq", f"# asks\n{query}")
    assert main(["trace", "query", file, trace]) in {FINDINGS, MISUSE}
    text = told(capsys)
    assert "error[QRY00" in text
    assert "question.rq:2:" in text
    monkeypatch.setattr(sys, "stdin", io.StringIO(query.replace("URL", listener[0])))
    assert main(["trace", "query", "-", trace]) in {FINDINGS, MISUSE}
    assert "error[QRY00" in told(capsys)
    assert listener[1] == []


def test_imports_and_contexts_are_not_fetched(put, listener, capsys):
    shapes = put(
        "shapes.ttl", f"{PREFIXES}<> a owl:Ontology ; owl:imports <URLmore.ttl> . {SHAPE} sh:nodeKind sh:IRI ."
    )
    data = put("data.ttl", f"{PREFIXES}<> a owl:Ontology ; owl:imports <URLmore.ttl> . ex:a ex:p 1 .")
    context = put("data.jsonld", '{"@context": "URLcontext.jsonld", "@id": "http://example.org/a", "name": "x"}')
    entity = put(
        "data.rdf",
        '<!DOCTYPE r [<!ENTITY e SYSTEM "URL">]><rdf:RDF xmlns:rdf='
        '"http://www.w3.org/1999/02/22-rdf-syntax-ns#" xmlns:e="http://example.org/">'
        '<rdf:Description rdf:about="http://example.org/a"><e:p>&e;</e:p></rdf:Description></rdf:RDF>',
    )
    main(["check", data, "--shapes", shapes])
    main(["check", shapes])
    capsys.readouterr()
    for file in (context, entity):
        assert main(["check", file, "--shapes", shapes]) == FINDINGS
        assert file in told(capsys)
    shutil.copy(context, "trace.jsonld")
    put("question.rq", "ASK { ?s ?p ?o }")
    assert main(["trace", "query", "question.rq", "trace.jsonld"]) != 0
    assert "trace.jsonld" in told(capsys)
    assert listener[1] == []
