"""Each kind of change is found, named, and said to break its users or not."""

import subprocess
import tomllib
from itertools import permutations
from pathlib import Path

import pytest

import ontology
from onto_compiler.command import CLEAN, FINDINGS, MISUSE
from onto_compiler.diff.compare import compare
from onto_compiler.diff.facets import FACETS
from onto_compiler.diff.sides import read_side
from onto_compiler.rdf import CORE, OWL, RDFS
from runtime.cli import main

HEAD = """
@prefix core: <https://w3id.org/onto-evwm/core#> . @prefix man: <https://w3id.org/onto-evwm/manipulation#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> . @prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix sh: <http://www.w3.org/ns/shacl#> . @prefix skos: <http://www.w3.org/2004/02/skos/core#> .
@prefix unit: <http://qudt.org/vocab/unit/> . @prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
@prefix ex: <https://example.org/e#> .
"""
SPACE = "https://example.org/e#"
CLASSES = "ex:A a owl:Class . ex:B a owl:Class ; rdfs:subClassOf ex:A . ex:C a owl:Class ."
PREDICATE = 'ex:near a man:ObjectRelation ; skos:notation "near" ; core:arity 2 ; core:domain ex:B ; core:range ex:B '


def header(version):
    return f'<https://example.org/e> a owl:Ontology ; owl:versionInfo "{version}" .\n'


def side(folder, name, text, version="1.0.0"):
    (folder / name).write_text(HEAD + (header(version) if version else "") + text)
    return folder / name


def changes(folder, old, new):
    before, after = side(folder, "old.ttl", old), side(folder, "new.ttl", new)
    return compare(read_side(str(before)), read_side(str(after))).changes


CASES = [
    pytest.param(case["old"], case["new"], (*case["expected"], case["breaking"]), id=case["name"])
    for case in tomllib.loads((Path(__file__).parent / "changes.toml").read_text())["case"]
]


def test_the_cases_cover_every_facet():
    assert len(CASES) == 38
    shown = {case.values[2][2] for case in CASES} - {""}
    assert {facet.name for facet in FACETS.values()} - shown == {"superproperty", "equivalence", "inverse", "imports"}


@pytest.mark.parametrize(("old", "new", "expected"), CASES)
def test_a_change_is_named_and_judged(old, new, expected, tmp_path):
    (found,) = changes(tmp_path, old, new)
    assert (found.change, found.kind, found.facet, found.breaking) == expected
    assert found.ontology == "https://example.org/e"
    assert found.term.startswith(SPACE)


@pytest.mark.parametrize(("old", "new", "expected"), CASES)
def test_an_ontology_does_not_differ_from_itself(old, new, expected, tmp_path):
    assert changes(tmp_path, old, old) == changes(tmp_path, new, new) == ()


@pytest.mark.parametrize(("old", "new", "expected"), CASES)
def test_the_way_back_is_the_same_change_with_its_sides_swapped(old, new, expected, tmp_path):
    (there,), (back,) = changes(tmp_path, old, new), changes(tmp_path, new, old)
    opposite = {"added": "removed", "removed": "added"}
    assert (back.term, back.property, back.old, back.new) == (there.term, there.property, there.new, there.old)
    assert back.change == opposite.get(there.change, "changed")


def test_a_change_says_what_was_and_what_is(tmp_path):
    (found,) = changes(tmp_path, PREDICATE + "; core:marginUnit unit:M .", PREDICATE + "; core:marginUnit unit:N .")
    assert (found.property, found.old, found.new) == (CORE + "marginUnit", ("unit:M",), ("unit:N",))


def test_blank_nodes_are_compared_by_what_they_say(tmp_path):
    axioms = [
        "[ a owl:Restriction ; owl:onProperty ex:p ; owl:maxCardinality 1 ]",
        "[ owl:unionOf ( ex:A [ owl:complementOf ex:B ] ) ]",
        "[ owl:allValuesFrom [ owl:oneOf ( ex:i ex:j ) ] ; owl:onProperty ex:p ]",
    ]
    texts = [f"ex:C a owl:Class ; rdfs:subClassOf {', '.join(order)} ." for order in permutations(axioms)]
    assert len(texts) == 6
    assert all(changes(tmp_path, texts[0], text) == () for text in texts)
    (found,) = changes(tmp_path, texts[0], texts[0].replace("maxCardinality 1", "maxCardinality 2"))
    assert found.property == RDFS + "subClassOf"
    assert found.old[0].replace("1", "2") == found.new[0]


def test_a_list_that_is_a_set_has_no_order_and_another_one_has(tmp_path):
    old = "ex:C a owl:Class ; owl:equivalentClass [ owl:unionOf ( ex:A [ owl:oneOf ( ex:i ex:j ) ] ) ] ."
    new = "ex:C a owl:Class ; owl:equivalentClass [ owl:unionOf ( [ owl:oneOf ( ex:j ex:i ) ] ex:A ) ] ."
    assert changes(tmp_path, old, new) == ()
    (found,) = changes(
        tmp_path, "ex:p owl:propertyChainAxiom ( ex:q ex:r ) .", "ex:p owl:propertyChainAxiom ( ex:r ex:q ) ."
    )
    assert (found.old, found.new) == (("( ex:q ex:r )",), ("( ex:r ex:q )",))


def test_what_is_nested_deeply_or_in_a_circle_is_compared_whole(tmp_path):
    deep = [f"_:b{n} owl:complementOf _:b{n + 1} ." for n in range(3000)]
    old = "ex:C a owl:Class ; rdfs:subClassOf _:b0 . " + " ".join(deep) + " _:b3000 owl:unionOf ( ex:A ex:B ) ."
    assert changes(tmp_path, old, old.replace("_:b", "_:c")) == ()
    (found,) = changes(tmp_path, old, old.replace("ex:B", "ex:D"))
    assert found.property == RDFS + "subClassOf"
    ring = "ex:C rdfs:subClassOf _:a . _:a owl:complementOf _:b . _:b owl:complementOf _:c . _:c owl:complementOf _:a"
    assert changes(tmp_path, f"{ring} .", f"{ring.replace('_:a', '_:z')} .") == ()
    (found,) = changes(tmp_path, f"{ring} .", f"{ring} ; ex:q 1 .")
    assert found.property == RDFS + "subClassOf"


@pytest.mark.parametrize(
    ("old", "new", "breaking"),
    [
        ("ex:A", "[ owl:unionOf ( ex:A ex:C ) ]", False),
        ("[ owl:unionOf ( ex:A ex:C ) ]", "ex:A", True),
        ("[ owl:unionOf ( ex:A ex:B ) ]", "ex:A", False),  # B is below A
        ("[ owl:intersectionOf ( ex:A ex:C ) ]", "ex:A", False),
        ("ex:A", "[ owl:intersectionOf ( ex:A ex:C ) ]", True),
        ("ex:B", "[ owl:intersectionOf ( ex:A ex:B ) ]", False),
        ("ex:C", "owl:Thing", False),
    ],
)
def test_a_domain_is_narrowed_or_widened_by_structure(old, new, breaking, tmp_path):
    (found,) = changes(tmp_path, f"{CLASSES} ex:p rdfs:domain {old} .", f"{CLASSES} ex:p rdfs:domain {new} .")
    assert found.breaking is breaking


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("ex:t a man:JointThreshold ; core:bound 1.50 .", "ex:t a man:JointThreshold ; core:bound 1.5 ."),
        ("ex:t core:bound 007 .", "ex:t core:bound 7 ."),
        (
            'ex:S sh:property [ sh:path ex:p ; sh:message "a" ] .',
            'ex:S sh:property [ sh:path ex:p ; sh:message "b" ] .',
        ),
    ],
)
def test_another_spelling_of_the_same_is_seen_and_breaks_nothing(old, new, tmp_path):
    (found,) = changes(tmp_path, old, new)
    assert (found.facet, found.breaking) == ("wording", False)
    assert found.old != found.new


def test_another_datatype_is_more_than_a_spelling(tmp_path):
    (found,) = changes(tmp_path, "ex:t core:bound 1.0 .", "ex:t core:bound 1.0e0 .")
    assert (found.facet, found.breaking) == ("threshold", True)


def test_what_has_no_name_is_compared_too(tmp_path):
    shape = "[] a sh:NodeShape ; sh:targetClass ex:A ; sh:nodeKind sh:IRI ."
    axiom = "[ owl:unionOf ( ex:A ex:B ) ] rdfs:subClassOf ex:C ."
    (found,) = changes(tmp_path, CLASSES, CLASSES + shape)
    assert (found.term, found.change, found.kind, found.breaking) == ("", "added", "shape", True)
    (found,) = changes(tmp_path, CLASSES + shape, CLASSES)
    assert (found.change, found.breaking) == ("removed", False)
    (found,) = changes(tmp_path, CLASSES, CLASSES + axiom)
    assert (found.kind, found.breaking) == ("axiom", True)
    (found,) = changes(tmp_path, CLASSES, CLASSES + "_:a owl:sameAs _:b . _:b owl:sameAs _:a .")
    assert (found.change, found.kind) == ("added", "node")
    assert changes(tmp_path, CLASSES + axiom + shape, CLASSES + shape + axiom) == ()


def test_a_new_group_of_disjoint_classes_is_one_change(tmp_path):
    (found,) = changes(tmp_path, CLASSES, CLASSES + "[] a owl:AllDisjointClasses ; owl:members ( ex:A ex:B ex:C ) .")
    assert (found.property, found.new) == (OWL + "AllDisjointClasses", ("ex:A", "ex:B", "ex:C"))
    assert found.breaking
    pairs = "ex:A owl:disjointWith ex:B , ex:C . ex:C owl:disjointWith ex:B ."
    assert (
        changes(tmp_path, CLASSES + "[] a owl:AllDisjointClasses ; owl:members ( ex:A ex:B ex:C ) .", CLASSES + pairs)
        == ()
    )


def test_relative_iris_are_the_same_in_both_places(tmp_path):
    (tmp_path / "old.ttl").write_text("<> a <#Thing> . <#a> a <#B> .")
    (tmp_path / "new.ttl").write_text("<> a <#Thing> . <#a> a <#B> .")
    assert compare(read_side(str(tmp_path / "old.ttl")), read_side(str(tmp_path / "new.ttl"))).changes == ()


def test_a_file_that_is_split_is_the_same(tmp_path):
    loop = "ex:C a owl:Class ; rdfs:subClassOf _:x . _:x owl:complementOf _:x ."
    assert changes(tmp_path, loop, loop) == ()


def test_a_new_class_among_disjoint_ones_breaks_nothing(tmp_path):
    old = CLASSES + "[] a owl:AllDisjointClasses ; owl:members ( ex:A ex:C ) ."
    new = CLASSES + "ex:Z a owl:Class . [] a owl:AllDisjointClasses ; owl:members ( ex:Z ex:A ex:C ) ."
    found = changes(tmp_path, old, new)
    assert {change.property for change in found if change.change == "changed"} == {OWL + "disjointWith"}
    assert not any(change.breaking for change in found)


def test_a_blank_node_that_holds_itself_ends(tmp_path):
    loop = "ex:C a owl:Class ; rdfs:subClassOf _:x . _:x owl:complementOf _:x ."
    assert changes(tmp_path, loop, loop) == ()


def test_a_file_that_is_split_is_the_same_ontology(tmp_path):
    whole = side(tmp_path, "whole.ttl", CLASSES + PREDICATE + ".")
    (tmp_path / "parts").mkdir()
    side(tmp_path / "parts", "a.ttl", CLASSES)
    side(tmp_path / "parts", "b.ttl", PREDICATE + ".", version=None)
    assert compare(read_side(str(whole)), read_side(str(tmp_path / "parts"))).changes == ()


REMOVAL = ("ex:A a owl:Class . ex:B a owl:Class .", "ex:A a owl:Class .")
ADDITION = REMOVAL[::-1]


@pytest.mark.parametrize(
    ("before", "after", "pair", "ok"),
    [
        ("1.2.3", "1.2.3", ADDITION, True),
        ("1.2.3", "1.2.3", REMOVAL, False),
        ("1.2.3", "1.3.0", REMOVAL, False),
        ("1.2.3", "2.0.0", REMOVAL, True),
        ("2.0.0", "1.9.0", REMOVAL, False),
        ("0.1.0", "0.1.1", REMOVAL, False),
        ("0.1.0", "0.2.0", REMOVAL, True),
        ("0.9.0", "1.0.0", REMOVAL, True),
        ("1.0.0", "0.9.0", REMOVAL, False),
        ("v1.0", "v2.0", REMOVAL, True),
        ("soon", "later", REMOVAL, False),
        (None, None, REMOVAL, False),
        (None, None, ADDITION, True),
    ],
)
def test_a_breaking_change_needs_a_version_that_says_so(before, after, pair, ok, tmp_path):
    old, new = side(tmp_path, "old.ttl", pair[0], before), side(tmp_path, "new.ttl", pair[1], after)
    assert compare(read_side(str(old)), read_side(str(new))).ok is ok
    assert main(["diff", str(old), str(new)]) == (CLEAN if ok else FINDINGS)


@pytest.mark.parametrize(
    ("before", "after", "ok"),
    [
        ("e/1.0.0", "e/2.0.0", True),
        ("e/1.0.0", "e/1.1.0", False),
        ("e/0.1.0", "e/0.2.0", True),
        ("e/2.0.0", "e/1.0.0", False),
        ("e/2.0.0", "e/2.0.0", False),
        ("gistCore13.0.0", "gistCore14.0.0", True),
        ("1.3/e", "2.0/e", True),
        ("2024-01-31/", "2024-02-01/", True),
        ("2024-02-01/", "2024-01-31/", False),
        ("2024/01/e", "2024/02/e", True),
        ("2024Q1/e", "2024Q2/e", True),
        ("alpha", "beta", True),
    ],
)
def test_a_version_iri_counts_as_a_version(before, after, ok, tmp_path):
    for name, version, text in (("old.ttl", before, REMOVAL[0]), ("new.ttl", after, REMOVAL[1])):
        iri = f"<https://w3id.org/{version}>"
        (tmp_path / name).write_text(f"{HEAD} <https://example.org/e> a owl:Ontology ; owl:versionIRI {iri} . {text}")
    (release,) = compare(read_side(str(tmp_path / "old.ttl")), read_side(str(tmp_path / "new.ttl"))).releases
    assert release.enough is ok
    assert (release.old, release.new) == (f"https://w3id.org/{before}", f"https://w3id.org/{after}")


def test_each_ontology_answers_for_its_own_terms(tmp_path):
    def write(name, version, mine, other):
        (tmp_path / name).mkdir()
        side(tmp_path / name, "a.ttl", mine, version)
        (tmp_path / name / "b.ttl").write_text(
            HEAD + f'<https://example.org/f> a owl:Ontology ; owl:versionInfo "1.0.0" . {other}'
        )
        return read_side(str(tmp_path / name))

    found = compare(write("old", "1.0.0", *["ex:A a owl:Class .", "ex:B a owl:Class ."]), write("new", "2.0.0", "", ""))
    assert [(r.ontology[-1], r.breaking, r.enough) for r in found.releases] == [("e", 1, True), ("f", 1, False)]


def test_the_shipped_ontology_is_read_whole():
    found = read_side(str(ontology.ROOT))
    assert len(found.terms) > 250
    assert compare(found, found).changes == ()
    assert compare(found, read_side(str(ontology.ROOT / "core.ttl"))).ok is False


@pytest.fixture
def repository(tmp_path, monkeypatch):
    def git(*words):
        named = ["-c", "user.name=n", "-c", "user.email=e@example.org"]
        subprocess.run(["git", *named, *words], cwd=tmp_path, check=True, capture_output=True)  # noqa: S607 - as onto diff

    (tmp_path / "ontology").mkdir()
    git("init", "-q")
    side(tmp_path / "ontology", "e.ttl", REMOVAL[0])
    git("add", "-A")
    git("commit", "-qm", "one")
    side(tmp_path / "ontology", "e.ttl", REMOVAL[1])
    (tmp_path / "ontology/broken.ttl").write_text("ex:a a")
    git("add", "-A")
    git("commit", "-qm", "two")
    (tmp_path / "ontology/broken.ttl").unlink()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_revision_of_git_can_be_compared(repository, capsys):
    assert main(["diff", "HEAD~1:ontology", "ontology"]) == FINDINGS
    assert "breaking: removed class ex:B" in capsys.readouterr().out
    assert main(["diff", "HEAD~1:ontology/e.ttl", "HEAD~1:"]) == CLEAN


def test_a_fault_in_a_revision_is_placed_in_it(repository, capsys):
    assert main(["diff", "HEAD:ontology", "ontology"]) == MISUSE
    assert "--> HEAD:ontology/broken.ttl:1:" in capsys.readouterr().err


def test_a_folder_of_a_revision_without_turtle_is_named_as_it_was_given(repository, capsys):
    (repository / "empty").mkdir()
    (repository / "empty/notes.txt").write_text("none")
    for words in (["add", "-A"], ["-c", "user.name=n", "-c", "user.email=e@example.org", "commit", "-qm", "three"]):
        subprocess.run(["git", *words], cwd=repository, check=True, capture_output=True)  # noqa: S607 - as onto diff
    assert main(["diff", "HEAD:empty", "ontology"]) == MISUSE
    assert "`HEAD:empty` holds no Turtle file" in capsys.readouterr().err


@pytest.mark.parametrize("given", ["nowhere:ontology", "HEAD:nothing", "--output=x:ontology", "HEAD~9:ontology"])
def test_a_revision_that_git_lacks_is_a_problem(given, repository, capsys):
    assert main(["diff", "--", given, "ontology"]) == MISUSE
    assert "SCH005" in capsys.readouterr().err
    assert not (repository / "x").exists()


def test_a_file_that_is_missing_is_a_problem(tmp_path, capsys):
    assert main(["diff", str(tmp_path / "old.ttl"), str(tmp_path)]) == MISUSE
    assert "TTL002" in capsys.readouterr().err
