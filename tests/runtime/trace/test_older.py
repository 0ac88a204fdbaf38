"""Traces of former versions read as they were recorded, or are refused with one sentence."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

from onto_compiler.problems import OntoError
from onto_compiler.required import NativeAtom
from runtime.cli import main
from runtime.trace.store import open_trace

ROOT = Path(__file__).resolve().parents[3]
TASK_76 = ROOT / "docs/examples/task76.trig"
CADDY = "study_table_desk_caddy_right_region"


def test_a_trace_whose_vectors_and_settings_are_json_reads_whole():
    text = TASK_76.read_text(encoding="utf-8")
    assert 'trace:qpos "[' in text  # it is of a former version, and stays so
    trace = open_trace(TASK_76)
    (iri,) = trace.episodes()
    episode = trace.episode(iri)
    assert (episode.suite, episode.state_index, episode.seed, episode.trial, episode.tags) == ("libero_90", 0, 0, 0, ())
    (fact,) = episode.required.facts
    assert fact.native == NativeAtom("On", ("white_yellow_mug_1", CADDY))
    assert (fact.span.line, fact.span.column) == (85, 10)
    assert [attempt.application.mode for attempt in episode.attempts] == ["controller", "controller"]
    assert all(attempt.application.proposal.qpos.shape == (0,) for attempt in episode.attempts)
    assert dict(episode.provenance)["mujoco"] == "3.3.7"


def test_a_former_vector_reads_as_its_numbers(tmp_path):
    older = TASK_76.read_text(encoding="utf-8").replace('trace:qpos "[]"', 'trace:qpos "[0.5, -0.0, 1e300]"')
    older = older.replace('trace:changed "[]"', 'trace:changed "[3, 7]"')
    (tmp_path / "trace.trig").write_text(older, encoding="utf-8")
    trace = open_trace(tmp_path / "trace.trig")
    proposal = trace.episode(trace.episodes()[0]).attempts[0].application.proposal
    assert proposal.qpos.tobytes() == np.array([0.5, -0.0, 1e300]).tobytes()
    assert proposal.changed == (3, 7)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("trace:selected ", "trace:chosenRoute "),
        ("trace:requires ", "trace:asks "),
        ("a trace:Attempt ", "a trace:Turn "),
        ("trace:stateIndex ", "trace:initialState "),
        ("trace:mode ", "trace:manner "),
    ],
)
@pytest.mark.parametrize("words", [("show", "1"), ("explain", "1"), ("list",)], ids=lambda words: words[0])
def test_a_trace_of_another_vocabulary_is_refused_with_one_sentence(tmp_path, capsys, old, new, words):
    text = TASK_76.read_text(encoding="utf-8")
    assert old in text
    file = tmp_path / "trace.trig.gz"
    file.write_bytes(gzip.compress(text.replace(old, new).encode()))
    code = main(["trace", *words, str(file)])
    out, err = capsys.readouterr()
    if words[0] == "list":
        assert code == 0  # the list tells what it finds
        assert "1 episode" in err
    else:
        assert (code, out) == (2, "")
        assert err.count("error[") == 1
        assert f"`{new.split()[-1]}`" in err
        assert "Traceback" not in err


def test_a_stated_version_is_named(tmp_path):
    text = TASK_76.read_text(encoding="utf-8").replace("trace:premiseHolds true ;", "")
    text = text.replace("run:play a trace:Run", "run:play dcterms:conformsTo <urn:elder> ; a trace:Run")
    file = tmp_path / "trace.trig"
    file.write_text(text, encoding="utf-8")
    trace = open_trace(file)
    with pytest.raises(OntoError) as caught:
        trace.episode(trace.episodes()[0])
    (problem,) = caught.value.problems
    assert problem.code == "TRC007"
    assert "<urn:elder>" in problem.message
    assert "lacks `trace:premiseHolds`" in problem.message
