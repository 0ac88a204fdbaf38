"""Every published task file is read, and the figures count what they say."""

from __future__ import annotations

import hashlib
from collections import Counter

import pytest

from benchmarks.bddl import metrics, run, trials
from benchmarks.bddl_corpora import BEHAVIOR, FILES, LIBERO, LIBERO_PLUS, LIBERO_PRO, corpus
from onto_compiler.bddl import format_task, lift, parse, parse_file
from onto_compiler.bddl.parse import parse_domain
from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import OntoError


@pytest.fixture(scope="module")
def files():
    """The files of a corpus, each text once; skips only where the package index is out of reach."""

    def files(name):
        try:
            _, found = corpus(name)
        except OntoError as error:
            if error.problems[0].code == "BEN003":
                pytest.skip(error.problems[0].message)
            raise
        assert len(found) == FILES[name]
        return list({hashlib.sha256(file.read_bytes()).digest(): file for file in found}.values())

    return files


@pytest.mark.parametrize(("name", "distinct"), [(LIBERO, 130), (LIBERO_PRO, 586)])
def test_installed_tasks_parse_and_print(files, name, distinct):
    found = files(name)
    assert len(found) == distinct
    for file in found:
        spec = parse_file(file)
        assert parse(format_task(spec)) == spec


def test_tasks_of_libero_plus_parse_and_two_instructions_are_a_prompts(files):
    schema = load_schema()
    found = files(LIBERO_PLUS)
    assert len(found) == 8_102
    strange = []
    # `onto bench bddl` parses all of them; here those with other instructions, and each tenth of the others.
    others = [file for file in found if "language" not in file.stem]
    for file in {*found} - {*others} | {*others[::10]}:
        spec = parse_file(file)
        if "language" in file.stem:
            strange += [p.message for p in lift(spec, schema, file.stem)[1] if p.code == "BDDL029"]
    assert len(strange) == 2
    assert all("Here are 20 variations" in message for message in strange)


def test_every_activity_of_behavior_parses_and_says_what_is_not_bound(files):
    schema = load_schema()
    found = files(BEHAVIOR)
    domains = {domain.name: dict(domain.predicates) for domain in map(parse_domain, _domains(found))}
    activities = [file for file in found if not file.name.startswith("domain_")]
    assert (len(domains), len(activities)) == (2, 1_016)
    reasons = Counter()
    for file in activities:
        spec = parse_file(file)
        assert parse(format_task(spec)) == spec
        with pytest.raises(OntoError) as caught:
            lift(spec, schema, file.stem)
        unbound = [p for p in caught.value.problems if p.code == "BDDL020"]
        assert {p.message.split("`")[1] for p in unbound} <= set(domains["omnigibson"])
        reasons.update({p.code for p in caught.value.problems if p.severity == "error"})
    # Beside the predicates: goals with too many alternatives, and quantifiers that only a scene ends.
    assert reasons == {"BDDL020": 1_016, "BDDL014": 22, "BDDL023": 14}


def _domains(files):
    return [file for file in files if file.name.startswith("domain_")]


def test_a_small_run_gives_rows_that_the_metrics_count(files):
    files(LIBERO_PLUS)
    files(BEHAVIOR)
    chosen = [trial for trial in trials(False) if trial["corpus"] in {LIBERO, BEHAVIOR}]
    assert len({trial["key"] for trial in chosen}) == len(chosen) > 20
    rows = [{**trial, **row} for trial in chosen for row in run(trial)]
    counted = metrics([*rows, {"crashed": "ValueError", "corpus": LIBERO}])
    assert counted["libero_files"] == counted["libero_lifted"] == sum(row["corpus"] == LIBERO for row in rows)
    assert counted["behavior_failed"] == counted["behavior_lifted"] == counted["libero_plus_files"] == 0
    assert counted["unbound.ontop"] == sum("ontop" in row.get("unbound", ()) for row in rows) > 0
    assert counted["crashed"] == 1


def test_a_file_that_does_not_parse_is_counted_as_failed():
    row = {"corpus": BEHAVIOR, "kind": "task", "parsed": False, "errors": ["BDDL001"]}
    counted = metrics([row])
    assert (counted["behavior_files"], counted["behavior_parsed"], counted["behavior_failed"]) == (1, 0, 1)
    assert counted["behavior_round_trip_failed"] == 1
