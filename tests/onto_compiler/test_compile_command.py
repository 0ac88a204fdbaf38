"""``onto compile`` of folders: problems on standard output, one line of summary on standard error, and an exit code."""

import json
import re
from pathlib import Path

import pytest

from onto_compiler.command import CLEAN, FINDINGS, MISUSE
from runtime.cli import main

BDDL = Path(__file__).parent / "bddl"
GOOD = BDDL / "stove_and_drawer.bddl"
SUMMARY = re.compile(r"([\d,]+) files?: ([\d,]+) compiled, ([\d,]+) failed \(([\d,]+) from cache\), \d+\.\d\d s\n")


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Run ``onto compile`` with a cache of its own: exit code, standard output, standard error."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    monkeypatch.setattr("sys.platform", "linux")

    def run(*words):
        capsys.readouterr()
        code = main(["compile", *map(str, words)])
        out, err = capsys.readouterr()
        return code, out, err

    return run


def counts(err):
    match = SUMMARY.search(err)
    assert match, err
    return tuple(map(int, match.groups()))


@pytest.fixture
def folder(tmp_path):
    """A good task, and a broken one whose problem stands in a line and column."""
    folder = tmp_path / "tasks"
    (folder / "deep").mkdir(parents=True)
    (folder / "good.bddl").write_text(GOOD.read_text())
    (folder / "deep/wrong.bddl").write_text((BDDL / "broken/unknown_predicate.bddl").read_text())
    return folder


def test_a_folder_is_compiled_and_only_its_problems_are_printed(run, folder):
    code, out, err = run(folder)
    assert code == FINDINGS
    assert re.search(rf"^error\[BDDL003\]: .*\n  --> {folder}/deep/wrong.bddl:\d+:\d+\n   \| ", out, re.MULTILINE)
    assert "good.bddl" not in out
    assert counts(err) == (2, 1, 1, 0)
    code, again, err = run(folder)
    assert (code, again, counts(err)) == (FINDINGS, out, (2, 1, 1, 2))
    (folder / "deep/wrong.bddl").unlink()
    code, out, err = run(folder)
    assert (code, out, counts(err)) == (CLEAN, "", (1, 1, 0, 1))


def test_the_cache_is_the_users_or_the_one_given_or_none(run, folder, tmp_path):
    run(folder)
    (kept,) = (tmp_path / "xdg/onto-evwm").iterdir()
    assert counts(run(folder, "--cache", tmp_path / "mine")[2])[3] == 0
    assert counts(run(folder, "--cache", tmp_path / "mine")[2])[3] == 2
    written = kept.stat().st_mtime_ns
    kept.write_text("damaged")
    code, _, err = run(folder, "--no-cache")
    assert (code, counts(err)) == (FINDINGS, (2, 1, 1, 0))
    assert kept.read_text() == "damaged"
    code, _, err = run(folder)
    assert "damaged and is built anew" in err
    assert kept.stat().st_mtime_ns > written
    assert counts(run(folder)[2])[3] == 2


def test_a_folder_that_cannot_be_written_is_a_warning(run, folder, tmp_path):
    (tmp_path / "file").write_text("")
    code, out, err = run(folder, "--cache", tmp_path / "file/cache", "--json")
    assert code == FINDINGS
    assert len(json.loads(out)["files"]) == 2
    assert err.startswith("onto compile: the cache `")
    assert "cannot be written" in err


def test_json_tells_of_each_file(run, folder):
    code, out, _ = run(folder, "--json")
    record = json.loads(out)
    assert code == FINDINGS
    assert record["summary"] == {"files": 2, "compiled": 1, "failed": 1, "cached": 0}
    wrong, good = record["files"]
    assert (wrong["file"], wrong["compiled"], wrong["facts"]) == (str(folder / "deep/wrong.bddl"), False, 0)
    assert (good["file"], good["compiled"], good["facts"]) == (str(folder / "good.bddl"), True, 2)
    assert {problem["file"] for problem in record["problems"] if problem["severity"] == "error"} == {wrong["file"]}


@pytest.mark.parametrize("name", ["sarif", "github", "junit"])
def test_reports_are_those_of_check(name, run, folder):
    code, out, err = run(folder, "--format", name)
    assert code == FINDINGS
    assert "BDDL003" in out
    assert counts(err) == (2, 1, 1, 0)
    alone = run(folder / "deep/wrong.bddl", "--format", name, "--no-cache")
    assert alone[0] == FINDINGS
    assert "BDDL003" in alone[1]


def test_workers_and_one_process_print_the_same(run):
    one = run(BDDL / "broken", "--jobs", 1, "--no-cache")
    two = run(BDDL / "broken", "--jobs", 2, "--no-cache")
    assert one[:2] == two[:2]
    assert counts(one[2])[0] == counts(two[2])[0] > 70


def test_single_files_print_their_facts_as_before(run, tmp_path):
    code, out, err = run(GOOD)
    assert (code, err) == (CLEAN, "")
    assert "must hold at the end:\n    on(akita_black_bowl_1: " in out
    assert not (tmp_path / "xdg").exists()


@pytest.mark.parametrize("jobs", ["0", "-3"])
def test_there_is_at_least_one_worker(jobs, run, folder):
    code, _, err = run(folder, f"--jobs={jobs}")
    assert code == MISUSE
    assert "error[CLI002]" in err


def test_a_folder_without_tasks_is_misuse(run, tmp_path):
    (tmp_path / "none").mkdir()
    code, out, err = run(tmp_path / "none")
    assert (code, out) == (MISUSE, "")
    assert "holds no task file" in err
