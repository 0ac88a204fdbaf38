"""`onto plan`: trials are played by the row that was asked for, told, recorded and drawn."""

from __future__ import annotations

import json

import pytest
import torch

from onto_compiler.command import CLEAN, FINDINGS, MISUSE
from onto_compiler.problems import OntoError
from onto_compiler.schema import local_name
from runtime.cli import main
from runtime.planning.cem import Budget
from runtime.trace.store import open_trace
from runtime.worlds.pointmaze.maze import MACRO_STEPS
from runtime.worlds.pointmaze.planning import rows
from runtime.worlds.pointmaze.planning.mpc import play
from runtime.worlds.pointmaze.planning.playing import generator, numbers
from runtime.worlds.pointmaze.trials import trial
from tests.runtime.planning.models import write_model

pytestmark = pytest.mark.sim


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    return str(write_model(tmp_path_factory.mktemp("model")))


@pytest.fixture
def quick(monkeypatch):
    """Rows of the same kinds with budgets that take no time."""
    small = Budget(30, 6, 2)
    known = {
        name: rows.PlannerRow(row.score, row.sensed, small, row.after, row.truth) for name, row in rows.ROWS.items()
    }
    monkeypatch.setattr(rows, "ROWS", known)
    monkeypatch.setattr("runtime.worlds.pointmaze.planning.playing.ROWS", known)
    monkeypatch.setattr(rows, "ALLOWANCE", 100)


def plan(capsys, *words):
    code = main(["plan", "pointmaze", *words])
    return code, capsys.readouterr()


@pytest.mark.parametrize(
    ("text", "expected"),
    [("7", (7,)), ("0-3", (0, 1, 2, 3)), ("8,2-3", (8, 2, 3)), ("2,1-2", (2, 1)), ("4-4", (4,))],
)
def test_numbers_and_ranges_name_trials(text, expected):
    assert numbers(text) == expected


@pytest.mark.parametrize("text", ["", "a", "3-", "5-2", "-1", "1;2", "0-99999999"])
def test_what_names_no_trials_is_refused(text):
    with pytest.raises(OntoError) as caught:
        numbers(text)
    assert caught.value.problems[0].code == "PMZ005"


def test_a_trial_is_played_with_the_published_random_numbers(capsys):
    code, printed = plan(capsys, "--row", "random", "--trials", "3,5", "--format", "json")
    told = json.loads(printed.out)["rows"][0]
    for row in told["trials"]:
        random = torch.Generator().manual_seed(3 * row["trial"])
        played = play(trial(row["trial"]), rows.planner("random", None), rows.maze_rollout(), random, MACRO_STEPS)
        assert row["distance"] == float(played.steps[-1].verdict.distance)
        assert (row["success"], row["plans"]) == (played.success, len(played.steps))
    assert code == (CLEAN if all(row["success"] for row in told["trials"]) else FINDINGS)
    assert told["summary"]["trials"] == 2
    assert generator(5, 2).initial_seed() == 17


def test_text_has_a_line_for_each_trial_and_fits_80_columns(capsys, quick, model):
    code, printed = plan(capsys, "--row", "onto", "random", "--trials", "3-4", "--model", model)
    lines = printed.out.splitlines()
    assert [line.split()[0] for line in lines if line[:7].strip().isdecimal()] == ["3", "4", "3", "4"]
    assert "onto, which sees predicted" in lines
    assert code == FINDINGS
    assert max(map(len, lines)) <= 90  # names of three facts at the most


def test_a_guided_trial_is_recorded_with_both_aboxes_and_its_routes(capsys, quick, model, tmp_path):
    file, picture = tmp_path / "t.trig", tmp_path / "t.html"
    words = ["--row", "search", "--trials", "3", "--model", model, "--trace", str(file), "--picture", str(picture)]
    plan(capsys, *words)
    trace = open_trace(file)
    (iri,) = trace.episodes()
    episode = trace.episode(iri)
    assert (episode.suite, episode.state_index, dict(episode.provenance)["row"]) == ("pointmaze", 3, "search")
    assert len(episode.plans) == 4
    assert {p.predicted.source for p in episode.plans} == {"pred"}
    assert {p.simulated.source for p in episode.plans} == {"sim"}
    assert [p.simulated.step for p in episode.plans] == [25, 50, 75, 100]
    assert len(episode.attempts) >= 4
    assert {attempt.selected.level for attempt in episode.attempts} == {"plan"}
    assert all(a.application is None or a.application.mode == "none" for a in episode.attempts)
    assert all(p.verification.outcome == bool(p.simulated.truth[0]) for p in episode.plans)
    assert main(["trace", "show", "1", str(file)]) == CLEAN
    shown = capsys.readouterr().out
    assert "Plan 4" in shown
    assert all(len(line) <= 80 for line in shown.splitlines())
    assert picture.read_text().count('class="maze"') == 1


def test_what_a_robot_does_not_sense_is_neither_predicted_nor_searched_for(capsys, quick, model, tmp_path):
    file, picture = tmp_path / "t.trig", tmp_path / "t.html"
    words = ["--row", "search_blind", "--trials", "3", "--model", model, "--trace", str(file)]
    _, printed = plan(capsys, *words, "--picture", str(picture))
    assert "velocity_matches (not observed)" in printed.out
    trace = open_trace(file)
    episode = trace.episode(*trace.episodes())
    for made in episode.plans:
        assert made.predicted.observed.tolist() == [True, False, True]
        assert made.simulated.observed.all()
        assert [local_name(each.status) for each in made.diagnoses if each.index == 1] == ["Absent"]
    assert len(episode.attempts) >= 4
    assert {attempt.selected.diagnosis.index for attempt in episode.attempts} <= {0, 2}
    assert main(["trace", "show", "1", str(file)]) == CLEAN
    assert "there is no evidence" in " ".join(capsys.readouterr().out.split())
    drawn = picture.read_text()
    assert "velocity_matches(ball, target), predicted margins: not observed" in drawn
    assert "nan" not in drawn


@pytest.mark.parametrize(
    ("words", "code", "hint"),
    [
        (["--row", "onnto"], "PMZ008", "did you mean `onto`?"),
        (["--trials", "5-2"], "PMZ005", "give numbers or ranges"),
        (["--seed", "9"], "PMZ008", "name a --model"),
        (["--model", "nowhere"], "WM001", "onto train pointmaze --seed 0"),
        (["--row", "random", "--trace", "trace.txt"], "TRC001", "end its name in .trig"),
        (["--row", "random", "--picture", "a.gif"], "TRC001", "end its name in .html"),
    ],
)
def test_a_mistake_is_told_before_anything_is_played(capsys, tmp_path, monkeypatch, words, code, hint):
    monkeypatch.chdir(tmp_path)
    status, printed = plan(capsys, *words)
    assert (status, printed.out) == (MISUSE, "")
    assert f"error[{code}]" in printed.err
    assert hint in printed.err
    assert list(tmp_path.iterdir()) == []
