"""The outline of a Turtle text holds what its source map holds, and queries, and what a broken text still says."""

from pathlib import Path

import pytest
from pyoxigraph import NamedNode, RdfFormat, parse

import ontology
from onto_compiler.lsp.outline import outline, query_outline
from onto_compiler.rdf import OWL, RDF, SH
from onto_compiler.turtle.source_map import map_text

ROOT = Path(__file__).resolve().parents[3]
FILES = sorted({*ontology.ROOT.rglob("*.ttl"), *(ROOT / "tests").rglob("*.ttl"), *(ROOT / "docs").rglob("*.ttl")})


def readable(path):
    try:
        list(parse(path.read_bytes(), format=RdfFormat.TURTLE, base_iri=path.as_uri()))
    except (SyntaxError, ValueError):
        return False
    return path.stat().st_size < 100_000


READABLE = [path for path in FILES if readable(path)]


def test_the_corpus_is_there():
    assert len(READABLE) > 100


@pytest.mark.parametrize("path", READABLE, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_every_term_of_the_source_map_is_a_name_of_the_outline(path):
    text = path.read_bytes().decode("utf-8-sig")
    located = map_text(text, str(path), path.as_uri()).triples
    written = {}
    for triple in located:
        for part, token in (
            (triple.subject, triple.at_subject),
            (triple.predicate, triple.at_predicate),
            (triple.object, triple.at_object),
        ):
            if isinstance(part, NamedNode) and (token.kind in {"name", "iri"} or token.text == "a"):
                written[token.start] = part.value
    names = {name.start: name.iri for name in outline(text, path.as_uri()).names}
    assert written.items() <= names.items()
    subjects = {t.at_subject.start for t in located if t.at_subject.kind in {"name", "iri"}}
    assert {block.subject.start for block in outline(text, path.as_uri()).blocks} == subjects
    types = {
        (t.at_subject.start, t.object.value)
        for t in located
        if t.predicate.value == RDF + "type"
        and t.at_subject.kind in {"name", "iri"}
        and isinstance(t.object, NamedNode)
    }
    found = {(block.subject.start, one) for block in outline(text, path.as_uri()).blocks for one in block.types}
    assert found == types


HEAD = f"@prefix ex: <http://e/> .\n@prefix sh: <{SH}> .\n@prefix owl: <{OWL}> .\n"


def names(text):
    return [(name.iri, name.role) for name in outline(HEAD + text, "http://base/").names if name.start >= len(HEAD)]


def test_roles_are_those_of_the_places():
    assert names('ex:s a ex:C ; ex:p ex:o , "1"^^ex:d , ( ex:l [ ex:q 2 ] ) .') == [
        ("http://e/s", "subject"),
        (RDF + "type", "predicate"),
        ("http://e/C", "class"),
        ("http://e/p", "predicate"),
        ("http://e/o", "object"),
        ("http://e/d", "class"),
        ("http://e/l", "object"),
        ("http://e/q", "predicate"),
    ]


def test_triple_terms_and_annotations_do_not_disturb_what_follows():
    text = "ex:s ex:p <<( ex:a ex:b ex:c )>> ~ ex:r {| ex:q ex:o |} ; ex:p2 ex:o2 .\nex:t a ex:C ."
    found = outline(HEAD + text, "http://base/")
    assert [(block.written, block.types) for block in found.blocks] == [("ex:s", []), ("ex:t", ["http://e/C"])]
    assert ("http://e/p2", "predicate") in names(text)
    assert ("http://e/q", "predicate") in names(text)


@pytest.mark.parametrize(
    "broken", ["ex:s ex:p [ ex:q 1", "ex:s ex:p ex:o", 'ex:s ex:p "open', "ex:s ex:p ex:o ;;; ]] )"]
)
def test_a_broken_statement_takes_no_other_block_with_it(broken):
    found = outline(f"{HEAD}{broken}\n\nex:t a ex:C .\n@prefix f: <http://f/> .\nf:x a ex:D .", "http://base/")
    assert [block.written for block in found.blocks][-2:] == ["ex:t", "f:x"]


def test_names_of_a_query_are_resolved_as_shacl_resolves_them():
    text = (
        'ex:Shape sh:prefixes ex:own ; sh:select """PREFIX q: <http://q/>\n SELECT $this WHERE '
        '{ $this q:a ex:b , d:c , <http://e/x> . FILTER (?x != "ex:no") # ex:nor\n }""" .\n'
        'ex:own sh:declare [ sh:prefix "d" ; sh:namespace "http://d/" ] .'
    )
    asked = [iri for iri, role in names(text) if role == "query"]
    assert asked == ["http://q/a", "http://e/b", "http://d/c", "http://e/x"]


def test_escapes_in_a_query_do_not_move_its_names():
    text = HEAD + 'ex:S sh:ask "ASK {\\n\\t?x ex:p \\"1\\" ; ex:q 2 }" .'
    found = [name for name in outline(text, "http://base/").names if name.role == "query"]
    assert [text[name.start : name.end] for name in found] == ["ex:p", "ex:q"]


def test_a_query_of_its_own_has_the_usual_prefixes():
    found = query_outline("PREFIX e: <http://e/>\nSELECT * { ?s a owl:Class ; e:p ?o }")
    assert [name.iri for name in found.names] == [OWL + "Class", "http://e/p"]
