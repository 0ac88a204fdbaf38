"""``onto check`` takes task files too, alone and beside the ontology that they are written for."""

import argparse
import json
import shutil
from pathlib import Path

import pytest

from onto_compiler.check.command import CHECK
from onto_compiler.check.tasks import check_all, split
from onto_compiler.command import CLEAN, FINDINGS

ROOT = Path(__file__).resolve().parents[3]
TASK, SERVED = ROOT / "docs/examples/serve_the_cheese.bddl", ROOT / "docs/examples/served.ttl"

PACKAGE = "in_line.ttl"


def codes(capsys, *words):
    parser = argparse.ArgumentParser()
    CHECK.configure(parser)
    capsys.readouterr()
    code = CHECK.run(parser.parse_args([*map(str, words), "--json"]))
    problems = json.loads(capsys.readouterr().out)["problems"]
    return code, [(p["code"], Path(p["file"]).name, p["line"]) for p in problems]


def test_a_task_is_lifted_by_the_ontology_beside_it(capsys):
    assert codes(capsys, TASK, SERVED) == (CLEAN, [])
    code, found = codes(capsys, ROOT / "docs/examples")
    # The package `in_line` is not installed here, and the check tells what it would register.
    assert (code, {(kind, file) for kind, file, _ in found}) == (CLEAN, {("BND011", PACKAGE), ("RTE015", PACKAGE)})


def test_without_that_ontology_the_predicate_is_unknown(capsys):
    code, found = codes(capsys, TASK)
    assert code == FINDINGS
    assert [(kind, file) for kind, file, _ in found] == [("BDDL003", TASK.name)]


def test_a_folder_of_tasks_alone_needs_no_turtle(tmp_path, capsys):
    (tmp_path / "broken.bddl").write_text("(define (problem x)")
    code, found = codes(capsys, tmp_path)
    assert code == FINDINGS
    assert {file for _, file, _ in found} == {"broken.bddl"}


def test_tasks_wait_while_their_ontology_does_not_parse(tmp_path, capsys):
    shutil.copy(TASK, tmp_path)
    (tmp_path / "served.ttl").write_text(SERVED.read_text() + "oops")
    _, found = codes(capsys, tmp_path)
    assert {file for _, file, _ in found} == {"served.ttl"}


def test_a_task_that_does_not_parse_is_told_while_its_ontology_does_not_either(tmp_path, capsys):
    (tmp_path / "task.bddl").write_text("(define (problem x)")
    (tmp_path / "served.ttl").write_text(SERVED.read_text() + "oops")
    _, found = codes(capsys, tmp_path)
    assert {file for _, file, _ in found} == {"served.ttl", "task.bddl"}


def test_several_processes_find_the_same(tmp_path):
    (tmp_path / "served.ttl").write_text(SERVED.read_text())
    for number in range(33):
        text = TASK.read_text() if number % 3 else TASK.read_text().replace("(Served", "(Severed")
        (tmp_path / f"task_{number}.bddl").write_text(text if number % 5 else text[: 50 + number])
    alone = check_all([tmp_path])
    assert check_all([tmp_path], jobs=2) == alone
    assert len({problem.file for problem in alone.problems if problem.code.startswith("BDDL")}) == 15


def test_problems_of_turtle_and_tasks_come_together(tmp_path, capsys):
    (tmp_path / TASK.name).write_text(TASK.read_text().replace("(Served", "(Severed"))
    (tmp_path / "served.ttl").write_text(SERVED.read_text().replace('on."@en', 'on"@en'))
    _, found = codes(capsys, tmp_path)
    assert sorted((kind, file) for kind, file, _ in found) == [("BDDL003", TASK.name), ("DOC004", "served.ttl")]


@pytest.mark.parametrize("format_", ["sarif", "junit"])
def test_other_formats_count_the_task_files(format_, capsys):
    parser = argparse.ArgumentParser()
    CHECK.configure(parser)
    CHECK.run(parser.parse_args([str(TASK), str(SERVED), "--format", format_]))
    assert TASK.name in capsys.readouterr().out


def test_split_tells_folders_of_turtle_from_folders_of_tasks(tmp_path):
    for name in ("tasks/a.bddl", "both/b.bddl", "both/b.ttl", "empty/readme.txt"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("")
    folders = [tmp_path / name for name in ("tasks", "both", "empty")]
    turtle, tasks = split(folders)
    assert turtle == (tmp_path / "both", tmp_path / "empty"), "an empty folder is reported as such"
    assert [path.name for path in tasks] == ["a.bddl", "b.bddl"]
