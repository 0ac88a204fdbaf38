"""The HTML reference holds what the ontology says, all of it, and every link within it leads somewhere."""

import re
import shutil
from html.parser import HTMLParser
from pathlib import Path

import pytest

import ontology
from onto_compiler.command import CLEAN, MISUSE
from onto_compiler.reference.diagram import route_edges
from onto_compiler.reference.model import read_reference
from onto_compiler.reference.page import reference_html
from onto_compiler.schema import local_name
from onto_compiler.tables import FIRST
from runtime.cli import main

ROOT = Path(__file__).resolve().parents[3]
SERVED = ROOT / "docs/examples/served.ttl"
VOID = {"meta", "wbr", "br"}


class Page(HTMLParser):
    """Identifiers, targets, text, and whether every element that opens is closed."""

    def __init__(self, source):
        super().__init__()
        self.ids, self.targets, self.words, self.open, self.levels = [], [], [], [], []
        self.elements = set()
        self.feed(source)

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.elements.add(tag)
        self.ids += [given["id"]] if "id" in given else []
        self.targets += [given["href"]] if "href" in given else []
        self.levels += [int(tag[1])] if re.fullmatch(r"h\d", tag) else []
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)

    @property
    def text(self):
        return re.sub(r"\s+", " ", "".join(self.words))


@pytest.fixture(scope="module")
def source():
    return reference_html()


@pytest.fixture(scope="module")
def page(source):
    return Page(source)


@pytest.fixture(scope="module")
def reference():
    return read_reference()


def test_every_documented_term_has_exactly_one_entry(page, reference):
    assert len(reference.anchors) > 250
    assert len(set(reference.anchors.values())) == len(reference.anchors)
    assert {anchor: page.ids.count(anchor) for anchor in reference.anchors.values()} == dict.fromkeys(
        reference.anchors.values(), 1
    )


def test_an_anchor_is_the_local_name_and_carries_its_prefix_only_where_that_is_taken(reference):
    odd = {iri: anchor for iri, anchor in reference.anchors.items() if anchor != local_name(iri)}
    names = [local_name(iri) for iri in reference.anchors]
    assert odd
    assert all(names.count(local_name(iri)) > 1 and anchor.endswith(local_name(iri)) for iri, anchor in odd.items())


def test_every_link_within_the_page_leads_to_an_identifier(page):
    inside = [target[1:] for target in page.targets if target.startswith("#")]
    assert len(inside) > 500
    assert [target for target in inside if target not in page.ids] == []
    assert len(set(page.ids)) == len(page.ids)
    assert page.open == []


def test_every_definition_is_on_the_page(page, reference):
    missing = [iri for iri in reference.anchors if re.sub(r"\s+", " ", reference.definition(iri)) not in page.text]
    assert all(reference.definition(iri) for iri in reference.anchors)
    # Of an asset category or region the table gives category, region and class, which is all that its definition says.
    tables = {each.iri for each in reference.schema.bindings} | {t.iri for t in reference.schema.thresholds.values()}
    spoken = [iri for iri in missing if iri not in tables and not re.search(r"/(libero|pointmaze)#", iri)]
    assert {iri.partition("#")[2] for iri in spoken} <= {"bin", "bin_quarter", "door", "door_hinge"}


def test_headings_skip_no_level_and_nothing_is_loaded_from_elsewhere(page, source):
    assert page.levels[0] == 1
    assert all(after <= before + 1 for before, after in zip(page.levels, page.levels[1:], strict=False))
    assert not page.elements & {"script", "img", "link", "iframe"}
    assert not re.search(r"url\(|@import|\bsrc=", source)


def test_signatures_units_and_functions_of_predicates_are_shown(page):
    assert "on(Object, Support)" in page.text
    assert "grounded by" in page.text
    assert "metre (m), radian (rad)" in page.text


def test_the_diagram_shows_what_the_tables_hold_and_nothing_else(source, reference):
    edges = route_edges(reference)
    kinds = {p.kind for p in reference.schema.predicates.values()}
    routing = reference.tables.routing
    assert {(key[1], entry.route) for key, entry in routing.items() if key[2] == FIRST} <= set(edges)
    assert {a for a, _ in edges} & kinds == kinds
    assert {(a, b) for a, b in edges if a in reference.schema.routes} == {
        (iri, route.on_rejection) for iri, route in reference.schema.routes.items() if route.on_rejection
    }
    assert source.count('class="edge"') == len(edges) > 15


def test_every_competency_question_is_shown_with_its_query(page):
    files = ontology.query_files("competency")
    assert len(files) >= 10
    for path in files:
        question, query = path.read_text().split("\n", 1)
        assert question.lstrip("# ") in page.text
        assert re.sub(r"\s+", " ", query).strip() in page.text


def test_two_runs_write_the_same_bytes_and_so_does_another_hash_seed(source, tmp_path, monkeypatch):
    import subprocess
    import sys

    code = "from onto_compiler.reference.page import reference_html; print(end=reference_html())"
    for seed in ("1", "2"):
        done = subprocess.run(
            [sys.executable, "-c", code],
            env={"PYTHONHASHSEED": seed, "PATH": "", "PYTHONIOENCODING": "utf-8"},
            cwd=ROOT,
            capture_output=True,
            check=True,
        )
        assert done.stdout.decode() == source


def test_an_own_ontology_is_in_the_reference_and_moves_no_shipped_anchor(tmp_path, capsys, reference):
    assert main(["docs", "--ontology", str(SERVED), "--out", str(tmp_path / "site")]) == CLEAN
    assert capsys.readouterr().out.strip() == str(tmp_path / "site/index.html")
    mine = Page((tmp_path / "site/index.html").read_text(encoding="utf-8"))
    assert "served_on(Object, Object)" in mine.text
    assert set(reference.anchors.values()) < set(mine.ids)


def test_text_of_an_ontology_is_escaped(tmp_path):
    hostile = tmp_path / "hostile.ttl"
    shutil.copy(SERVED, hostile)
    text = hostile.read_text().replace("Holds when food", "<script>alert(1)</script> & food")
    hostile.write_text(text)
    assert "&lt;script&gt;alert(1)" in reference_html([hostile])
    assert "<script" not in reference_html([hostile])


def test_a_folder_that_cannot_be_made_is_a_problem(tmp_path, capsys):
    (tmp_path / "taken").write_text("")
    assert main(["docs", "--out", str(tmp_path / "taken")]) == MISUSE
    assert "SCH004" in capsys.readouterr().err


def test_a_score_is_shown_with_what_it_weighs(page):
    assert "\N{MINUS SIGN} 0.45 fact_margin(velocity_matches)" in page.text
    assert "+ 100 proprioception_gap" in page.text
