"""Each format of ``onto check`` is what its readers expect, for problems whose texts hold every awkward character."""

import json
import re
from pathlib import Path
from xml.etree import ElementTree as ET

import pydantic
import pytest
from pydantic_sarif.model import StaticAnalysisResultsFormatSarifVersion210JsonSchema as SarifSchema

from onto_compiler.check.formats import FORMATS, Checked, render
from onto_compiler.check.pages import codes
from onto_compiler.check.tasks import check_all
from onto_compiler.problems import Problem

PROBLEMS = (
    Problem("a b/100%.ttl", 3, 7, "VOC001", "error", 'says: "50 %", a,b\r\nand\x00 <so on>', "did you & mean?"),
    Problem("a b/100%.ttl", 9, 1, "VOC001", "error", "again", ""),
    Problem("a b/100%.ttl", 9, 2, "TTL007", "warning", "unused", "remove it", 9, 6),
    Problem("/abs/x.ttl", 0, 0, "TTL002", "error", "is missing", "give it"),
    Problem("warned.ttl", 1, 1, "TTL007", "warning", "unused", "remove it"),
)
BROKEN = Path(__file__).parents[2]
CHECKED = Checked(PROBLEMS, ("a b/100%.ttl", "clean.ttl", "warned.ttl"))


def parsed(text):
    return ET.fromstring(text)  # noqa: S314 - we have just written it


def test_there_are_five_formats():
    assert list(FORMATS) == ["text", "json", "sarif", "github", "junit"]


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_names_every_code_and_ends_its_last_line(name):
    text = render(name, CHECKED)
    assert text.endswith("\n")
    assert {problem.code for problem in PROBLEMS} <= set(re.findall(r"[A-Z]{3}\d{3}", text))


@pytest.mark.parametrize("name", FORMATS)
def test_a_clean_run_is_well_formed(name):
    text = render(name, Checked((), ("clean.ttl",)))
    if name in {"text", "github"}:
        assert text == ""
    elif name == "junit":
        assert parsed(text).get("failures") == "0"
    else:
        json.loads(text)


def test_sarif_has_what_version_2_1_0_requires():
    log = json.loads(render("sarif", CHECKED))
    assert log["version"] == "2.1.0"
    assert log["$schema"].endswith("sarif-schema-2.1.0.json")
    (run,) = log["runs"]
    driver = run["tool"]["driver"]
    assert driver["name"] == "onto"
    assert [rule["id"] for rule in driver["rules"]] == ["TTL002", "TTL007", "VOC001"]
    assert len(run["results"]) == len(PROBLEMS)
    for result, problem in zip(run["results"], PROBLEMS, strict=True):
        assert result["message"]["text"].startswith(problem.message)
        assert result["level"] == problem.severity
        assert driver["rules"][result["ruleIndex"]]["id"] == result["ruleId"] == problem.code
        (location,) = result["locations"]
        place = location["physicalLocation"]
        if problem.line:
            assert (place["region"]["startLine"], place["region"]["startColumn"]) == (problem.line, problem.column)
        else:
            assert "region" not in place, "lines count from 1: a file as a whole has no region"


def regions(text):
    (run,) = json.loads(text)["runs"]
    return [result["locations"][0]["physicalLocation"].get("region") for result in run["results"]]


def test_sarif_says_where_a_problem_ends_if_that_is_known():
    start = {"startLine": 9, "startColumn": 2}
    ends = [(0, 0), (9, 6), (11, 1), (9, 2), (9, 1), (8, 9)]
    found = [Problem("x.ttl", 9, 2, "TTL007", "warning", "m", "", *end) for end in ends]
    assert regions(render("sarif", Checked(tuple(found), ("x.ttl",)))) == [
        start,
        {**start, "endLine": 9, "endColumn": 6},
        {**start, "endLine": 11, "endColumn": 1},
        {**start, "endLine": 9, "endColumn": 2},
        start,
        start,
    ]


@pytest.mark.parametrize(
    ("name", "marked"),
    [
        ("check/broken/voc001_undeclared_class.ttl", "man:Objekt"),
        ("check/broken/ttl007_unused_prefix.ttl", "dcterms:"),
        ("bddl/broken/unknown_predicate.bddl", "Onn"),
    ],
)
def test_a_region_is_what_the_problem_speaks_of(name, marked):
    (problem,) = check_all([BROKEN / name]).problems
    (region,) = regions(render("sarif", Checked((problem,), (name,))))
    lines = (BROKEN / name).read_text().splitlines()
    assert region["startLine"] == region["endLine"]
    assert lines[region["startLine"] - 1][region["startColumn"] - 1 : region["endColumn"] - 1] == marked


def test_sarif_meets_its_schema():
    turtle = {file.name[:3]: file for file in sorted((BROKEN / "check/broken").glob("*.ttl"))}  # one of each family
    assert len(turtle) >= 9
    found = list(check_all([BROKEN / "bddl/broken"]).problems)
    for file in turtle.values():
        found += check_all([file]).problems
    log = json.loads(render("sarif", Checked((*PROBLEMS, *found), tuple(map(str, turtle.values())))))
    assert len(log["runs"][0]["results"]) > 90
    SarifSchema.model_validate(log)
    log["runs"][0]["results"][0]["ruleIdx"] = 0
    with pytest.raises(pydantic.ValidationError, match="ruleIdx"):
        SarifSchema.model_validate(log)


def test_sarif_addresses_are_relative_to_the_checkout_or_absolute():
    (run,) = json.loads(render("sarif", CHECKED))["runs"]
    places = [result["locations"][0]["physicalLocation"]["artifactLocation"] for result in run["results"]]
    assert places[0] == {"uri": "a%20b/100%25.ttl", "uriBaseId": "%SRCROOT%"}
    assert places[3] == {"uri": "file:///abs/x.ttl"}


def test_sarif_explains_each_code_with_its_page():
    known = [Problem("x.ttl", 1, 1, code, "error", "m", "h") for code in codes()]
    (run,) = json.loads(render("sarif", Checked(tuple(known), ("x.ttl",))))["runs"]
    rules = run["tool"]["driver"]["rules"]
    assert len(rules) == len(codes()) > 120
    for rule in rules:
        assert "## Why it matters" in rule["help"]["markdown"]
        assert rule["shortDescription"]["text"]
        assert rule["fullDescription"]["text"].endswith((".", ":", "`")), rule["id"]


def test_a_rule_with_errors_and_warnings_is_an_error_by_default():
    mixed = (
        Problem("x.ttl", 1, 1, "DOC003", "warning", "m", ""),
        Problem("x.ttl", 2, 1, "DOC003", "error", "m", ""),
        Problem("x.ttl", 3, 1, "DOC003", "warning", "m", ""),
    )
    (run,) = json.loads(render("sarif", Checked(mixed, ("x.ttl",))))["runs"]
    assert [rule["defaultConfiguration"]["level"] for rule in run["tool"]["driver"]["rules"]] == ["error"]


def test_github_annotations_escape_what_would_end_them():
    lines = render("github", CHECKED).splitlines()
    assert lines[0] == (
        "::error file=a b/100%25.ttl,line=3,col=7,title=VOC001"
        '::says: "50 %25", a,b%0D%0Aand\x00 <so on>%0Adid you & mean?'
    )
    assert lines[3] == "::error file=/abs/x.ttl,title=TTL002::is missing%0Agive it"
    colon = render("github", Checked((Problem("C:\\a,b.ttl", 1, 1, "TTL001", "warning", "m"),), ()))
    assert colon == "::warning file=C%3A\\a%2Cb.ttl,line=1,col=1,title=TTL001::m\n"


@pytest.mark.parametrize(("fail_on", "failures"), [("error", 2), ("warning", 4)])
def test_junit_has_a_case_for_each_file_and_code(fail_on, failures):
    root = parsed(render("junit", Checked(PROBLEMS, CHECKED.files, fail_on)))
    (suite,) = root
    cases = {(case.get("classname"), case.get("name")): case for case in suite}
    assert set(cases) == {
        ("a b/100%.ttl", "VOC001"),
        ("a b/100%.ttl", "TTL007"),
        ("/abs/x.ttl", "TTL002"),
        ("clean.ttl", "clean"),
        ("warned.ttl", "TTL007"),
    }
    assert len(suite) == 5
    for element in (root, suite):
        assert (element.get("tests"), element.get("failures"), element.get("errors")) == ("5", str(failures), "0")
    assert sum(case.find("failure") is not None for case in suite) == failures
    both = cases["a b/100%.ttl", "VOC001"].find("failure").text
    assert "and\N{REPLACEMENT CHARACTER} <so on>" in both, "XML has no null character"
    assert "again" in both


def test_a_caret_stands_under_what_is_meant(tmp_path):
    file = tmp_path / "x.ttl"
    file.write_text("\ufeffone\n\ttwo\n", encoding="utf-8")
    text = render("text", Checked((Problem(str(file), 2, 2, "TTL001", "error", "m"),), ()))
    assert text.splitlines()[2:4] == ["   |  two", "   |  ^"]
