"""What holds of every output: the same bytes each time, for any ontology; and what the two smaller ones hold."""

import argparse
import hashlib
import json
import os
import re
import subprocess
import sys
from itertools import product
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator
from pyoxigraph import RdfFormat, Store
from rdflib import Graph

from onto_compiler.emit import OUTPUTS, emit
from onto_compiler.emit.command import SCHEMA as COMMAND
from onto_compiler.emit.tbox import read_tbox
from onto_compiler.knowledge import load_knowledge
from onto_compiler.rdf import MAN
from onto_compiler.shapes import compile_shapes, validate
from onto_compiler.sources import load_store
from onto_compiler.tables import STATUSES

ROOT = Path(__file__).resolve().parents[3]
HASH = """
import hashlib, sys
from onto_compiler.emit import OUTPUTS, emit
from onto_compiler.emit.tbox import read_tbox
tbox = read_tbox(sys.argv[1:])
for output in OUTPUTS:
    print(output, hashlib.sha256(emit(output, tbox).encode()).hexdigest())
"""
AXIOMS = """
@prefix core: <https://w3id.org/onto-evwm/core#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix ex: <https://example.org/e#> .
ex:p a owl:ObjectProperty ; rdfs:domain [ owl:unionOf ( ex:A ex:B ) ] .
ex:A a owl:Class ; rdfs:subClassOf core:Entity ,
    [ a owl:Restriction ; owl:onProperty ex:p ; owl:allValuesFrom [ owl:oneOf ( ex:b ex:a ) ] ] ,
    [ a owl:Restriction ; owl:onProperty ex:p ; owl:maxCardinality 3 ] ,
    [ a owl:Restriction ; owl:onProperty ex:p ; owl:someValuesFrom ex:B ] .
ex:B a owl:Class ; owl:equivalentClass [ owl:intersectionOf ( [ owl:complementOf ex:C ] core:Entity ) ] .
ex:C a owl:Class .
[] a owl:AllDisjointClasses ; owl:members ( ex:B ex:A ex:C ) .
"""


def hashes(seed, *paths):
    environment = {**os.environ, "PYTHONHASHSEED": str(seed)}
    command = [sys.executable, "-c", HASH, *map(str, paths)]
    run = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True, check=True)
    return dict(line.split() for line in run.stdout.splitlines())


def test_processes_with_different_hash_seeds_write_the_same_bytes(tmp_path):
    (tmp_path / "own.ttl").write_text(AXIOMS)
    one, other = hashes(1, tmp_path), hashes(2, tmp_path)
    assert set(one) == set(OUTPUTS)
    assert one == other
    tbox = read_tbox([tmp_path])
    assert one == {output: hashlib.sha256(emit(output, tbox).encode()).hexdigest() for output in OUTPUTS}


def test_the_order_of_blank_nodes_in_the_file_does_not_show(tmp_path):
    head, _, body = AXIOMS.partition("ex:p a")
    blocks = [part.strip() for part in re.split(r"(?<= \.)\n", f"ex:p a{body}") if part.strip()]
    assert len(blocks) == 5
    (tmp_path / "a.ttl").write_text(AXIOMS)
    (tmp_path / "b.ttl").write_text(head + "\n".join(reversed(blocks)))
    for output in OUTPUTS:
        assert emit(output, read_tbox([tmp_path / "a.ttl"])) == emit(output, read_tbox([tmp_path / "b.ttl"]))


# The records of a trace are those of the program, whatever a task's ontology says.
@pytest.mark.parametrize("output", [output for output in OUTPUTS if output != "record_shapes"])
def test_every_output_grows_with_a_persons_own_ontology(output):
    own = emit(output, read_tbox([ROOT / "docs/examples/served.ttl"]))
    assert re.search(r"\b[Ss]erved", own)
    assert not re.search(r"\b[Ss]erved", emit(output, read_tbox()))


def test_an_ontology_full_of_slips_still_gives_well_formed_outputs():
    texts = {output: emit(output, read_tbox([Path(__file__).parent / "odd.ttl"])) for output in OUTPUTS}
    assert len(Graph().parse(data=texts["shacl"], format="turtle")) > 1000
    store = Store()
    store.load(texts["shacl"].encode(), format=RdfFormat.TURTLE)
    assert validate(load_store(), compile_shapes(store)) == ()
    assert texts["shacl"].count("# Not expressed: ") == 4
    Draft202012Validator.check_schema(json.loads(texts["jsonschema"]))
    assert all(json.loads(texts[output]) for output in ("jsonld", "dense"))
    compile(texts["python"], "predicates.py", "exec")
    assert texts["mermaid"].count("```") == 4


def test_the_command_offers_every_output():
    parser = argparse.ArgumentParser()
    COMMAND.configure(parser)
    assert next(a for a in parser._actions if a.dest == "emit").choices == OUTPUTS


@pytest.fixture(scope="module")
def layout():
    return json.loads(emit("dense", read_tbox()))


def test_dense_masks_are_the_signatures(layout):
    schema = load_knowledge().schema
    cells = 0
    for record, mask in zip(layout["predicates"], layout["argument_mask"], strict=True):
        signature = schema.predicates[record["iri"]]
        assert record["arity"] == len(signature.parameters) == sum(any(row) for row in mask)
        for (place, row), (column, cls) in product(enumerate(mask), enumerate(layout["classes"])):
            allowed = place < record["arity"] and schema.is_a(cls, signature.parameters[place])
            assert bool(row[column]) == allowed
            cells += 1
    assert cells == len(schema.predicates) * 2 * len(layout["classes"]) > 200


def test_dense_tables_are_the_rules(layout):
    tables = load_knowledge().tables
    names = [record["iri"] for record in layout["predicates"]]
    failures, routes = layout["failures"], [route["iri"] for route in layout["routes"]]
    assert layout["statuses"] == list(STATUSES)
    diagnosed = {
        (names[p], bool(q), STATUSES[s]): failures[code]
        for p, by_polarity in enumerate(layout["diagnosis"])
        for q, row in enumerate(by_polarity)
        for s, code in enumerate(row)
        if code >= 0
    }
    assert diagnosed == {key: entry.failure for key, entry in tables.diagnosis.items()}
    routed = {
        (names[p], failures[f], layout["attempt_statuses"][a], [*routes, None][r], layout["levels"][n]): routes[code]
        for n, by_predicate in enumerate(layout["routing"])
        for p, by_failure in enumerate(by_predicate)
        for f, by_previous in enumerate(by_failure)
        for r, row in enumerate(by_previous)
        for a, code in enumerate(row)
        if code >= 0
    }
    assert routed == {key: entry.route for key, entry in tables.routing.items()}
    assert layout["priority"][failures.index(MAN + "JointState")] == 10


def test_the_diagrams_show_every_predicate_failure_and_route():
    schema = load_knowledge().schema
    text = emit("mermaid", read_tbox())
    assert text.count("```mermaid") == 2
    for signature in schema.predicates.values():
        assert re.search(rf"--> \w+ : {signature.name}\b", text)
    edges = re.findall(r"^    (\w+) --> (\w+)$", text, re.MULTILINE)
    assert len(edges) == sum(len(route.admits) for route in schema.routes.values())
    assert text.count("-. on rejection .->") == sum(route.on_rejection is not None for route in schema.routes.values())
    named = set(re.findall(r"^    (\w+)[\[(]", text, re.MULTILINE)) | set(re.findall(r"class (\w+)\[", text))
    assert {one for edge in edges for one in edge} <= named
