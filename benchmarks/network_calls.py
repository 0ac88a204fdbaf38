"""Files that ask for another machine in every place where one can be named, and the commands that read them.

``URL`` stands for the address that is asked.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

__all__ = ["CALL", "IMPORTING", "PLACES", "PREFIXES", "QUERIES", "Call", "calls"]

PREFIXES = """@prefix ex: <http://example.org/> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix core: <https://w3id.org/onto-evwm/core#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
"""
CALL = "SERVICE <URL> { ?s ?p ?o }"
_SHAPE = "ex:S a sh:NodeShape ; sh:targetNode ex:a ; "
_HEADER = "<> a owl:Ontology ; owl:imports <URLmore.ttl> . "
PLACES: Mapping[str, str] = {
    "constraint": f'{_SHAPE} sh:sparql [ sh:select "SELECT $this {{ {CALL} }}" ] .',
    "target": f'ex:S a sh:NodeShape ; sh:target [ a sh:SPARQLTarget ; sh:select "SELECT ?this {{ {CALL} }}" ] .',
    "target type": f"""ex:T a sh:SPARQLTargetType ; rdfs:subClassOf sh:Target ; sh:select "SELECT ?this {{ {CALL} }}" .
ex:S a sh:NodeShape ; sh:target [ a ex:T ] .""",
    "function": f"""ex:f a sh:SPARQLFunction ; sh:parameter [ sh:path ex:x ] ; sh:ask "ASK {{ {CALL} }}" .
{_SHAPE} sh:expression [ ex:f ( sh:this ) ] .""",
    "unused function": f'ex:f a sh:SPARQLFunction ; sh:select "SELECT ?s {{ {CALL} }}" . {_SHAPE} sh:nodeKind sh:IRI .',
    "validator": f"""ex:C a sh:ConstraintComponent ; sh:parameter [ sh:path ex:p ] ;
    sh:validator [ a sh:SPARQLAskValidator ; sh:ask "ASK {{ {CALL} }}" ] . {_SHAPE} ex:p 1 .""",
    "unused validator": f"""ex:C a sh:ConstraintComponent ; sh:parameter [ sh:path ex:p ] ;
    sh:propertyValidator [ a sh:SPARQLSelectValidator ; sh:select "SELECT * {{ $this $PATH ?v . {CALL} }}" ] .
{_SHAPE} sh:nodeKind sh:IRI .""",
    "rule": f"""{_SHAPE}
    sh:rule [ a sh:SPARQLRule ; sh:construct "CONSTRUCT {{ $this a ex:B }} WHERE {{ {CALL} }}" ] .""",
    "prefix": f"""ex: sh:declare [ sh:prefix "x" ; sh:namespace "http://x> SELECT * {{ {CALL} }} #" ] .
{_SHAPE} sh:sparql [ sh:prefixes ex: ; sh:select "# nothing" ] .""",
}
"""Shapes, by the place in which they hold the call."""
QUERIES = (f"SELECT * {{ {CALL} }}", "LOAD <URL>", "ASK FROM <URL> { ?s ?p ?o }", "ASK FROM NAMED <URL> { ?s ?p ?o }")
IMPORTING: Mapping[str, str] = {
    "shapes.ttl": f"{PREFIXES}{_HEADER}{_SHAPE} sh:nodeKind sh:IRI .",
    "data.ttl": f"{PREFIXES}{_HEADER}ex:a ex:p 1 .",
    "data.jsonld": '{"@context": "URLcontext.jsonld", "@id": "http://example.org/a", "name": "x"}',
    "data.rdf": '<!DOCTYPE r [<!ENTITY e SYSTEM "URL">]><rdf:RDF xmlns:rdf='
    '"http://www.w3.org/1999/02/22-rdf-syntax-ns#" xmlns:e="http://example.org/">'
    '<rdf:Description rdf:about="http://example.org/a"><e:p>&e;</e:p></rdf:Description></rdf:RDF>',
    "question.rq": "ASK { ?s ?p ?o }",
}
"""Files that import others, or whose context or entity lies elsewhere."""


@dataclass(frozen=True, slots=True)
class Call:
    """A command in a folder that holds ``files``."""

    files: Mapping[str, str]
    words: Sequence[str]


def calls(url: str) -> Iterator[Call]:
    """Every command that takes a query, a shape, a function, a target, a validator, a rule or an import."""
    for text in PLACES.values():
        files = _addressed({"shapes.ttl": PREFIXES + text, "data.ttl": f"{PREFIXES}ex:a ex:p 1 ."}, url)
        for words in (
            *("check data.ttl --shapes shapes.ttl", "check shapes.ttl", "check data.ttl --shapes shapes.ttl --json"),
            *("docs --out site --ontology shapes.ttl", "schema --emit dense --ontology shapes.ttl"),
            *("fmt --diff shapes.ttl", "check --fix shapes.ttl", "diff data.ttl shapes.ttl"),
        ):
            yield Call(files, words.split())
    for query in QUERIES:
        files = _addressed({"question.rq": f"# asks\n{query}", "trace.ttl": f"{PREFIXES}ex:a ex:p 1 ."}, url)
        yield Call(files, ("trace", "query", "question.rq", "trace.ttl"))
    files = _addressed(IMPORTING, url)
    for words in (
        *(f"check {name} --shapes shapes.ttl" for name in ("data.ttl", "data.jsonld", "data.rdf")),
        *("check shapes.ttl", "check data.ttl", "docs --out site --ontology shapes.ttl"),
        *(f"trace query question.rq {name}" for name in ("data.ttl", "data.jsonld", "data.rdf")),
    ):
        yield Call(files, words.split())


def _addressed(files: Mapping[str, str], url: str) -> dict[str, str]:
    return {name: text.replace("URL", url) for name, text in files.items()}
