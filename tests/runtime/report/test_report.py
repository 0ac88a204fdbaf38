"""The report is one file that needs nothing else, says what the records say, and can be read by everybody."""

from __future__ import annotations

import itertools
import re
from base64 import b64encode
from dataclasses import replace
from html.parser import HTMLParser
from importlib.resources import files

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from onto_compiler.problems import OntoError
from runtime.report import write_report
from runtime.report.bars import margin_bar
from runtime.report.write import report_html
from runtime.trace.sparql import named_queries
from runtime.trace.store import TraceStore
from tests.runtime.trace import samples
from tests.strategies import SCHEMA, episodes

law = settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
VOID = {"meta", "br", "wbr", "rect", "line", "circle"}


class Page(HTMLParser):
    """Checks that tags nest, and keeps elements and text."""

    def __init__(self, html):
        super().__init__(convert_charrefs=True)
        self.open, self.tags, self.words = [], [], []
        self.feed(html)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "style" not in self.open:
            self.words.append(data)

    @property
    def text(self):
        return "".join(self.words)

    def all(self, tag):
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    with TraceStore(tmp_path_factory.mktemp("trace") / "store", SCHEMA, "demo") as store:
        for episode in samples.all_samples():
            store.add(episode)
        return [store.query(query.text, name=name) for name, query in named_queries().items()]


@pytest.fixture(scope="module")
def html(answers):
    return report_html(samples.all_samples(), SCHEMA, answers)


def test_the_file_needs_nothing_from_elsewhere(html):
    page = Page(html)
    for tag, attributes in page.tags:
        assert tag not in {"script", "link", "img", "iframe", "object"}
        assert "src" not in attributes
        assert attributes.get("href", "#").startswith("#")
    assert "url(" not in html
    assert "@import" not in html


def test_every_link_has_its_target_and_every_episode_its_chain(html):
    page = Page(html)
    targets = {attributes["id"] for _, attributes in page.tags if "id" in attributes}
    links = {attributes["href"].removeprefix("#") for attributes in page.all("a")}
    assert links == targets
    assert len(targets) == len(samples.all_samples())


def test_the_page_says_what_the_records_say(html):
    text = Page(html).text
    for part in (
        "2 of 6",  # accepted
        "1 of 2",  # settled
        "5 of 6",  # premises
        "mujoco 3.3.7",
        "-142 mm before, +18 mm after",
        "object_relation_predicate",
        "predicate_mismatch",
        "no robot's execution",
        "privileged simulator state",
        "qpos[3] is not finite",
    ):
        assert part in text


def test_a_controller_is_not_said_to_have_written_a_state():
    text = Page(report_html([samples.played()], SCHEMA, ())).text
    assert "controller (actions were executed under dynamics)" in text
    assert "in 90 control steps and broken off, as the fingers held nothing" in text
    assert "no robot's execution" not in text
    assert "qpos" not in text


def test_every_answer_stands_with_its_question_and_query(html, answers):
    text = Page(html).text
    assert len(answers) == 12
    for answer in answers:
        assert answer.question in text
        assert answer.query in text


def test_headings_do_not_skip_a_level_and_tables_have_captions_and_scopes(html):
    page = Page(html)
    levels = [int(tag[1]) for tag, _ in page.tags if re.fullmatch("h[1-6]", tag)]
    assert levels[0] == 1
    assert all(later - earlier <= 1 for earlier, later in itertools.pairwise(levels))
    assert len(page.all("caption")) == len(page.all("table")) == 13
    assert all("scope" in attributes for attributes in page.all("th"))
    assert all(attributes["role"] == "img" and attributes["aria-label"] for attributes in page.all("svg"))
    assert page.all("html")[0]["lang"] == "en"


def _luminance(colour):
    channels = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("scheme", [0, 1])
def test_text_has_the_contrast_that_wcag_asks_for(scheme):
    css = files("onto_compiler").joinpath("html.css").read_text()
    block = re.findall(r":root \{(.*?)\}", css, re.DOTALL)[scheme]
    colours = dict(re.findall(r"--([\w-]+): (#\w{6})", block))
    pairs = [("ink", "page"), ("ink", "card"), ("quiet", "page"), ("quiet", "card"), ("link", "card"), ("ink", "code")]
    pairs += [(tone, f"{tone}-soft") for tone in ("good", "bad", "warn")]
    for front, back in pairs:
        low, high = sorted((_luminance(colours[front]), _luminance(colours[back])))
        assert (high + 0.05) / (low + 0.05) >= 4.5, (front, back)


def test_names_from_a_task_cannot_become_markup():
    bad = replace(samples.accepted(), task="<script>alert(1)</script>", suite="a&b")
    page = Page(report_html([bad], SCHEMA, []))
    assert page.all("script") == []
    assert "<script>alert(1)</script>" in page.text


@law
@given(st.lists(episodes(), max_size=2))
def test_any_episodes_give_a_well_formed_page_and_always_the_same(found):
    html = report_html(found, SCHEMA, [])
    Page(html)
    assert html == report_html(found, SCHEMA, [])


@pytest.mark.parametrize(("polarity", "start"), [(True, "160"), (False, "0")])
def test_the_shaded_side_of_a_bar_is_the_satisfied_one(polarity, start):
    bar = margin_bar(-0.1, 0.05, 0.0, "m", polarity=polarity, met=polarity)
    assert f'class="side" x="{start}"' in bar
    before, after = (float(x) for x in re.findall(r'<circle class="[^"]*" cx="([\d.]+)"', bar))
    assert before < 160 < after
    assert ('class="after"' in bar) == polarity


def test_a_bar_without_any_margin_is_left_out():
    assert margin_bar(float("nan"), float("nan"), 0.0, "m", polarity=True, met=False) == ""


def test_a_report_that_cannot_be_written_is_a_problem(tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(OntoError) as error:
        write_report(tmp_path / "file" / "report.html", [], SCHEMA, [])
    assert error.value.problems[0].code == "TRC001"
    write_report(tmp_path / "new" / "report.html", [], SCHEMA, [])
    assert (tmp_path / "new" / "report.html").read_text().startswith("<!doctype html>")


def test_pictures_stand_side_by_side_with_their_episode():
    episodes = [samples.accepted(), samples.unresolved()]
    pairs = [(b"before-1", b"after-1"), (b"before-2", b"after-2")]
    page = Page(report_html(episodes, SCHEMA, [], pairs))
    shown = [picture["src"] for picture in page.all("img")]
    assert shown == [f"data:image/jpeg;base64,{b64encode(data).decode()}" for pair in pairs for data in pair]
    assert all(picture["alt"].endswith((": before", ": after")) for picture in page.all("img"))
    assert "Before and after" in page.text


def test_a_report_without_pictures_does_not_speak_of_them():
    assert "Before and after" not in report_html([samples.accepted()], SCHEMA, [])
