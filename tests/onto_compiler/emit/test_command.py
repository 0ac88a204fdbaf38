"""``onto schema``: printing, writing, and holding the kept files fresh."""

import json
import re
import shlex
import shutil
import sys
import tomllib
from pathlib import Path

import pytest

from onto_compiler.command import CLEAN, FINDINGS, MISUSE
from onto_compiler.emit import OUTPUTS, emit
from onto_compiler.emit.tbox import read_tbox
from runtime.cli import main
from runtime.trace.summary import episode_summary
from tests.runtime.trace.samples import accepted
from tests.strategies import SCHEMA as VOCABULARY

ROOT = Path(__file__).resolve().parents[3]
TABLE = '[tool.onto.schema]\nontology = ["served.ttl"]\nshacl = "made/shapes.ttl"\npython = "predicates.py"\n'


@pytest.fixture
def project(tmp_path, monkeypatch):
    (tmp_path / "pyproject.toml").write_text(TABLE)
    shutil.copy(ROOT / "docs/examples/served.ttl", tmp_path)
    (tmp_path / "below").mkdir()
    monkeypatch.chdir(tmp_path / "below")
    return tmp_path


def test_the_files_of_this_project_are_fresh(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    assert main(["schema", "--check", "--json"]) == CLEAN
    files = json.loads(capsys.readouterr().out)["files"]
    assert [row["output"] for row in files] == list(OUTPUTS)
    assert {str(Path(row["file"]).parent) for row in files} == {"schema", "ontology/shapes"}


def test_an_output_is_printed_or_written(capsys, tmp_path):
    assert main(["schema", "--emit", "mermaid"]) == CLEAN
    text = capsys.readouterr().out
    assert text == emit("mermaid", read_tbox())
    assert main(["schema", "--emit", "mermaid", "--output", str(tmp_path / "new/page.md")]) == CLEAN
    assert (tmp_path / "new/page.md").read_text() == text
    assert capsys.readouterr().out == ""


def test_missing_fresh_and_stale_files_are_told_apart(project, capsys):
    assert main(["schema", "--check", "--json"]) == FINDINGS
    record = json.loads(capsys.readouterr().out)
    assert [row["state"] for row in record["files"]] == ["missing", "missing"]
    assert [problem["code"] for problem in record["problems"]] == ["SCH003", "SCH003"]
    assert main(["schema", "--write"]) == CLEAN
    assert main(["schema", "--check"]) == CLEAN
    assert "2 of 2 generated files were fresh" in capsys.readouterr().err
    changed = (project / "served.ttl").read_text().replace("core:domain man:Object", "core:domain man:Landmark")
    (project / "served.ttl").write_text(changed)
    assert main(["schema", "--check"]) == FINDINGS
    out = capsys.readouterr().out
    assert "error[SCH003]: `shapes.ttl` is not what the ontology generates now" in out
    assert out.count("SCH003") == 2


def hinted(capsys):
    """Follow the hints of the problems that the last command reported."""
    out = capsys.readouterr().out
    commands = set(re.findall(r"help: run `onto (.*)`", out))
    assert commands, out
    return [main(shlex.split(command)) for command in sorted(commands)]


@pytest.mark.parametrize("name", ["served.ttl", "my own.ttl"])
@pytest.mark.parametrize("spoilt", ["missing", "stale", "empty"])
def test_following_the_hint_mends_what_it_names(spoilt, name, project, capsys):
    (project / "served.ttl").rename(project / name)
    table = TABLE.replace('ontology = ["served.ttl"]\n', "") if "own" in name else TABLE
    (project / "pyproject.toml").write_text(table)
    given = ["--ontology", str(project / name)] if "own" in name else []
    main(["schema", "--write", *given])
    for file in ("made/shapes.ttl", "predicates.py"):
        if spoilt == "missing":
            (project / file).unlink()
        else:
            (project / file).write_text("" if spoilt == "empty" else (project / file).read_text() + "\n# more\n")
    capsys.readouterr()
    assert main(["schema", "--check", *given]) == FINDINGS
    assert hinted(capsys) == [CLEAN]
    assert main(["schema", "--check", *given]) == CLEAN


def test_a_generated_file_in_the_ontologys_own_folder_does_not_feed_itself(project, capsys):
    (project / "own").mkdir()
    (project / "served.ttl").rename(project / "own/served.ttl")
    (project / "pyproject.toml").write_text('[tool.onto.schema]\nontology = ["own"]\nshacl = "own/shapes.ttl"\n')
    assert main(["schema", "--check"]) == FINDINGS
    assert hinted(capsys) == [CLEAN]
    assert main(["schema", "--check"]) == CLEAN
    text = (project / "own/shapes.ttl").read_text()
    assert main(["schema", "--write"]) == CLEAN
    assert (project / "own/shapes.ttl").read_text() == text


def test_a_folder_in_the_place_of_a_file_is_named(project, capsys):
    (project / "predicates.py").mkdir()
    assert main(["schema", "--check"]) == FINDINGS
    assert "`predicates.py` is a folder" in capsys.readouterr().out


def test_a_fresh_file_is_not_written_again(project, capsys):
    main(["schema", "--write"])
    before = (project / "made/shapes.ttl").stat().st_mtime_ns
    capsys.readouterr()
    assert main(["schema", "--write"]) == CLEAN
    assert capsys.readouterr().out == ""
    assert (project / "made/shapes.ttl").stat().st_mtime_ns == before


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ("", "no table"),
        ("[tool.onto.schema]\nontology = []\n", "no table"),
        ("[tool.onto]\nschema = 3\n", "no table"),
        ("[tool]\nonto = 3\n", "cannot be read"),
        ('[tool.onto.schema]\nshackl = "a.ttl"\n', "did you mean `shacl`?"),
        ("[tool.onto.schema]\nshacl = 3\n", "is no path"),
        ('[tool.onto.schema]\nshacl = "a.ttl"\nontology = "b.ttl"\n', "is not a list of paths"),
        ("[tool.onto.schema\n", "cannot be read"),
        ('[tool.onto.schema]\nshacl = "a.ttl"\npython = "./a.ttl"\n', "names `./a.ttl`, as `shacl` does"),
        ('[tool.onto.schema]\nontology = ["a.ttl"]\nshacl = "a.ttl"\n', "names `a.ttl`, as `ontology` does"),
    ],
)
def test_a_table_that_cannot_be_used_is_a_problem(table, said, tmp_path, monkeypatch, capsys):
    (tmp_path / "pyproject.toml").write_text(table)
    monkeypatch.chdir(tmp_path)
    assert main(["schema", "--check"]) == MISUSE
    err = capsys.readouterr().err
    assert "SCH002" in err
    assert said in err


def test_a_file_that_cannot_be_written_is_a_problem(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert main(["schema", "--emit", "python", "--output", str(tmp_path / "file/below.py")]) == MISUSE
    assert "SCH004" in capsys.readouterr().err


def test_a_broken_ontology_is_a_problem(tmp_path, capsys):
    (tmp_path / "broken.ttl").write_text("ex:a a")
    assert main(["schema", "--emit", "python", "--ontology", str(tmp_path)]) == MISUSE
    assert "TTL" in capsys.readouterr().err


def test_the_page_lists_every_output_with_the_file_that_is_kept():
    kept = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["onto"]["schema"]
    page = (ROOT / "docs/schema.md").read_text()
    rows = dict(re.findall(r"^\| `(\w+)` \|.*\]\(\.\./(\S+)\) \|$", page, re.MULTILINE))
    assert rows == kept
    assert tuple(rows) == OUTPUTS


def test_the_python_of_the_page_runs(tmp_path, monkeypatch):
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / "docs/schema.md").read_text(), re.DOTALL | re.MULTILINE)
    assert len(blocks) == 2
    (tmp_path / "schema").mkdir()
    shutil.copy(ROOT / "schema/context.jsonld", tmp_path / "schema")
    shutil.copy(ROOT / "schema/predicates.py", tmp_path)
    (tmp_path / "episode.json").write_text(json.dumps(episode_summary(accepted(), VOCABULARY)))
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    spaces = [{}, {}]
    for block, space in zip(blocks, spaces, strict=True):
        exec(block, space)  # noqa: S102 - our own page
    assert len(spaces[0]["graph"]) > 20
    sys.modules.pop("predicates")
