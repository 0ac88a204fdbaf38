"""Every named query answers its question on a small trace: a folder holds the question, the data and the rows.

With ONTO_UPDATE_GOLDENS=1 the data and the rows are written anew; what changed is then for a person to read.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from pyoxigraph import RdfFormat, Store

from runtime.trace.sparql import csv_rows, named_queries
from runtime.trace.store import open_trace
from tests.competency.data import DATA, table, trig

HERE = Path(__file__).parent
FOLDERS = sorted(path.name for path in HERE.iterdir() if path.is_dir() and not path.name.startswith("_"))


def answer(name):
    query = named_queries()[name]
    return open_trace(HERE / name / "data.trig").query(query.text, name=name, file=str(query.file))


@pytest.mark.skipif(os.environ.get("ONTO_UPDATE_GOLDENS") != "1", reason="only under the flag")
def test_write_the_goldens_anew():
    for name, query in named_queries().items():
        (HERE / name).mkdir(exist_ok=True)
        (HERE / name / "question.md").write_text(query.question + "\n")
        (HERE / name / "data.trig").write_bytes(trig(name))
        (HERE / name / "expected.csv").write_text(table(csv_rows(answer(name))))


def test_every_named_query_has_a_folder_and_every_folder_a_query():
    assert FOLDERS == sorted(named_queries()) == sorted(DATA)
    assert len(FOLDERS) == 12
    for name in FOLDERS:
        assert {path.name for path in (HERE / name).iterdir()} == {"question.md", "data.trig", "expected.csv"}


@pytest.mark.parametrize("name", FOLDERS)
def test_the_query_gives_the_expected_rows(name):
    rows = list(csv_rows(answer(name)))
    assert len(rows) > 1, "an empty answer would show nothing"
    assert table(rows) == (HERE / name / "expected.csv").read_text()


@pytest.mark.parametrize("name", FOLDERS)
def test_the_question_is_the_first_comment_line_of_the_query(name):
    query = named_queries()[name]
    assert (HERE / name / "question.md").read_text() == query.question + "\n"
    assert query.question.endswith("?")
    assert query.text.startswith(f"# {query.question}\n")


@pytest.mark.parametrize("name", FOLDERS)
def test_the_data_is_what_the_writer_makes_of_its_episodes(name):
    assert (HERE / name / "data.trig").read_bytes() == trig(name)


@pytest.mark.parametrize("name", FOLDERS)
def test_the_query_declares_its_own_prefixes(name):
    """So that it runs at any SPARQL endpoint; the store here is given none."""
    store = Store()
    store.load((HERE / name / "data.trig").read_bytes(), format=RdfFormat.TRIG)
    assert len(list(store.query(named_queries()[name].text, use_default_graph_as_union=True))) > 0


def test_lineage_speaks_prov_alone():
    text = named_queries()["lineage"].text
    assert "PREFIX prov:" in text
    assert text.count("PREFIX") == 1


@pytest.mark.parametrize("name", FOLDERS)
def test_no_required_pattern_follows_an_optional_one(name):
    """Oxigraph joins what stands after an OPTIONAL without its keys: the query would be quadratic in the episodes."""
    depth, seen = 0, False
    for line in named_queries()[name].text.splitlines():
        word = line.strip()
        if depth == 1 and seen and word.startswith("?"):
            pytest.fail(f"`{word}` stands after an OPTIONAL")
        seen = seen or (depth == 1 and word.startswith("OPTIONAL"))
        depth += line.count("{") - line.count("}")
    assert depth == 0
