"""Each file of ``broken/`` is wrong in one way, and its first line says which code stands where."""

import re
from functools import cache
from pathlib import Path

import pytest

import ontology
from onto_compiler.check.pages import FOLDER, codes, index
from onto_compiler.check.queries import query_checks
from onto_compiler.check.run import check

HERE = Path(__file__).parent
ROOT = Path(__file__).resolve().parents[3]
BROKEN = sorted((HERE / "broken").glob("*.ttl"))
GOOD = sorted((HERE / "good").glob("*.ttl"))
CODE = re.compile(r"\b(?:TTL|VOC|DOC|SIG|RTE|RUL|BND|OWL|SHP|ABX|SCR|QRY)\d{3}\b")


def expected(path):
    first = path.read_bytes().partition(b"\n")[0].decode()
    return sorted((code, int(line), int(column)) for code, line, column in re.findall(r"(\w+) (\d+):(\d+)", first))


@cache
def problems_in(path):
    return check([path]).problems


def test_the_corpus_is_complete():
    assert len(BROKEN) == 145
    assert len(GOOD) == 3


@pytest.mark.parametrize("path", BROKEN, ids=lambda path: path.stem)
def test_a_broken_file_has_exactly_the_expected_problem(path):
    problems = problems_in(path)
    assert sorted((p.code, p.line, p.column) for p in problems) == expected(path)
    assert {p.file for p in problems} == {str(path)}


@pytest.mark.parametrize("path", BROKEN, ids=lambda path: path.stem)
def test_every_problem_says_what_to_do(path):
    for problem in problems_in(path):
        assert problem.hint
        assert not re.search(r"\{\w+\}|``", problem.message + problem.hint), "an unfilled name"


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_a_good_file_has_no_problem(path):
    assert check([path]).problems == ()


def test_all_good_files_together_have_no_problem():
    assert check([HERE / "good"]).problems == ()


def test_the_shipped_ontology_has_no_problem():
    report = check()
    assert report.problems == ()
    assert set(report.files) == set(ontology.turtle_files())
    assert report.triples > 2000


def test_codes_have_a_page_and_an_example_each():
    """Codes that the program can report, pages that explain one, and broken files that show one are the same."""
    sources = [*(ROOT / "onto_compiler").glob("*.py")]
    for folder in ("check", "shacl", "turtle"):
        sources += (ROOT / "onto_compiler" / folder).glob("*.py")
    sources += ontology.turtle_files()
    reported = {check.code for check in query_checks()}
    for path in sources:
        text = path.read_text(encoding="utf-8")
        reported |= {match for match in CODE.findall(text) if f'"{match}"' in text}
    shown = {code for path in BROKEN for code, _, _ in expected(path)}
    paged = {path.stem for path in FOLDER.glob("*.md") if CODE.fullmatch(path.stem)}
    assert reported == paged == shown
    assert len(reported) == 113


def test_every_page_says_what_the_program_says():
    """Each page shows a problem word for word, and lines of a broken file that has it."""
    for code in codes():
        if not CODE.fullmatch(code):
            continue
        page = (FOLDER / f"{code}.md").read_text(encoding="utf-8")
        assert page.startswith(f"# {code}: ")
        parts = re.findall(r"(?m)^## (.*)", page)
        assert [part for part in parts if part != "Example"] == ["What it means", "Why it matters", "Use instead"]
        files = [path for path in BROKEN if code in {found for found, _, _ in expected(path)}]
        said = [p for path in files for p in problems_in(path)]
        assert any(f"{p.severity}[{code}]: {p.message}\n   = help: {p.hint}\n" in page for p in said), code
        if example := re.search(r"(?s)## Example\n\n```turtle\n(.*?)```", page):
            lines = {line.rstrip(" ;.") for path in files for line in path.read_text(encoding="utf-8").splitlines()}
            assert {line.rstrip(" ;.") for line in example[1].splitlines()} <= lines, code


def test_the_index_lists_every_page_of_these_codes():
    rows = (FOLDER / "README.md").read_text(encoding="utf-8").splitlines()
    for row in index().splitlines():
        if CODE.search(row):
            assert row in rows
    assert sum(bool(CODE.search(row)) for row in rows) == 113
