"""A batch finds of each file what compiling it alone finds, whatever the cache holds and whoever else writes it."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from onto_compiler import batch as module
from onto_compiler.batch import compile_files, task_files
from onto_compiler.bddl import lift, parse_file
from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import OntoError
from onto_compiler.validator.records import record_validator

BDDL = Path(__file__).parent / "bddl"
GOOD = (BDDL / "stove_and_drawer.bddl").read_text()
WRONG = GOOD.replace("(On akita_black_bowl_1 flat_stove_1_cook_region)", "(Onn akita_black_bowl_1 plate_1)")
STRICT = """@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix core: <https://w3id.org/onto-evwm/core#> .
@prefix shape: <https://w3id.org/onto-evwm/shapes#> .
@prefix my: <https://example.org/my#> .
my:NoStove a sh:NodeShape ; sh:targetClass core:RequiredFact ; shape:code "SHP001" ;
    sh:property [ sh:path core:nativeAtom ; sh:pattern "^(?!.*stove)" ; sh:message "is about the stove" ] .
"""


@pytest.fixture
def tasks(tmp_path):
    """Three good files and a broken one, at three depths."""
    for name in ("one", "a/two", "a/b/three"):
        path = tmp_path / "tasks" / f"{name}.bddl"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(GOOD)
    (tmp_path / "tasks/a/wrong.bddl").write_text(WRONG)
    (tmp_path / "tasks/a/notes.txt").write_text("no task")
    return tmp_path / "tasks"


def found(batch):
    return {file: replace(verdict, cached=False) for file, verdict in batch.verdicts.items()}


def test_a_folder_stands_for_every_task_below_it(tasks):
    files = task_files([tasks, tasks / "one.bddl"])
    assert [file.relative_to(tasks).as_posix() for file in files] == [
        "a/b/three.bddl",
        "a/two.bddl",
        "a/wrong.bddl",
        "one.bddl",
    ]
    (tasks / "empty").mkdir()
    with pytest.raises(OntoError, match="holds no task file") as caught:
        task_files([tasks, tasks / "empty"])
    assert [problem.code for problem in caught.value.problems] == ["BDDL004"]


def test_each_problem_stands_at_its_place(tasks):
    result = compile_files(task_files([tasks]))
    assert result.summary == {"files": 4, "compiled": 3, "failed": 1, "cached": 0}
    (problem,) = (one for one in result.problems if one.severity == "error")
    line = next(number for number, text in enumerate(WRONG.splitlines(), 1) if "(Onn" in text)
    assert (problem.file, problem.line, problem.column) == (str(tasks / "a/wrong.bddl"), line, 8)
    assert problem.code == "BDDL003"


def alone(file, schema):
    """How many facts ``file`` lifts to by itself, and its problems."""
    try:
        abox, warnings = lift(parse_file(file), schema, file.stem)
    except OntoError as error:
        return 0, error.problems
    return len(abox.facts), tuple(sorted(set(warnings)))


def test_a_broken_corpus_gives_what_each_file_gives_alone(tmp_path):
    files = task_files([BDDL / "broken"])
    assert len(files) > 70
    schema = load_schema()
    expected = {file: alone(file, schema) for file in files}
    for cached in (0, len(files)):
        result = compile_files(files, cache=tmp_path)
        assert result.summary["cached"] == cached
        assert {file: (one.facts, one.problems) for file, one in result.verdicts.items()} == expected


def test_what_is_not_text_is_a_problem_and_the_rest_is_compiled(tasks, tmp_path):
    (tasks / "bytes.bddl").write_bytes(b"(define \xff")
    (tasks / "loose.bddl").symlink_to(tmp_path / "nowhere.bddl")
    result = compile_files(task_files([tasks]))
    assert result.summary == {"files": 6, "compiled": 3, "failed": 3, "cached": 0}
    codes = {Path(p.file).name: (p.code, p.line) for p in result.problems if p.code == "BDDL004"}
    assert codes == {"bytes.bddl": ("BDDL004", 1), "loose.bddl": ("BDDL004", 0)}


def test_only_what_changed_is_compiled_again(tasks, tmp_path):
    cold = compile_files(task_files([tasks]), cache=tmp_path / "cache")
    warm = compile_files(task_files([tasks]), cache=tmp_path / "cache")
    assert (cold.summary["cached"], warm.summary["cached"]) == (0, 4)
    assert found(warm) == found(cold)
    (tasks / "a/wrong.bddl").write_text(GOOD)
    (tasks / "one.bddl").rename(tasks / "other.bddl")
    after = compile_files(task_files([tasks]), cache=tmp_path / "cache")
    assert {file.name for file, verdict in after.verdicts.items() if verdict.cached} == {"two.bddl", "three.bddl"}
    assert after.summary["failed"] == 0


def test_another_ontology_gives_another_verdict_and_the_first_one_is_still_known(tasks, tmp_path):
    mine = tmp_path / "mine.ttl"
    mine.write_text(STRICT)
    files = (tasks / "one.bddl",)
    for cached in (False, True):
        plain = compile_files(files, cache=tmp_path / "cache")
        strict = compile_files(files, [mine], cache=tmp_path / "cache")
        assert [plain.verdicts[files[0]].cached, strict.verdicts[files[0]].cached] == [cached, cached]
        assert plain.summary["failed"] == 0
        (problem,) = (one for one in strict.problems if one.severity == "error")
        line, column = next((n, t.index("(On ") + 1) for n, t in enumerate(GOOD.splitlines(), 1) if "cook_region)" in t)
        assert (problem.code, problem.line, problem.column) == ("SHP001", line, column)
        assert problem.message.startswith("`on(akita_black_bowl_1, flat_stove_1_cook_region)` is about the stove")
    mine.write_text(STRICT.replace("stove)", "nothing)"))
    relaxed = compile_files(files, [mine], cache=tmp_path / "cache")
    assert relaxed.summary == {"files": 1, "compiled": 1, "failed": 0, "cached": 0}


def test_an_ontology_that_changes_meanwhile_leaves_no_verdict(tasks, tmp_path, monkeypatch):
    mine = tmp_path / "mine.ttl"
    mine.write_text(STRICT)
    judge = module._judge

    def judge_while_it_is_edited(*arguments):
        mine.write_text(STRICT + "# edited\n")
        return judge(*arguments)

    monkeypatch.setattr(module, "_judge", judge_while_it_is_edited)
    compile_files(task_files([tasks]), [mine], cache=tmp_path / "cache")
    assert not (tmp_path / "cache").exists()


def test_what_was_compiled_before_an_interruption_is_kept(tasks, tmp_path, monkeypatch):
    judge = module._judge

    def interrupted(file, *arguments):
        if file.endswith("one.bddl"):  # the last of them
            raise KeyboardInterrupt
        return judge(file, *arguments)

    monkeypatch.setattr(module, "CHUNK", 1)
    monkeypatch.setattr(module, "_judge", interrupted)
    with pytest.raises(KeyboardInterrupt):
        compile_files(task_files([tasks]), cache=tmp_path / "cache")
    monkeypatch.undo()
    assert compile_files(task_files([tasks]), cache=tmp_path / "cache").summary["cached"] == 3


def test_workers_find_what_one_process_finds(tasks, monkeypatch):
    monkeypatch.setattr(module, "CHUNK", 2)
    files = task_files([tasks])
    assert compile_files(files, jobs=2) == compile_files(files, jobs=1)


def test_an_ontology_that_does_not_load_is_told_from_a_worker_too(tasks, tmp_path, monkeypatch):
    monkeypatch.setattr(module, "CHUNK", 2)
    (tmp_path / "bad.ttl").write_text("this is no Turtle")
    for jobs in (1, 2):
        with pytest.raises(OntoError) as caught:
            compile_files(task_files([tasks]), [tmp_path / "bad.ttl"], jobs=jobs, cache=tmp_path / "cache")
        assert caught.value.problems[0].code.startswith("TTL")
    assert not (tmp_path / "cache").exists()


def test_a_folder_that_cannot_be_written_is_a_remark(tasks, tmp_path):
    (tmp_path / "file").write_text("no folder")
    result = compile_files(task_files([tasks]), cache=tmp_path / "file" / "cache")
    assert len(result.remarks) == 1
    assert "cannot be written" in result.remarks[0]
    assert found(result) == found(compile_files(task_files([tasks])))


def test_a_damaged_cache_is_built_anew(tasks, tmp_path):
    cold = compile_files(task_files([tasks]), cache=tmp_path / "cache")
    (kept,) = (tmp_path / "cache").iterdir()
    kept.write_bytes(kept.read_bytes()[:-40])
    again = compile_files(task_files([tasks]), cache=tmp_path / "cache")
    assert ("damaged" in again.remarks[0], again.summary["cached"]) == (True, 0)
    assert found(again) == found(cold)
    assert compile_files(task_files([tasks]), cache=tmp_path / "cache").summary["cached"] == 4


def test_processes_that_fill_a_cache_at_once_do_no_harm(tasks, tmp_path):
    code = """if True:
        import sys
        from onto_compiler.batch import compile_files, task_files
        from pathlib import Path
        files = task_files(sys.argv[2:])
        for round in range(8):
            result = compile_files(files[round % 2 :], cache=Path(sys.argv[1]))
            assert not result.remarks, result.remarks
            assert [v.compiled for v in result.verdicts.values()] == [f.stem != 'wrong' for f in files[round % 2 :]]
    """
    words = [sys.executable, "-c", code, tmp_path / "cache", tasks]
    running = [subprocess.Popen([*map(str, words)], stderr=subprocess.PIPE) for _ in range(3)]
    assert [(one.communicate(timeout=120)[1], one.returncode) for one in running] == [(b"", 0)] * 3
    assert [path.suffix for path in (tmp_path / "cache").iterdir()] == [".json"]
    assert compile_files(task_files([tasks]), cache=tmp_path / "cache").summary["cached"] == 4


def test_a_name_of_two_types_is_a_problem(tasks):
    schema, file = load_schema(), tasks / "one.bddl"
    abox, _ = lift(parse_file(file), schema, "one")
    fact = abox.facts[0]
    other = replace(fact, arguments=(replace(fact.arguments[0], type="https://example.org/Other"), fact.arguments[1]))
    (problem,) = module._violations(replace(abox, facts=(fact, other)), schema, record_validator())
    assert (problem.code, problem.file) == ("ABX004", str(file))
    assert "is both a" in problem.message
