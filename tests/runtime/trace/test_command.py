"""``onto trace`` from its arguments to what it prints."""

from __future__ import annotations

import csv
import io
import json

import pytest
from pyoxigraph import RdfFormat, Store

import ontology
from onto_compiler.rdf import BASE
from runtime.cli import main
from runtime.trace.sparql import named_queries
from runtime.trace.store import TraceStore
from tests.runtime.trace import samples


@pytest.fixture
def workplace(tmp_path, monkeypatch):
    """A working folder in which a run named demo has left its store and its dump."""
    with TraceStore(tmp_path / "out" / "demo" / "store", samples.SCHEMA, "demo") as store:
        for episode in samples.all_samples():
            store.add(episode)
        store.export_trig(tmp_path / "out" / "demo" / "trace.trig")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("COLUMNS", raising=False)
    return tmp_path


def onto(capsys, *words, code=0):
    assert main(["trace", *words]) == code
    return capsys.readouterr()


def test_a_named_query_answers_from_the_newest_trace(workplace, capsys):
    out, err = onto(capsys, "query", "--named", "repairs")
    assert out.startswith("Which route repaired which failure")
    assert "source_joint_residual" in out
    assert err == "2 rows\n"


@pytest.mark.parametrize("name", sorted(named_queries()))
def test_every_named_query_is_readable_at_80_columns(workplace, capsys, monkeypatch, name):
    monkeypatch.setenv("COLUMNS", "80")
    with TraceStore(workplace / "out" / "demo" / "store", samples.SCHEMA, "demo") as store:
        store.add(samples.played())
        store.add(samples.planned())
        store.export_trig(workplace / "out" / "demo" / "trace.trig")
    out, _ = onto(capsys, "query", "--named", name)
    body = out.splitlines()[1:]
    assert max(map(len, body)) <= 80 or name == "lineage"
    assert "…" not in out
    for word in csv_words(capsys, name):
        assert word in out


def csv_words(capsys, name):
    out, _ = onto(capsys, "query", "--named", name, "--format", "csv")
    rows = list(csv.reader(io.StringIO(out)))
    assert len(rows) > 1
    return {w for row in rows for cell in row for w in cell.split() if not any(c.isdigit() for c in w) and w != "true"}


def test_json_holds_numbers_as_numbers(workplace, capsys):
    out, _ = onto(capsys, "query", "--named", "unmet-predicates", "--json")
    answer = json.loads(out)
    assert answer["question"].startswith("Which required predicates")
    margins = [row["margin"] for row in answer["rows"]]
    assert -0.142 in margins
    assert None in margins


def test_a_file_and_a_trace_can_be_named_and_prefixes_are_known(workplace, capsys):
    (workplace / "mine.rq").write_text("# How many episodes?\nSELECT (COUNT(?e) AS ?n) { ?e a trace:Episode }")
    for trace in ([], ["out/demo/trace.trig"], ["out/demo"], ["out/demo/store"]):
        out, _ = onto(capsys, "query", "mine.rq", *trace, "--json")
        assert json.loads(out) == {"name": "mine", "question": "How many episodes?", "rows": [{"n": 6}]}


def test_ask_and_construct_have_rows_too(workplace, capsys):
    (workplace / "a.rq").write_text("ASK { ?e a trace:Episode }")
    assert json.loads(onto(capsys, "query", "a.rq", "--json").out)["rows"] == [{"answer": True}]
    (workplace / "c.rq").write_text("CONSTRUCT { ?e a core:Event } WHERE { ?e a trace:Episode }")
    assert len(json.loads(onto(capsys, "query", "c.rq", "--json").out)["rows"]) == 6


def test_a_query_can_follow_the_ontology(workplace, capsys):
    (workplace / "family.rq").write_text(
        "SELECT (COUNT(?d) AS ?n) { ?d a trace:Diagnosis ; core:failureClass/rdfs:subClassOf* core:RelationMismatch }"
    )
    found = json.loads(onto(capsys, "query", "family.rq", "out/demo/trace.trig", "--json").out)
    assert found["rows"][0]["n"] == 6


@pytest.mark.parametrize(
    ("text", "place", "message"),
    [
        ("SELECT ?x WHERE {\n  ?x a ?y ?z\n}", "bad.rq:2:11", "what begins with `?z` is not understood"),
        ("SELECT ?x {\n  ?x foo:bar ?y }", "bad.rq:2:", "the prefix `foo:` is not declared"),
        ("SELECT ?x {", "bad.rq:1:11", "the query ends before it is complete"),
    ],
)
def test_a_syntax_error_is_one_message_with_its_line_and_a_caret(workplace, capsys, text, place, message):
    (workplace / "bad.rq").write_text(text)
    out, err = onto(capsys, "query", "bad.rq", code=2)
    assert out == ""
    assert err.count("error[") == 1
    assert "error[TRC004]" in err
    assert message in err
    assert place in err
    assert err.splitlines()[3].endswith("^")


@pytest.mark.parametrize(
    ("words", "code", "hint"),
    [
        (["query", "--named", "repair"], "TRC005", "did you mean `repairs`?"),
        (["query"], "CLI002", "margins-by-predicate"),
        (["query", "a.rq", "b.trig", "c"], "CLI002", "onto trace query --help"),
        (["query", "gone.rq"], "TRC004", "--list"),
        (["query", "--named", "repairs", "gone.trig"], "TRC002", "give a trace file"),
        (["show", "put_the_bowl"], "TRC006", "name one of"),
        (["show", "take_the_bawl_off"], "TRC006", "did you mean `take_the_bowl_off`?"),
        (["show", "99"], "TRC006", "from 1 to 6"),
        (["explain", "take_the_bawl_off"], "TRC006", "did you mean `take_the_bowl_off`?"),
        (["qery"], "CLI002", "did you mean `query`?"),
    ],
)
def test_a_misuse_has_a_code_and_a_remedy(workplace, capsys, words, code, hint):
    (workplace / "a.rq").write_text("ASK { }")
    _, err = onto(capsys, *words, code=2)
    assert f"error[{code}]" in err
    assert hint in err


def test_the_list_numbers_episodes_as_show_counts_them(workplace, capsys):
    rows = json.loads(onto(capsys, "list", "--json").out)
    assert [row["number"] for row in rows] == [1, 2, 3, 4, 5, 6]
    for row in rows:
        shown = json.loads(onto(capsys, "show", str(row["number"]), "--json").out)
        assert (shown["task"], shown["state"], shown["outcome"], shown["attempts"]) == (
            row["task"],
            row["state"],
            row["outcome"],
            row["attempts"],
        )
    out, err = onto(capsys, "list")
    assert "put_the_bowl_on_the_plate" in out
    assert err.startswith("6 episodes in ")


def test_show_tells_the_whole_chain_in_sentences(workplace, capsys):
    out, _ = onto(capsys, "show", "libero_goal/put_the_bowl_on_the_plate/0")
    text = " ".join(out.split())
    for sentence in (
        "The task requires on(akita_black_bowl_1, plate_1).",
        "Its declared initial fact holds.",
        "Fact: the simulator finds on(akita_black_bowl_1, plate_1) unmet (margin -142 mm, decided by x).",
        'Diagnosis: relation_missing, by the rule "relation missing", priority 20.',
        'Route: dispatch to `object_relation_predicate` (state level), by the rule "dispatch".',
        "Verification: the native verifier rejects On(akita_black_bowl_1, plate_1).",
        "Route: reroute to `source_joint_residual` (state level) after `object_relation_predicate` was rejected",
        'by the rule "reroute after rejection".',
        "accepts On(akita_black_bowl_1, plate_1), and still does after 20 steps of settling.",
        "At the end, on(akita_black_bowl_1, plate_1) holds (margin +18 mm).",
    ):
        assert sentence in text
    assert max(map(len, out.splitlines())) <= 80


def test_show_tells_of_absent_evidence_broken_premises_and_faults(workplace, capsys):
    assert "has no evidence of in_region(plate_1," in " ".join(onto(capsys, "show", "take").out.split())
    assert (
        "Its declared initial fact does not hold: in_region(plate_1, main_table_stove_front_region) (-13 mm)"
        in " ".join(onto(capsys, "show", "turn_on_the_stove/1").out.split())
    )
    assert "Fault: qpos[3] is not finite." in onto(capsys, "show", "plate/2").out


RULES = "ontology/rules"


def line_of(file, subject):
    """The line of a shipped rule file that a subject's block begins on."""
    lines = (ontology.ROOT / "rules" / file).read_text().splitlines()
    return next(number for number, line in enumerate(lines, 1) if line.startswith(f"{subject} "))


def test_explain_gives_the_reason_of_each_decision(workplace, capsys):
    shown, _ = onto(capsys, "show", "libero_goal/put_the_bowl_on_the_plate/0")
    out, _ = onto(capsys, "explain", "libero_goal/put_the_bowl_on_the_plate/0")
    assert max(map(len, out.splitlines())) <= 80
    text = " ".join(out.split())
    for sentence in (
        "Required at put_the_bowl_on_the_plate.bddl:87:10.",
        "The rule: A required relation that is absent or explicitly false is missing.",
        f"{RULES}/diagnosis.ttl:{line_of('diagnosis.ttl', 'rule:relation_missing')} <{BASE}rules#relation_missing>.",
        "`object_relation_predicate` admits relation_missing and supports ObjectRelation, the kind of `on`.",
        f"{RULES}/routing.ttl:{line_of('routing.ttl', 'rule:dispatch')} <https://w3id.org/onto-evwm/rules#dispatch>.",
        "Eligible as well: `source_joint_residual`, to which `object_relation_predicate` leaves what it fails at.",
        "`object_relation_predicate` names `source_joint_residual` for rejections.",
        "`source_joint_residual` admits relation_missing and supports ObjectRelation",
        "Eligible as well: `object_relation_predicate`.",
    ):
        assert sentence in text
    kept = iter(out.splitlines())
    assert all(line in kept for line in shown.splitlines()), "what `show` tells is told here too, in its order"


def test_explain_says_why_one_of_several_failures_came_first(workplace, capsys):
    text = " ".join(onto(capsys, "explain", "take").out.split())
    found = json.loads(onto(capsys, "explain", "take", "--json").out)["history"][0]["diagnoses"]
    chosen = next(each for each in found if each["selected"])
    assert len(found) == 2
    assert chosen["priority"] == min(each["priority"] for each in found)
    assert f"Chosen before 1 other: priority {chosen['priority']} is the least" in text


def test_explain_has_the_same_reasons_as_json(workplace, capsys):
    told = json.loads(onto(capsys, "explain", "libero_goal/put_the_bowl_on_the_plate/0", "--json").out)
    shown = json.loads(onto(capsys, "show", "libero_goal/put_the_bowl_on_the_plate/0", "--json").out)
    assert told["required"] == shown["required"]
    first, second = told["history"]
    rule = first["diagnoses"][0]["rule"]
    assert (rule["label"], rule["file"]) == ("relation missing", f"{RULES}/diagnosis.ttl")
    assert rule["line"] == line_of("diagnosis.ttl", "rule:relation_missing")
    assert first["route"]["name"] == "object_relation_predicate"
    assert first["route"]["also_eligible"] == ["source_joint_residual"]
    assert second["route"]["after"] == "object_relation_predicate"
    assert second["route"]["decision"] == "reroute"
    assert second["verification"] == shown["history"][1]["verification"]


def test_a_rule_of_ones_own_is_explained_from_ones_own_file(workplace, capsys):
    mine = workplace / "mine.ttl"
    text = (ontology.ROOT / "rules" / "diagnosis.ttl").read_text()
    mine.write_text("\n\n" + text.replace("that is absent or explicitly false is missing", "that we miss is missing"))
    out, _ = onto(capsys, "explain", "libero_goal/put_the_bowl_on_the_plate/0", "--ontology", "mine.ttl")
    words = " ".join(out.split())
    assert "The rule: A required relation that we miss is missing." in words
    assert f"Its place: mine.ttl:{line_of('diagnosis.ttl', 'rule:relation_missing') + 2} <" in words


@pytest.mark.parametrize(
    ("shape", "rdf_format"),
    [("trig", RdfFormat.TRIG), ("nquads", RdfFormat.N_QUADS), ("jsonld", RdfFormat.JSON_LD)],
)
def test_an_export_holds_the_same_quads_in_every_format(workplace, capsys, shape, rdf_format):
    expected, store = Store(), Store()
    expected.load((workplace / "out/demo/trace.trig").read_bytes(), format=RdfFormat.TRIG)
    out, _ = onto(capsys, "export", "--format", shape)
    store.load(out.encode(), format=rdf_format)
    assert set(store) == set(expected)
    onto(capsys, "export", "--format", shape, "--output", "there.rdf")
    assert (workplace / "there.rdf").read_text() == out
    _, err = onto(capsys, "export", "--output", "no/such/folder.trig", code=2)
    assert "error[TRC001]" in err


def test_the_named_queries_can_be_listed(workplace, capsys):
    found = json.loads(onto(capsys, "query", "--list", "--json").out)
    assert {query["name"] for query in found} == set(named_queries())


def test_episodes_that_differ_in_run_alone_have_names_of_their_own(tmp_path, capsys):
    for run in ("first", "second"):
        with TraceStore(tmp_path / "store", samples.SCHEMA, run) as store:
            store.add(samples.accepted())
    rows = json.loads(onto(capsys, "list", str(tmp_path / "store"), "--json").out)
    assert [(row["run"], row["seed"], row["trial"], row["mode"]) for row in rows] == [
        ("first", 7, 0, "state"),
        ("second", 7, 0, "state"),
    ]
    _, err = onto(capsys, "show", "put_the_bowl_on_the_plate", str(tmp_path / "store"), code=2)
    offered = [word for word in err.split("`") if word.endswith("/trial-0")]
    assert len(offered) == len(set(offered)) == 2
    for name in offered:
        onto(capsys, "show", name, str(tmp_path / "store"))
