"""The W3C's Turtle test suite, formatted: rdflib's source archive brings it."""

from pathlib import Path

import pytest
from pyoxigraph import CanonicalizationAlgorithm, Dataset, Quad, RdfFormat, parse

from benchmarks.archives import fetch
from onto_compiler.problems import OntoError
from onto_compiler.turtle.layout import format_turtle, read_turtle

_SHA256 = "6c831288d5e4a5a7ece85d0ccde9877d512a3d0f02d7c06455d00d6d0ea379df"
FOLDER = fetch("rdflib==7.6.0", "rdflib-7.6.0.tar.gz", _SHA256, "rdflib-7.6.0/test/data/suites/w3c/turtle")
CASES = sorted(FOLDER.glob("*.ttl"))


def graph(path: Path, text: str) -> Dataset:
    read = parse(text.encode(), format=RdfFormat.TURTLE, base_iri=path.as_uri())
    found = Dataset(Quad(one.subject, one.predicate, one.object) for one in read)
    found.canonicalize(CanonicalizationAlgorithm.UNSTABLE)
    return found


def refused(path: Path) -> bool:
    try:
        graph(path, path.read_text("utf-8"))
    except SyntaxError:
        return True
    return False


def test_the_suite_is_found_whole():
    assert len(CASES) == 292
    negative = [path for path in CASES if refused(path)]
    assert len(negative) == 82
    assert all("bad" in path.stem for path in negative)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_a_case_keeps_its_graph_or_is_refused_as_the_parser_refuses_it(path):
    text = read_turtle(path)
    if refused(path):
        with pytest.raises(OntoError, match="TTL"):
            format_turtle(text, path)
        return
    once = format_turtle(text, path)
    assert graph(path, once) == graph(path, text)
    assert format_turtle(once, path) == once
