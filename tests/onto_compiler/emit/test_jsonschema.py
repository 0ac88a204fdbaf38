"""The generated JSON Schema accepts what the commands print, and nothing that the ontology excludes."""

import copy
import json
import shlex
import shutil
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from onto_compiler.command import CLEAN, FINDINGS
from onto_compiler.compiled_rows import REQUIRED_ABOX_ROW
from onto_compiler.emit.jsonschema import emit
from onto_compiler.emit.tbox import read_tbox
from runtime.cli import main
from runtime.trace.summary import episode_summary
from tests.runtime.trace.samples import accepted, all_samples, planned
from tests.strategies import SCHEMA

ROOT = Path(__file__).resolve().parents[3]
TASK = ROOT / "docs/examples/serve_the_cheese.bddl"
SERVED = ROOT / "docs/examples/served.ttl"


@pytest.fixture(scope="module")
def schema():
    return json.loads(emit(read_tbox()))


def validator(schema, definition=None):
    chosen = {"$ref": f"#/$defs/{definition}", "$defs": schema["$defs"]} if definition else schema
    return Draft202012Validator(chosen)


def plain(record):
    return json.loads(json.dumps(record))


def printed(capsys, words, *codes):
    assert main(shlex.split(words)) in codes
    return json.loads(capsys.readouterr().out)


def test_the_schema_is_one(schema):
    Draft202012Validator.check_schema(schema)
    assert len(schema["$defs"]) > 25


def test_every_recorded_episode_is_valid(schema):
    samples = (*all_samples(), planned())
    assert len(samples) >= 7
    for episode in samples:
        validator(schema, "Episode").validate(plain(episode_summary(episode, SCHEMA)))
        validator(schema).validate(plain({"tasks": [REQUIRED_ABOX_ROW.of(episode.required)], "problems": []}))


def test_what_onto_compile_prints_is_valid(schema, capsys):
    record = printed(capsys, f"compile {TASK} --ontology {SERVED} --json", CLEAN)
    assert record["tasks"][0]["facts"]
    own = json.loads(emit(read_tbox([SERVED])))
    validator(own, "Compilation").validate(record)
    assert not validator(schema, "Compilation").is_valid(record)  # its predicate is not of the shipped ontology


def test_what_onto_compile_says_of_a_folder_is_valid(schema, capsys, tmp_path):
    shutil.copy(TASK, tmp_path)
    record = printed(capsys, f"compile {tmp_path} --ontology {SERVED} --no-cache --json", CLEAN)
    assert [one["facts"] for one in record["files"]] == [1]
    validator(schema, "Batch").validate(record)
    validator(schema).validate(record)
    assert not validator(schema, "Batch").is_valid({**record, "summary": {"files": 1}})


def test_what_onto_compile_says_of_a_broken_task_is_valid(schema, capsys, tmp_path):
    (tmp_path / "broken.bddl").write_text("(define (problem p)")
    record = printed(capsys, f"compile {tmp_path / 'broken.bddl'} --json", FINDINGS)
    assert record["problems"]
    validator(schema, "Compilation").validate(record)


@pytest.mark.sim
@pytest.mark.parametrize(
    ("command", "definition"), [("ground", "Grounding"), ("diagnose", "Diagnoses"), ("repair", "Episode")]
)
def test_what_the_commands_on_a_scene_print_is_valid(command, definition, schema, capsys):
    record = printed(capsys, f"{command} libero_goal/8 --json", CLEAN, FINDINGS)
    validator(schema, definition).validate(record)
    validator(schema).validate(record)


def test_a_demonstration_is_valid(schema):
    told = [plain(episode_summary(episode, SCHEMA)) for episode in all_samples()]
    record = {"tasks": told, "accepted": 2, "settled": 1, "wall_s": 3.25}
    validator(schema, "Demonstration").validate(record)


def edit(path, value):
    """A change of one place; ``...`` takes it out."""

    def change(record):
        *way, last = path
        for key in way:
            record = record[key]
        if value is ...:
            del record[last]
        else:
            record[last] = value

    return change


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (["outcome"], "succeeded"),
        (["state"], 0.5),
        (["seed"], ...),
        (["wall_s"], 3),
        (["diagnoses", 0, "predicate"], "onn"),
        (["diagnoses", 0, "arguments"], ["plate_1"]),
        (["diagnoses", 0, "margin"], "0.1"),
        (["diagnoses", 0, "unit"], "feet"),
        (["diagnoses", 0, "source"], "real"),
        (["diagnoses", 0, "polarity"], None),
        (["history", 0, "route"], "rack_contact_site"),  # it does not admit a missing relation
        (["history", 0, "decision"], "Dispatch"),
        (["history", 0, "mode"], "torque"),
        (["history", 0, "candidate"], "first"),
        (["history", 0, "verification", "outcome"], None),
        (["history", 0, "verification", "why"], "so"),
        (["provenance"], []),
    ],
)
def test_a_mutated_episode_is_refused(path, value, schema):
    record = plain(episode_summary(accepted(), SCHEMA))
    whole = validator(schema, "Episode")
    assert whole.is_valid(copy.deepcopy(record))
    edit(path, value)(record)
    assert not whole.is_valid(record)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (["facts", 0, "arguments", 0, "type"], "Region"),  # `on` relates an object
        (["facts", 0, "arguments", 1, "type"], "Container"),
        (["facts", 0, "arguments"], []),
        (["facts", 0, "predicate"], "beside"),
        (["facts", 0, "line"], ...),
        (["language"], 7),
    ],
)
def test_a_mutated_required_abox_is_refused(path, value, schema):
    record = plain(REQUIRED_ABOX_ROW.of(accepted().required))
    whole = validator(schema, "RequiredABox")
    assert whole.is_valid(copy.deepcopy(record))
    edit(path, value)(record)
    assert not whole.is_valid(record)


def test_the_words_are_those_of_the_ontology(schema):
    words = {name: set(one["enum"]) for name, one in schema["$defs"].items() if "enum" in one}
    assert words["OutcomeWord"] >= {"accepted", "unresolved", "run_fault"}
    assert words["StatusWord"] == {"satisfied", "absent", "explicitly false", "margin violated"}
    assert words["RouteWord"] == {route.name for route in SCHEMA.routes.values()}
    assert words["PredicateWord"] == {predicate.name for predicate in SCHEMA.predicates.values()}
    assert {"m", "rad"} <= words["UnitWord"]
