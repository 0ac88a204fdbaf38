"""``owl:imports`` of data and shapes leads to files, never to the network; what leads nowhere is told at its place."""

import argparse
import shutil
from pathlib import Path

import pytest

from benchmarks.listening import listening
from onto_compiler.check.catalog import NAME, read_catalog
from onto_compiler.check.command import CHECK
from onto_compiler.check.data import check_data
from onto_compiler.check.run import check
from onto_compiler.check.settings import Settings
from onto_compiler.command import CLEAN, FINDINGS
from onto_compiler.problems import OntoError

CASES = Path(__file__).parent / "cases" / "imports"
PREFIXES = """@prefix ex: <http://example.org/> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
"""
SHAPE = "ex:S a sh:NodeShape ; sh:targetClass ex:Thing ; sh:property [ sh:path ex:id ; sh:minCount 1 ] ."
UPPER = """<http://example.org/upper> a owl:Ontology ; owl:versionIRI <http://example.org/upper/2> .
ex:Tool rdfs:subClassOf ex:Thing ."""
CATALOG = '<catalog prefer="public" xmlns="urn:oasis:names:tc:entity:xmlns:xml:catalog">\n{}\n</catalog>'
TO_UPPER = '<uri name="http://example.org/upper" uri="{}"/>'


@pytest.fixture
def put(tmp_path):
    def write(name, text):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(PREFIXES + text if name.endswith(".ttl") else text, encoding="utf-8")
        return path

    return write


@pytest.fixture
def importing(put):
    """Data that are wrong where the ontology that they import is read, and their shapes."""
    return put("own/data.ttl", "<> a owl:Ontology ; owl:imports <http://example.org/upper> . ex:a a ex:Tool ."), put(
        "shapes.ttl", SHAPE
    )


def found(data, shapes, imports=None):
    return [(p.code, p.severity, Path(p.file).name, p.line) for p in check_data([data], [shapes], imports).problems]


def run(*words):
    parser = argparse.ArgumentParser()
    CHECK.configure(parser)
    return CHECK.run(parser.parse_args([str(word) for word in words]))


VIOLATED = ("SHP001", "error", "data.ttl", 5)
MISSED = ("IMP001", "warning", "data.ttl", 5)


@pytest.mark.parametrize(
    ("data", "shapes", "more"), [("data", "shapes", []), ("data_rel", "shapes_rel", [("IMP001", 4, 58)])]
)
def test_the_imported_shape_and_hierarchy_count(data, shapes, more):
    problems = check_data([CASES / f"{data}.ttl"], [CASES / f"{shapes}.ttl"]).problems
    assert [(p.code, p.line, p.column) for p in problems] == [("SHP001", 4, 1), *more]
    assert "violates the shape `u:ThingShape`" in problems[0].message


def test_without_the_catalog_both_imports_are_told(tmp_path):
    for name in ("data", "shapes"):
        shutil.copy(CASES / f"{name}.ttl", tmp_path)
    problems = check_data([tmp_path / "data.ttl"], [tmp_path / "shapes.ttl"]).problems
    assert [(p.code, p.severity, p.line, p.column) for p in problems] == [
        ("IMP001", "warning", 3, 56),
        ("IMP001", "warning", 4, 58),
    ]
    assert "no file is known for it, and nothing is fetched" in problems[0].message


def test_the_command_line_maps_an_import(importing, put):
    data, shapes = importing
    upper = put("elsewhere.ttl", UPPER)
    assert found(data, shapes) == [MISSED]
    assert found(data, shapes, {"http://example.org/upper": upper}) == [VIOLATED]
    assert run(data, "--shapes", shapes) == CLEAN
    assert run(data, "--shapes", shapes, "--fail-on", "warning") == FINDINGS
    assert run(data, "--shapes", shapes, "--import", f"http://example.org/upper={upper}") == FINDINGS


def test_a_mapping_that_nothing_imports_is_told_with_the_nearest(importing, put):
    data, shapes = importing
    upper = put("upper.ttl", UPPER)
    problems = check_data([data], [shapes], {"http://example.org/uper": upper}).problems
    assert {p.code for p in problems} == {"IMP001"}
    assert "did you mean `http://example.org/upper`?" in {p.hint for p in problems}


@pytest.mark.parametrize("words", [["nothing"], ["=file.ttl"], ["http://example.org/upper="]])
def test_a_mapping_without_two_sides_is_refused(importing, words):
    data, shapes = importing
    with pytest.raises(OntoError, match="is no IRI=FILE"):
        run(data, "--shapes", shapes, "--import", *words)


def test_a_mapping_needs_its_file(importing):
    data, shapes = importing
    for words in ([data, "--shapes", shapes], [data]):
        with pytest.raises(OntoError, match=r"`none\.ttl` does not exist"):
            run(*words, "--import", "http://example.org/upper=none.ttl")


@pytest.mark.parametrize(
    "entry",
    [
        TO_UPPER.format("../lib/upper.ttl"),
        f'<group xml:base="../lib/">{TO_UPPER.format("upper.ttl")}</group>',
        f'<group id="g" xml:base="">{TO_UPPER.format("../lib/upper.ttl")}</group>',
        f"{TO_UPPER.format('none.ttl')}{TO_UPPER.format('../lib/upper.ttl')}",
        '<rewriteURI uriStartString="http://example.org/upper" rewritePrefix="../lib/upper.ttl"/>',
        '<uriSuffix uriSuffix="/upper" uri="../lib/upper.ttl"/>',
        '<nextCatalog catalog="../lib/more.xml"/>',
        '<delegateURI uriStartString="http://example.org/" catalog="../lib/more.xml"/>',
        f'<nextCatalog catalog="{NAME}"/><nextCatalog catalog="../lib/more.xml"/>',
    ],
)
def test_every_kind_of_entry_leads_to_a_file(importing, put, entry):
    put("lib/upper.ttl", UPPER)
    put("lib/more.xml", CATALOG.format(TO_UPPER.format("upper.ttl")))
    put(f"own/{NAME}", CATALOG.format(entry))
    assert found(*importing) == [VIOLATED]


def test_a_catalog_of_a_folder_above_counts_and_the_nearer_one_first(importing, put):
    put("upper.ttl", UPPER)
    put("own/other.ttl", "")
    put(NAME, CATALOG.format(TO_UPPER.format("upper.ttl")))
    assert found(*importing) == [VIOLATED]
    put(f"own/{NAME}", CATALOG.format(TO_UPPER.format("other.ttl")))
    assert found(*importing) == []


@pytest.mark.parametrize("iri", ["http://example.org/upper", "http://example.org/upper/2", "http://example.org/upper#"])
def test_a_given_file_is_found_by_what_it_declares(put, iri):
    data = put("data.ttl", f"<> a owl:Ontology ; owl:imports <{iri}> . ex:a a ex:Tool .")
    upper = put("upper.ttl", UPPER)
    assert [p.code for p in check_data([data, upper], [put("shapes.ttl", SHAPE)]).problems] == ["SHP001"]


def test_circles_and_shapes_that_import_their_data_end(put):
    data = put("data.ttl", "<> owl:imports <data.ttl> , <shapes.ttl> . ex:a a ex:Thing .")
    shapes = put("shapes.ttl", f"<> owl:imports <data.ttl> , <more.ttl> . {SHAPE}")
    put("more.ttl", "<> owl:imports <shapes.ttl> .")
    assert [one[0] for one in found(data, shapes)] == ["SHP001"]


def test_a_relative_import_may_have_a_fragment_and_escapes(put):
    put("a b.ttl", UPPER)
    data = put("data.ttl", "<> owl:imports <a%20b.ttl#> . ex:a a ex:Tool .")
    assert found(data, put("shapes.ttl", SHAPE)) == [VIOLATED]


def test_shacl_itself_needs_no_file(put):
    data = put(
        "data.ttl", "<> owl:imports <http://www.w3.org/ns/shacl#> , <http://www.w3.org/ns/shacl> . ex:a a ex:T ."
    )
    assert found(data, put("shapes.ttl", SHAPE)) == []


def test_an_import_that_cannot_be_read_is_a_problem(put):
    put("broken.ttl", "ex:a")
    data = put("data.ttl", "<> owl:imports <broken.ttl> .")
    assert [one[:3] for one in found(data, put("shapes.ttl", SHAPE))] == [("TTL005", "error", "broken.ttl")]


def test_a_folder_of_data_may_hold_a_catalog(put, tmp_path):
    put("folder/data.ttl", "ex:a a ex:Thing .")
    put(f"folder/{NAME}", CATALOG.format(TO_UPPER.format("upper.ttl")))
    assert [one[0] for one in found(tmp_path / "folder", put("shapes.ttl", SHAPE))] == ["SHP001"]


@pytest.mark.parametrize(
    ("text", "said", "line"),
    [
        ("", "is no XML: no element found", 1),
        ("@prefix ex: <x> .", "is no XML: ", 1),
        (CATALOG.format('<uri name="a" uri="b">'), "is no XML: mismatched tag", 3),
        ("<html/>", "is no XML catalog", 0),
        (CATALOG.format(""), "maps no IRI to a file", 0),
        (CATALOG.format("<uri name='a'/>"), "maps no IRI to a file", 0),
        (CATALOG.format(TO_UPPER.format("http://[")), "cannot be read", 0),
        ('<!DOCTYPE catalog [<!ENTITY a "b">]>\n' + CATALOG.format(""), "declares an XML entity", 1),
    ],
)
def test_a_catalog_that_is_none_is_told_in_one_sentence(importing, put, text, said, line):
    put(f"own/{NAME}", text)
    data, shapes = importing
    catalog, missed = sorted(check_data([data], [shapes]).problems, key=lambda p: p.severity)
    assert (catalog.code, catalog.severity, catalog.line) == ("IMP002", "error", line)
    assert said in catalog.message
    assert Path(catalog.file).name == NAME
    assert missed.code == "IMP001"


@pytest.mark.parametrize(
    ("uri", "said"),
    [
        ("none.ttl", "which is no file"),
        ("x" * 5000, "which is no file"),
        ("http://example.org/upper.ttl", "nothing is fetched"),
        ("%00", "which is no file"),
    ],
)
def test_a_catalog_that_maps_to_nothing_is_told_at_the_import(importing, put, uri, said):
    put(f"own/{NAME}", CATALOG.format(TO_UPPER.format(uri)))
    (problem,) = check_data([importing[0]], [importing[1]]).problems
    assert (problem.code, problem.severity, problem.line, problem.column) == ("IMP001", "warning", 5, 33)
    assert f"`{NAME}` maps it to" in problem.message
    assert said in problem.message


def test_no_import_and_no_catalog_reaches_the_network(put):
    with listening() as (url, made):
        doctype = f'<!DOCTYPE catalog PUBLIC "-//OASIS//DTD XML Catalogs V1.0//EN" "{url}catalog.dtd">\n'
        next_one = f'<nextCatalog catalog="{url}more.xml"/>'
        put(NAME, doctype + CATALOG.format(TO_UPPER.format(f"{url}upper.ttl") + next_one))
        data = put("data.ttl", f"<> owl:imports <http://example.org/upper> , <{url}other> . ex:a a ex:Tool .")
        assert [one[0] for one in found(data, put("shapes.ttl", SHAPE))] == ["IMP001", "IMP001"]
        assert len(read_catalog(data.parent / NAME).entries) == 2
        assert not made


SILENT = ("TTL007", "VOC")


def plain(path, settings=Settings(ignore=SILENT)):  # noqa: B008 - frozen
    return [(p.code, p.severity, Path(p.file).name, p.line) for p in check([path], settings=settings).problems]


def test_a_plain_check_follows_imports_too(importing, put):
    data, _ = importing
    unknown = [("OWL003", "info", "data.ttl", 5)]
    assert plain(data) == unknown
    upper = put("lib/upper.ttl", UPPER)
    mapped = (("http://example.org/upper", upper),)
    assert plain(data, Settings(ignore=SILENT, imports=mapped)) == []
    assert plain(data, Settings(ignore=SILENT, mapped=mapped)) == []
    assert run(data, "--import", f"http://example.org/upper={upper}", "--fail-on", "warning") == CLEAN
    put(NAME, CATALOG.format(TO_UPPER.format("lib/upper.ttl")))
    assert plain(data) == []


def test_of_a_plain_check_what_an_import_holds_counts_and_is_not_reported(importing, put):
    data, _ = importing
    put(NAME, CATALOG.format(TO_UPPER.format("upper.ttl")))
    put("upper.ttl", UPPER + " ex:Tool owl:disjointWith ex:Toy . ex:b a ex:Tool , ex:Toy . ex:c a owl:Klass .")
    assert plain(data) == []
    data.write_text(data.read_text() + "ex:a a ex:Toy .\n")
    assert [one[0] for one in plain(data)] == ["OWL005"]


def test_a_plain_check_says_why_an_import_is_not_followed(importing, put):
    data, _ = importing
    put(NAME, CATALOG.format(TO_UPPER.format("none.ttl")))
    assert plain(data) == [("IMP001", "warning", "data.ttl", 5)]
    put(NAME, "no XML")
    assert [one[:3] for one in plain(data)] == [("IMP002", "error", NAME)]
    put(NAME, CATALOG.format(TO_UPPER.format("upper.ttl")))
    put("upper.ttl", "ex:a")
    assert [one[:3] for one in plain(data)] == [("TTL005", "error", "upper.ttl")]


def test_of_a_plain_check_only_the_mappings_of_the_command_line_must_be_imported(importing, put):
    data, _ = importing
    upper = put("upper.ttl", UPPER)
    mapped = (("http://example.org/uper", upper),)
    ignored = (*SILENT, "OWL003")
    assert plain(data, Settings(ignore=ignored, imports=mapped)) == []
    assert plain(data, Settings(ignore=ignored, mapped=mapped)) == [("IMP001", "warning", "upper.ttl", 0)]


def test_a_plain_check_ends_where_imports_go_in_a_circle(put):
    first = put("first.ttl", "<> a owl:Ontology ; owl:imports <second.ttl> , <first.ttl> .")
    put("second.ttl", "<> a owl:Ontology ; owl:imports <first.ttl> , <second.ttl> .")
    assert plain(first) == []


def test_a_copy_of_a_shipped_ontology_may_be_mapped(put):
    manipulation = "https://w3id.org/onto-evwm/manipulation"
    own = f"<{manipulation}#Mine> a owl:Class ; rdfs:isDefinedBy <{manipulation}> ."
    copy = put("copy.ttl", f"<{manipulation}> a owl:Ontology . {own}")
    data = put(
        "data.ttl", f"<> owl:imports <{manipulation}> . ex:a a <{manipulation}#Mine> , <{manipulation}#Object> ."
    )
    report = check([data], settings=Settings(mapped=((manipulation, copy),)))
    assert [one.message for one in report.problems if one.code == "VOC001"] == ["`man:Object` is not declared"]
    assert report.files == (data,)


def test_settings_map_imports_for_shapes_too(importing, put):
    data, shapes = importing
    put("elsewhere.ttl", UPPER)
    put("onto.toml", '[check]\nimports = { "http://example.org/upper" = "elsewhere.ttl" }\n')
    assert run(data, "--shapes", shapes) == FINDINGS


def test_the_files_that_decide_the_result_are_named(importing, put):
    data, shapes = importing
    catalog = put(NAME, CATALOG.format(TO_UPPER.format("upper.ttl")))
    upper = put("upper.ttl", UPPER)
    for report in (check([data]), check_data([data], [shapes])):
        assert {catalog, upper, catalog.parent / "own" / NAME} <= set(report.consulted)
