"""Each check is one query file with a header; a new one needs no Python."""

import re
import textwrap

import pytest

import ontology
from onto_compiler.check.model import load_model
from onto_compiler.check.queries import query_checks, read_check, run_query

FILES = ontology.query_files("checks")


def test_every_query_is_collected():
    assert len(FILES) == 42
    assert len(query_checks()) == len(FILES)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_query_is_named_after_its_code_and_selects_what_its_sentences_name(path):
    check = read_check(path)
    assert path.stem.startswith(check.code.lower() + "_")
    assert check.severity in {"error", "warning"}
    assert not check.problem.endswith(".")
    selected = set(
        re.search(r"(?m)^SELECT (?:DISTINCT )?(.*) WHERE", check.query)[1].translate(str.maketrans("()", "  ")).split()
    )
    assert "?subject" in selected
    named = set(re.findall(r"\{(\w+)\}", check.problem + check.solution))
    assert {f"?{name}" for name in named if name != "replacement"} <= selected


def test_a_new_query_finds_what_it_asks_for(tmp_path):
    path = tmp_path / "xyz001_shouting.rq"
    path.write_text(
        "# code: XYZ001\n# severity: warning\n# Problem: the label `{object}`\n#   shouts\n# Solution: lower it\n\n"
        "SELECT ?subject ?predicate ?object WHERE {\n    ?subject ?predicate ?object\n"
        "    FILTER (?predicate = rdfs:label && UCASE(STR(?object)) = STR(?object))\n}\n"
    )
    (tmp_path / "x.ttl").write_text(
        '<https://e.org/a> <http://www.w3.org/2000/01/rdf-schema#label> "LOUD" , "quiet" .\n'
    )
    check = read_check(path)
    assert check.problem == "the label `{object}` shouts"
    (finding,) = run_query(load_model([tmp_path]), check)
    assert finding.object.value == "LOUD"


def test_a_header_without_its_parts_is_refused(tmp_path):
    path = tmp_path / "xyz001_nothing.rq"
    path.write_text("# code: XYZ001\n\nSELECT ?subject WHERE { }\n")
    with pytest.raises(ValueError, match="lacks Problem, Solution, severity"):
        read_check(path)


def test_the_documented_example_is_a_check_that_runs(tmp_path):
    page = (ontology.ROOT.parent / "docs" / "checks.md").read_text(encoding="utf-8")
    block = re.search(r"(?s)```sparql\n(.*?)```", page)[1]
    path = tmp_path / "voc012_shouting.rq"
    path.write_text(textwrap.dedent(block))
    check = read_check(path)
    assert check.code == "VOC012"
    (tmp_path / "x.ttl").write_text('<https://e.org/a> <http://www.w3.org/2000/01/rdf-schema#label> "LOUD" , "Low" .\n')
    assert [finding.object.value for finding in run_query(load_model([tmp_path / "x.ttl"]), check)] == ["LOUD"]
