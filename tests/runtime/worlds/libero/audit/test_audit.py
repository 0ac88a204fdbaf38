"""A scene is audited from its official initial states, and what was audited is not audited again."""

from __future__ import annotations

import json

import pytest

from runtime.cli import main

pytestmark = pytest.mark.sim


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(scope="module")
def first(cache):
    """Two states of the task whose bowl leans on a ramekin."""
    out = cache / "first.json"
    assert audit(cache, out, 2) == 1
    return json.loads(out.read_text())


def audit(cache, out, states):
    return main(["audit", "libero_spatial", "5", "--states", str(states), "--cache", str(cache), "--out", str(out)])


def test_the_bowl_settles_on_the_ramekin_and_leans(first):
    (task,) = first["tasks"]
    assert (task["available"], len(task["states"]), task["faults"]) == (50, 2, [])
    for state in task["states"]:
        assert {(f["kind"], f["subject"]) for f in state["failures"]} == {
            ("displaced", "akita_black_bowl_1"),
            ("tipped", "akita_black_bowl_1"),
        }
        facts = state["readings"]["initial_fact"]
        assert len(facts) == 7  # all that :init declares, regions included
        assert facts["on(akita_black_bowl_1, glazed_rim_porcelain_ramekin_1)"] >= 0
        assert 0.1 < state["readings"]["fall"]["akita_black_bowl_2"] < 0.25  # it only drops


def test_known_states_are_not_audited_again(first, cache, monkeypatch):
    from runtime.worlds.libero.audit import fan_out

    again = cache / "again.json"
    with monkeypatch.context() as patched:
        patched.setattr(fan_out, "audit_task", lambda *_: pytest.fail("it is known"))
        assert audit(cache, again, 1) == 1
    assert json.loads(again.read_text())["tasks"][0]["states"] == first["tasks"][0]["states"][:1]


def test_a_damaged_kept_audit_is_made_anew(first, cache):
    (kept,) = (cache / "audits").glob("*.json")
    kept.write_text(kept.read_text()[:-40])
    again = cache / "anew.json"
    assert audit(cache, again, 2) == 1
    assert json.loads(again.read_text())["tasks"] == first["tasks"]


def test_another_asset_makes_it_another_audit(tmp_path, monkeypatch):
    from runtime.worlds.libero.audit import cache as kept
    from runtime.worlds.libero.simulator.assets import find_task

    ref, asset = find_task("libero_spatial", 5), tmp_path / "plate.xml"
    monkeypatch.setattr(kept, "asset_folders", lambda: (tmp_path,))
    paths = []
    for text in ("<a/>", "<a/>", "<aa/>"):
        if not (asset.exists() and asset.read_text() == text):
            asset.write_text(text)
        kept._assets.cache_clear()
        paths.append(kept.AuditCache(tmp_path, (), 0)._path(ref))
    kept._assets.cache_clear()
    assert paths[0] == paths[1] != paths[2]


def test_a_cache_that_cannot_be_written_is_told_once(tmp_path, caplog):
    blocked = tmp_path / "file"
    blocked.write_text("")
    arguments = ["audit", "libero_spatial", "5", "--states", "1", "--jobs", "1", "--cache", str(blocked)]
    assert main(arguments) == 1
    (told,) = caplog.messages
    assert told.startswith(f"the audit cannot be kept in {blocked / 'audits'}: ")


def test_a_task_without_a_scene_is_a_finding(tmp_path, capsys):
    path = tmp_path / "no_such.bddl"
    path.write_text(
        "(define (problem no_such_problem) (:domain robosuite) (:language do it)\n"
        "(:regions) (:fixtures table - table) (:objects plate_1 - plate) (:obj_of_interest plate_1)\n"
        "(:init (On plate_1 table)) (:goal (And (On plate_1 table))))\n"
    )
    assert main(["audit", str(path), "--no-cache"]) == 1
    out = capsys.readouterr().out
    assert "no_such" in out
    assert "1 task with something that could not be audited" in out


@pytest.mark.parametrize("quote", ["`", "'", " "])
def test_a_fault_says_nothing_of_where_packages_are_installed(quote):
    from runtime.worlds.libero.audit.task import LONGEST, plain

    assert plain(f"the file {quote}/home/me/env/lib/site-packages/libero/a.xml{quote}\n is   missing") == (
        f"the file {quote}libero/a.xml{quote} is missing".replace("  ", " ")
    )
    assert len(plain("array " * 1000)) < LONGEST
