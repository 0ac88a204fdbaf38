"""The generated shapes accept what the loop records, refuse what is mutated, and agree with those written by hand."""

import pytest
from pyoxigraph import Literal, NamedNode, Quad, RdfFormat, Store, serialize
from pyshacl import validate as pyshacl_validate
from rdflib import Graph
from rdflib.namespace import SH

from onto_compiler.check.run import check
from onto_compiler.emit.shacl import emit
from onto_compiler.emit.tbox import read_tbox
from onto_compiler.rdf import BASE, CORE, MAN, RDF, TRACE, XSD
from onto_compiler.shapes import compile_shapes, validate
from onto_compiler.sources import load_store
from runtime.trace.write import episode_quads
from tests.runtime.trace.samples import accepted, all_samples
from tests.strategies import SCHEMA

TYPE = NamedNode(RDF + "type")
PREFIXES = """
@prefix core: <https://w3id.org/onto-evwm/core#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
@prefix ex: <https://example.org/e#> .
"""


def rdflib_graph(quads):
    text = serialize({quad.triple for quad in quads}, format=RdfFormat.N_TRIPLES)
    return Graph().parse(data=text, format="nt")


@pytest.fixture(scope="module")
def emitted():
    return emit(read_tbox())


@pytest.fixture(scope="module")
def shapes(emitted):
    return Graph().parse(data=emitted, format="turtle")


@pytest.fixture(scope="module")
def vocabulary():
    return rdflib_graph(load_store())


@pytest.fixture(scope="module")
def violations(shapes, vocabulary):
    """(focus, local name of the component) of every result of pySHACL about some quads beside the vocabulary."""

    def violations(quads):
        added = [triple for triple in rdflib_graph(quads) if triple not in vocabulary]
        for triple in added:
            vocabulary.add(triple)
        try:
            _, report, _ = pyshacl_validate(vocabulary, shacl_graph=shapes, inplace=True)
        finally:
            for triple in added:
                vocabulary.remove(triple)
        return {
            (str(report.value(r, SH.focusNode)), str(report.value(r, SH.sourceConstraintComponent)).rpartition("#")[2])
            for r in report.objects(None, SH.result)
        }

    return violations


@pytest.fixture(scope="module")
def own_shapes(emitted):
    store = Store()
    store.load(emitted.encode(), format=RdfFormat.TURTLE)
    return compile_shapes(store)


@pytest.fixture(scope="module")
def shapes_by_hand():
    return compile_shapes(load_store())


def results_of(data, shapes):
    """As ``violations``, by the engine of ``onto check``."""
    return {(result.focus.value, result.component) for result in validate(data, shapes)}


def test_the_shapes_are_turtle_that_onto_check_accepts(tmp_path):
    file = tmp_path / "shapes.ttl"
    file.write_text(emit(read_tbox()))
    assert check([file]).problems == ()


def test_every_predicate_property_and_disjoint_class_has_its_shape(shapes):
    tbox = read_tbox()
    with_axioms = set(tbox.declared("ObjectProperty", "DatatypeProperty")) - {TRACE + "place"}  # which is deprecated
    targets = {str(target) for target in shapes.objects(None, SH.targetSubjectsOf)}
    assert len(targets) > 80
    assert targets == with_axioms
    assert {str(one) for one in shapes.objects(None, SH.targetNode)} == set(tbox.schema.predicates)
    assert len(set(shapes.subject_objects(SH["not"]))) == 15 * 14 / 2 + 4 * 3 / 2 + 3 * 2 / 2


def test_what_the_loop_records_conforms(violations):
    quads = [q for number, e in enumerate(all_samples()) for q in episode_quads(e, SCHEMA, f"run{number}")]
    assert len(quads) > 500
    assert violations(quads) == set()


def statement(quads, predicate):
    return next(quad for quad in quads if quad.predicate.value == predicate)


def repeated(predicate, value):
    """The record says the same property twice."""

    def mutate(quads):
        found = statement(quads, predicate)
        return [*quads, Quad(found.subject, found.predicate, value, found.graph_name)]

    return mutate


def replaced(predicate, value):
    """The record says something of another kind."""

    def mutate(quads):
        found = statement(quads, predicate)
        changed = Quad(found.subject, found.predicate, value, found.graph_name)
        return [changed if quad == found else quad for quad in quads]

    return mutate


def removed(predicate):
    def mutate(quads):
        found = statement(quads, predicate)
        return [quad for quad in quads if quad != found]

    return mutate


TEXT, NUMBER, OUTCOME = Literal("so"), Literal("2", datatype=NamedNode(XSD + "integer")), NamedNode(TRACE + "Accepted")
FUNCTIONAL = [
    (CORE + "argument1", NamedNode(BASE + "libero#flat_stove_on")),
    (CORE + "argument2", NamedNode(BASE + "libero#flat_stove_on")),
    (CORE + "predicate", NamedNode(MAN + "inside")),
    (CORE + "polarity", Literal("false", datatype=NamedNode(XSD + "boolean"))),
    (CORE + "margin", Literal("0.5", datatype=NamedNode(XSD + "double"))),
    (CORE + "status", NamedNode(CORE + "Absent")),
    (CORE + "source", NamedNode(CORE + "WorldModel")),
    (TRACE + "outcome", NamedNode(TRACE + "Retained")),
    (TRACE + "stateIndex", Literal("9", datatype=NamedNode(XSD + "integer"))),
    (TRACE + "mode", NamedNode(TRACE + "NoApplication")),
]
RANGES = [
    (CORE + "argument1", OUTCOME),
    (CORE + "predicate", OUTCOME),
    (CORE + "polarity", TEXT),
    (CORE + "margin", TEXT),
    (CORE + "fact", OUTCOME),
    (CORE + "status", OUTCOME),
    (CORE + "source", OUTCOME),
    (CORE + "route", OUTCOME),
    (CORE + "decision", OUTCOME),
    (TRACE + "outcome", NamedNode(CORE + "Satisfied")),
    (TRACE + "stateIndex", TEXT),
    (TRACE + "task", NUMBER),
    (TRACE + "requires", OUTCOME),
    (TRACE + "mode", OUTCOME),
    (TRACE + "selected", OUTCOME),
]
MUTATIONS = (
    [pytest.param(repeated(*case), "MaxCount", id=f"twice {case[0].rpartition('#')[2]}") for case in FUNCTIONAL]
    + [pytest.param(replaced(*case), None, id=f"range of {case[0].rpartition('#')[2]}") for case in RANGES]
    + [pytest.param(removed(CORE + "argument2"), "MinCount", id="one argument of two")]
)


def test_the_corpus_of_mutations_is_whole():
    assert len(MUTATIONS) == 26


@pytest.mark.parametrize(("mutate", "component"), MUTATIONS)
def test_a_mutated_record_is_refused_by_both_kinds_of_shapes(mutate, component, violations, own_shapes, shapes_by_hand):
    quads = mutate(list(episode_quads(accepted(), SCHEMA, "run")))
    found = violations(quads)
    kinds = {name.removesuffix("ConstraintComponent") for _, name in found}
    assert kinds & ({component} if component else {"Class", "Datatype"})
    data = load_store()
    data.extend(quads)
    assert {focus for focus, _ in results_of(data, own_shapes)} == {focus for focus, _ in found}
    assert {focus for focus, _ in results_of(data, shapes_by_hand)} & {focus for focus, _ in found}


def test_an_argument_of_the_wrong_class_is_reported_at_its_fact(violations):
    quads = list(episode_quads(accepted(), SCHEMA, "run"))
    typed = next(q for q in quads if q.predicate == TYPE and q.object.value == MAN + "Object")
    changed = Quad(typed.subject, TYPE, NamedNode(MAN + "Region"), typed.graph_name)
    found = violations([changed if q == typed else q for q in quads])
    assert {name for _, name in found} == {"ClassConstraintComponent"}
    assert all("/fact/" in focus for focus, _ in found)


def test_a_thing_of_two_disjoint_classes_is_refused_once(violations):
    quads = list(episode_quads(accepted(), SCHEMA, "run"))
    typed = next(q for q in quads if q.predicate == TYPE and q.object.value == MAN + "Object")
    both = Quad(typed.subject, TYPE, NamedNode(MAN + "Fixture"), typed.graph_name)
    found = violations([*quads, both])
    assert found == {(typed.subject.value, "NotConstraintComponent")}


def test_a_domain_is_refused_where_it_is_not_met(violations):
    stray = Quad(NamedNode("https://example.org/stray"), NamedNode(CORE + "polarity"), TEXT, NamedNode("urn:g"))
    assert ("https://example.org/stray", "ClassConstraintComponent") in violations([stray])


AXIOMS = {
    "all values": ("[ a owl:Restriction ; owl:onProperty ex:p ; owl:allValuesFrom ex:B ]", "ex:p ex:b", "ex:p ex:c"),
    "some values": ("[ a owl:Restriction ; owl:onProperty ex:p ; owl:someValuesFrom ex:B ]", "ex:p ex:b", "ex:p ex:c"),
    "some thing": ("[ a owl:Restriction ; owl:onProperty ex:p ; owl:someValuesFrom owl:Thing ]", "ex:p ex:c", "ex:n 1"),
    "has value": ("[ a owl:Restriction ; owl:onProperty ex:p ; owl:hasValue ex:b ]", "ex:p ex:b", "ex:p ex:c"),
    "has literal": ("[ a owl:Restriction ; owl:onProperty ex:n ; owl:hasValue 3 ]", "ex:n 3", "ex:n 4"),
    "at least": ("[ a owl:Restriction ; owl:onProperty ex:p ; owl:minCardinality 2 ]", "ex:p ex:b, ex:c", "ex:p ex:b"),
    "at most": ("[ a owl:Restriction ; owl:onProperty ex:p ; owl:maxCardinality 1 ]", "ex:p ex:b", "ex:p ex:b, ex:c"),
    "exactly": ("[ a owl:Restriction ; owl:onProperty ex:p ; owl:cardinality 1 ]", "ex:p ex:b", "ex:p ex:b, ex:c"),
    "qualified": (
        "[ a owl:Restriction ; owl:onProperty ex:p ; owl:onClass ex:B ; owl:maxQualifiedCardinality 0 ]",
        "ex:p ex:c",
        "ex:p ex:b",
    ),
    "inverse": (
        "[ a owl:Restriction ; owl:onProperty [ owl:inverseOf ex:p ] ; owl:maxCardinality 0 ]",
        "ex:p ex:b",
        "ex:n 1 . ex:c ex:p ex:a",
    ),
    "intersection": (
        "[ a owl:Class ; owl:intersectionOf ( ex:B [ a owl:Restriction ; owl:onProperty ex:n ; owl:hasValue 1 ] ) ]",
        "a ex:B ; ex:n 1",
        "a ex:B",
    ),
    "union": ("[ a owl:Class ; owl:unionOf ( ex:B ex:C ) ]", "a ex:C", "ex:n 1"),
    "complement": ("[ a owl:Class ; owl:complementOf ex:B ]", "a ex:C", "a ex:B"),
    "one of": ("[ a owl:Class ; owl:oneOf ( ex:a ex:b ) ]", "ex:n 1", None),
    "facets": (
        """[ a owl:Restriction ; owl:onProperty ex:n ; owl:allValuesFrom [
            a rdfs:Datatype ; owl:onDatatype xsd:integer ;
            owl:withRestrictions ( [ xsd:minInclusive 1 ] [ xsd:maxExclusive 5 ] ) ] ]""",
        "ex:n 4",
        "ex:n 5",
    ),
    "nested": (
        """[ a owl:Restriction ; owl:onProperty ex:p ; owl:allValuesFrom
            [ a owl:Class ; owl:unionOf ( ex:B [ a owl:Class ; owl:oneOf ( ex:d ) ] ) ] ]""",
        "ex:p ex:b, ex:d",
        "ex:p ex:c",
    ),
}
WORLD = "ex:b a ex:B . ex:c a ex:C . ex:d ex:n 0 ."
DECLARED = (
    "ex:A a owl:Class . ex:B a owl:Class . ex:C a owl:Class . ex:p a owl:ObjectProperty . ex:n a owl:DatatypeProperty ."
)


def shapes_of(tmp_path, axioms):
    file = tmp_path / "own.ttl"
    file.write_text(PREFIXES + DECLARED + axioms)
    return emit(read_tbox([file]))


def refused(folder, cases):
    """The good and the bad of ``cases`` that pySHACL refuses, each by its number and ``good`` or ``bad``.

    A case is an axiom, data that meet it and data that do not; each has names of its own, and all are judged at once.
    """
    own = [f"@prefix ex: <https://example.org/{number}#> .\n{DECLARED}" for number in range(len(cases))]
    file = folder / "own.ttl"
    file.write_text(PREFIXES + "\n".join(head + case[0] for head, case in zip(own, cases, strict=True)))
    shapes = Graph().parse(data=emit(read_tbox([file])), format="turtle")
    found = set()
    for at, kind in ((1, "good"), (2, "bad")):
        text = PREFIXES + "\n".join(head + WORLD + case[at] for head, case in zip(own, cases, strict=True))
        _, report, _ = pyshacl_validate(Graph().parse(data=text, format="turtle"), shacl_graph=shapes)
        focuses = [str(report.value(result, SH.focusNode)) for result in report.objects(None, SH.result)]
        found |= {(int(focus.removeprefix("https://example.org/").partition("#")[0]), kind) for focus in focuses}
    return found


def test_the_axioms_are_all_there():
    assert len(AXIOMS) == 16


CLASS_AXIOMS = {
    f"{name}-{relation}": (
        f"ex:A {relation} {axiom} .",
        f"ex:a a ex:A ; {good} .",
        f"ex:a a ex:A ; {bad} ." if bad else "ex:e a ex:A .",
    )
    for relation in ("rdfs:subClassOf", "owl:equivalentClass")
    for name, (axiom, good, bad) in AXIOMS.items()
}
OTHER_AXIOMS = [
    ("ex:p a owl:InverseFunctionalProperty .", "ex:a ex:p ex:b .", "ex:a ex:p ex:b . ex:d ex:p ex:b ."),
    ("ex:p a owl:FunctionalProperty .", "ex:a ex:p ex:b .", "ex:a ex:p ex:b, ex:c ."),
    ("ex:A owl:disjointWith ex:B .", "ex:a a ex:A .", "ex:a a ex:A, ex:B ."),
    ("ex:A owl:disjointUnionOf ( ex:B ex:C ) .", "ex:a a ex:A, ex:B .", "ex:a a ex:A ."),
    ("ex:A owl:disjointUnionOf ( ex:B ex:C ) .", "ex:a a ex:A, ex:B .", "ex:a a ex:A, ex:B, ex:C ."),
    ("[] a owl:AllDisjointClasses ; owl:members ( ex:A ex:B ) .", "ex:a a ex:B .", "ex:a a ex:A, ex:B ."),
    ("ex:p rdfs:domain [ a owl:Class ; owl:unionOf ( ex:A ex:B ) ] .", "ex:b ex:p ex:c .", "ex:c ex:p ex:c ."),
    ("ex:n rdfs:range xsd:integer .", "ex:a ex:n 1 .", 'ex:a ex:n "1" .'),
    ("ex:p rdfs:range ex:B .", "ex:a ex:p ex:b .", "ex:a ex:p ex:c ."),
    ("", "ex:a ex:p ex:b .", 'ex:a ex:p "b" .'),
]


@pytest.fixture(scope="module")
def refused_of_classes(tmp_path_factory):
    return refused(tmp_path_factory.mktemp("classes"), list(CLASS_AXIOMS.values()))


@pytest.fixture(scope="module")
def refused_of_others(tmp_path_factory):
    return refused(tmp_path_factory.mktemp("others"), OTHER_AXIOMS)


@pytest.mark.parametrize("number", range(len(CLASS_AXIOMS)), ids=list(CLASS_AXIOMS))
def test_an_axiom_of_a_class_asks_what_owl_says_of_its_members(number, refused_of_classes):
    assert (number, "good") not in refused_of_classes
    assert (number, "bad") in refused_of_classes


@pytest.mark.parametrize("number", range(len(OTHER_AXIOMS)))
def test_an_axiom_of_a_property_or_pair_of_classes_is_kept(number, refused_of_others):
    assert (number, "good") not in refused_of_others
    assert (number, "bad") in refused_of_others


def test_what_shacl_cannot_say_is_named(tmp_path):
    text = shapes_of(tmp_path, "ex:A rdfs:subClassOf [ a owl:Restriction ; owl:onProperty ex:p ; owl:hasSelf true ] .")
    assert "# Not expressed: subClassOf of https://example.org/e#A: owl:hasSelf" in text
    assert Graph().parse(data=text, format="turtle")


def test_a_class_that_holds_itself_ends(tmp_path):
    text = shapes_of(tmp_path, "ex:A owl:equivalentClass _:x . _:x a owl:Class ; owl:complementOf _:x .")
    assert "nested without end" in text


def test_the_text_does_not_depend_on_the_order_of_the_axioms(tmp_path):
    parts = [f"ex:A rdfs:subClassOf {axiom} ." for axiom, _, _ in AXIOMS.values()]
    assert shapes_of(tmp_path, "\n".join(parts)) == shapes_of(tmp_path, "\n".join(reversed(parts)))


def test_a_store_made_of_nothing_gives_a_header_only():
    empty = read_tbox()
    empty = type(empty)(Store(), empty.schema)
    assert emit(empty).count("sh:NodeShape") == len(empty.schema.predicates)
