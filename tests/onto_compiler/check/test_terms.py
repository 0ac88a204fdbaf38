"""Names in a standard vocabulary's namespace are terms of that vocabulary."""

import pytest
from rdflib import namespace

from onto_compiler.vocabularies import TERMS, meant

RDFLIB = (
    namespace.DCTERMS,
    namespace.OWL,
    namespace.PROV,
    namespace.RDF,
    namespace.RDFS,
    namespace.SH,
    namespace.SKOS,
    namespace.XSD,
)


@pytest.mark.parametrize("vocabulary", RDFLIB, ids=str)
def test_every_term_that_rdflib_knows_is_one(vocabulary):
    names = {str(term).removeprefix(str(vocabulary)) for term in dir(vocabulary)} - {""}
    assert len(names) >= 15
    assert names <= TERMS[str(vocabulary)]


def test_the_same_vocabularies_are_known():
    assert set(TERMS) == {str(vocabulary) for vocabulary in RDFLIB}


@pytest.mark.parametrize(
    ("iri", "hint"),
    [
        ("http://www.w3.org/2002/07/owl#class", "did you mean `owl:Class`?"),
        ("http://www.w3.org/ns/shacl#maxcount", "did you mean `sh:maxCount`?"),
        ("http://purl.org/dc/terms/licence", "did you mean `dcterms:license`?"),
        ("http://www.w3.org/2002/07/owl#Qwrtz", "look the name up"),
    ],
)
def test_another_name_is_none_and_the_nearest_is_suggested(iri, hint):
    assert meant(iri).startswith(hint)


@pytest.mark.parametrize(
    "iri",
    [
        "http://www.w3.org/1999/02/22-rdf-syntax-ns#_12",
        "http://www.w3.org/2002/07/owl#",
        "http://www.w3.org/2002/07/owl",
        "https://example.org/kitchen#subclassOf",
        "urn:x",
    ],
)
def test_items_headers_and_other_namespaces_are_left_alone(iri):
    assert meant(iri) is None
