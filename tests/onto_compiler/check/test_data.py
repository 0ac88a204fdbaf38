"""``onto check DATA --shapes SHAPES``: each result stands at the triple that is to blame."""

import argparse
import json

import pytest

from onto_compiler.check.command import CHECK
from onto_compiler.check.data import ENDINGS, check_data
from onto_compiler.command import CLEAN, FINDINGS
from onto_compiler.problems import OntoError

PREFIXES = """@prefix ex: <http://example.org/> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
"""
SHAPES = (
    PREFIXES
    + """ex:PersonShape a sh:NodeShape ; sh:targetClass ex:Person ;
    sh:property [ sh:path ex:age ; sh:datatype xsd:byte ; sh:maxCount 1 ] ;
    sh:property [ sh:path ex:name ; sh:minCount 1 ; sh:message "a person has a name" ] ;
    sh:property [ sh:path [ sh:inversePath ex:knows ] ; sh:nodeKind sh:IRI ; sh:severity sh:Warning ] ;
    sh:property [ sh:path ( ex:address ex:zip ) ; sh:pattern "^[0-9]+$" ] .
"""
)


@pytest.fixture
def put(tmp_path):
    def write(name, text):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return write


def found(data, shapes):
    return [(p.line, p.column, p.severity, p.message.partition(": ")[2]) for p in check_data([data], [shapes]).problems]


def run(*words):
    parser = argparse.ArgumentParser()
    CHECK.configure(parser)
    return CHECK.run(parser.parse_args([str(word) for word in words]))


def test_each_result_stands_at_its_triple(put):
    data = put(
        "data.ttl",
        PREFIXES
        + """ex:alice a ex:Person ; ex:name "Alice" ;
    ex:age "5"^^xsd:byte , "300"^^xsd:byte ;
    ex:address [ ex:zip "12a" ] .
ex:bob a ex:Person ;
    ex:age "01"^^xsd:byte .
[] a ex:Person ; ex:name "Anon" ; ex:knows ex:bob .
[] a ex:Person ; ex:age "x" .
""",
    )
    assert found(data, put("shapes.ttl", SHAPES)) == [
        (5, 5, "error", "`ex:age` must have at most 1 value"),
        (5, 28, "error", 'the value `"300"^^xsd:byte` of `ex:age` must be a literal of the datatype `xsd:byte`'),
        (6, 25, "error", 'the value `"12a"` of `(ex:address/ex:zip)` must match the pattern `^[0-9]+$`'),
        (7, 1, "error", "a person has a name"),
        (9, 44, "warning", "the value `[]` of `(^ex:knows)` must be of the node kind `sh:IRI`"),
        (10, 1, "error", "a person has a name"),
        (10, 25, "error", 'the value `"x"` of `ex:age` must be a literal of the datatype `xsd:byte`'),
    ]


def test_the_hint_says_where_the_shape_stands(put):
    data, shapes = put("data.ttl", PREFIXES + "ex:bob a ex:Person .\n"), put("shapes.ttl", SHAPES)
    (problem,) = check_data([data], [shapes]).problems
    assert problem.message == "`ex:bob` violates the shape `ex:PersonShape`: a person has a name"
    assert problem.hint == f"change the data, or the shape at {shapes}:6:17; see `onto explain SHP001`"
    assert (problem.code, problem.file) == ("SHP001", str(data))


@pytest.mark.parametrize(
    ("name", "text", "place"),
    [
        (
            "data.nt",
            "<http://example.org/a> <http://example.org/age> true .\n# c\n{} <http://example.org/Person> .\n",
            (1, 49),
        ),
        (
            "data.nq",
            "<http://example.org/a> <http://example.org/age> true <x:g> .\n{} <http://example.org/Person> _:g .\n",
            (1, 49),
        ),
        ("data.trig", "ex:g { ex:a a ex:Person }\nGRAPH ex:h {\n  ex:b ex:c ex:d .\n  ex:a ex:age 5 .\n}\n", (7, 15)),
    ],
)
def test_datasets_and_lines_have_places_too(put, name, text, place):
    kind = "<http://example.org/a> <http://www.w3.org/1999/02/22-rdf-syntax-ns#type>"
    text = text.replace("{}", kind).replace("true", '"true"^^<http://www.w3.org/2001/XMLSchema#boolean>')
    data = put(name, PREFIXES + text if name == "data.trig" else text)
    problems = found(data, put("shapes.ttl", SHAPES))
    assert [problem[:2] for problem in problems if "datatype" in problem[3]] == [place]
    assert len(problems) == 2


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("data.jsonld", '{"@id": "http://example.org/a", "@type": "http://example.org/Person"}'),
        (
            "data.rdf",
            """<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#" xmlns:ex="http://example.org/">
            <ex:Person rdf:about="http://example.org/a"/></rdf:RDF>""",
        ),
    ],
)
def test_other_formats_are_read_and_named_whole(put, name, text):
    data = put(name, text)
    (problem,) = check_data([data], [put("shapes.ttl", SHAPES)]).problems
    assert (problem.file, problem.line, problem.code) == (str(data), 0, "SHP001")


def test_every_ending_is_a_format():
    assert len(ENDINGS) == 9


def test_two_blank_nodes_that_look_alike_are_told_apart(put):
    data = put("data.ttl", PREFIXES + "[] a ex:Person ; ex:name 1 .\n\n[] a ex:Person .\n[] a ex:Person .\n")
    assert [problem[0] for problem in found(data, put("shapes.ttl", SHAPES))] == [6, 7]


def test_the_same_blank_label_in_two_files_is_two_nodes(put):
    one = put("one.ttl", PREFIXES + '_:x a ex:Person ; ex:name "one" .\n')
    two = put("two.ttl", PREFIXES + "_:x a ex:Person .\n")
    (problem,) = check_data([one, two], [put("shapes.ttl", SHAPES)]).problems
    assert problem.file == str(two)


def test_subclasses_in_another_data_file_count(put):
    classes = put(
        "classes.ttl", PREFIXES + "@prefix r: <http://www.w3.org/2000/01/rdf-schema#> . ex:Boy r:subClassOf ex:Person ."
    )
    data, shapes = put("data.ttl", PREFIXES + "ex:a a ex:Boy ."), put("shapes.ttl", SHAPES)
    assert check_data([data], [shapes]).problems == ()
    assert [problem.file for problem in check_data([data, classes], [shapes]).problems] == [str(data)]


def test_shapes_may_import_a_local_file(put):
    put("shapes.ttl", SHAPES)
    importing = put("all.ttl", "<> <http://www.w3.org/2002/07/owl#imports> <shapes.ttl> , <nowhere.ttl> .")
    problems = check_data([put("data.ttl", PREFIXES + "ex:a a ex:Person .")], [importing]).problems
    assert [(problem.code, problem.line) for problem in problems] == [("IMP001", 1), ("SHP001", 4)]


def test_a_target_node_without_data_stands_in_the_shapes(put):
    shapes = put("shapes.ttl", PREFIXES + "ex:S a sh:NodeShape ;\n    sh:targetNode ex:a ; sh:class ex:C .\n")
    (problem,) = check_data([put("data.ttl", "")], [shapes]).problems
    assert (problem.file, problem.line, problem.column) == (str(shapes), 5, 19)


def test_a_shape_that_cannot_run_is_placed_in_the_shapes(put):
    shapes = put(
        "shapes.ttl", PREFIXES + 'ex:S sh:targetNode ex:a ;\n    sh:property [ sh:path ex:p ; sh:minCount "one" ] .\n'
    )
    (problem,) = check_data([put("data.ttl", "")], [shapes]).problems
    assert (problem.code, problem.file, problem.line, problem.column) == ("SHP002", str(shapes), 5, 46)


@pytest.mark.parametrize(
    ("name", "text", "code", "line"),
    [
        ("data.ttl", "<a> <b> .", "TTL001", 1),
        ("data.nt", "<http://a> <http://b> .\n", "TTL001", 1),
        ("data.jsonld", '{"@id": "a" "b"}', "TTL001", 1),
        ("data.rdf", "<rdf:RDF><x>", "TTL001", 0),
        ("data.csv", "a,b", "TTL002", 0),
        ("data.trig", f"<urn:g> {{\n<urn:a> <urn:b> {'[ <urn:b> ' * 200}1{' ]' * 200} }}", "TTL009", 2),
    ],
)
def test_what_cannot_be_read_is_a_problem(put, name, text, code, line):
    (problem,) = check_data([put(name, text)], [put("shapes.ttl", SHAPES)]).problems
    assert (problem.code, problem.line) == (code, line)


def test_the_command_exits_as_elsewhere(put, capsys):
    shapes = put("shapes.ttl", SHAPES)
    good, bad = (
        put("good.ttl", PREFIXES + 'ex:a a ex:Person ; ex:name "a" .'),
        put("bad.ttl", PREFIXES + "ex:a a ex:Person ."),
    )
    assert run(good, "--shapes", shapes) == CLEAN
    assert capsys.readouterr().err.startswith("no problem found in 1 file (2 triples)")
    assert run(bad, "--shapes", shapes, "--format", "json") == FINDINGS
    (problem,) = json.loads(capsys.readouterr().out)["problems"]
    assert (problem["code"], problem["line"], problem["column"]) == ("SHP001", 4, 1)
    with pytest.raises(OntoError, match=r"none\.ttl` does not exist"):
        run(bad, "--shapes", shapes.parent / "none.ttl")


@pytest.mark.parametrize(
    "text", ["", PREFIXES + "ex:S a sh:NodeShape ; sh:nodeKind sh:IRI .", "<urn:a> <urn:b> <urn:c> ."]
)
def test_shapes_without_a_target_are_refused_rather_than_met(put, text):
    with pytest.raises(OntoError, match=r"CLI002: no shape of .* has a target"):
        check_data([put("data.ttl", PREFIXES + "ex:a a ex:Person .")], [put("shapes.ttl", text)])


def test_a_context_elsewhere_is_not_fetched_and_the_problem_says_so(put):
    data = put("data.jsonld", '{"@context": "http://schema.org/", "@id": "urn:a", "name": "a"}')
    (problem,) = check_data([data], [put("shapes.ttl", SHAPES)]).problems
    assert "nothing is fetched" in problem.message
    assert problem.hint == "write the context into the file"


@pytest.mark.parametrize("path", ["()", "[ sh:inversePath () ]", "( ex:p () )"])
def test_an_empty_list_is_no_property_path(put, path):
    shapes = put(
        "shapes.ttl", PREFIXES + f"ex:S sh:targetNode ex:a ; sh:property [ sh:path {path} ; sh:minCount 1 ] .\n"
    )
    (problem,) = check_data([put("data.ttl", "")], [shapes]).problems
    assert (problem.code, problem.line) == ("SHP002", 4)
    assert "property path" in problem.message


@pytest.mark.parametrize("words", [("--fix",), ("--diff",), ()])
def test_what_makes_no_sense_is_refused(put, words):
    shapes = put("shapes.ttl", SHAPES)
    with pytest.raises(OntoError, match="CLI002"):
        run(*([shapes, *words] if words else []), "--shapes", shapes)


@pytest.mark.parametrize("statement", ["ex:Q a sh:NodeShpe .", "ex:Q ex:about sh:NodeShpe .", "ex:Q sh:abuot ex:a ."])
def test_a_misspelt_term_of_shacl_is_placed_whatever_its_property(put, statement):
    shapes = put("shapes.ttl", f"{PREFIXES}{statement} ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:nodeKind sh:IRI .")
    (problem,) = check_data([put("data.ttl", "")], [shapes]).problems
    assert (problem.code, problem.file, problem.line) == ("VOC011", str(shapes), 4)


def test_shapes_that_are_all_deactivated_find_nothing(put):
    shapes = put("shapes.ttl", PREFIXES + "ex:S a sh:NodeShape ; sh:targetNode ex:a ; sh:deactivated true .")
    assert run(put("data.ttl", PREFIXES + "ex:a ex:p 1 ."), "--shapes", shapes) == CLEAN
