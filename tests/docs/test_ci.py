"""The pre-commit hooks and the GitHub Action are YAML, and each of their command lines is one that `onto` takes."""

import re
import shlex
import subprocess
from pathlib import Path

import pytest

from runtime.cli.discovery import installed, load
from runtime.cli.parser import parser_of

yaml = pytest.importorskip("yaml")

ROOT = Path(__file__).resolve().parents[2]
HOOKS = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text())
ACTION = yaml.safe_load((ROOT / "action.yml").read_text())
PAGE = (ROOT / "docs/ci.md").read_text()


def git(*words):
    return subprocess.run(["git", *words], check=True, capture_output=True, text=True).stdout  # noqa: S607 - a fixed program


def parsed(line):
    program, name, *rest = shlex.split(line)
    assert program == "onto"
    return parser_of(load(name, installed())).parse_args(rest)


def test_each_hook_has_what_pre_commit_requires_and_a_command_that_exists():
    assert [hook["id"] for hook in HOOKS] == ["onto-check", "onto-fix", "onto-fmt"]
    for hook in HOOKS:
        assert {"id", "name", "entry", "language", "files"} <= hook.keys()
        assert parsed(hook["entry"] + " a.ttl").paths == [Path("a.ttl")]
        assert re.search(hook["files"], "ontology/a.ttl")
        assert not re.search(hook["files"], "ontology/a.ttl.md")


def test_the_action_is_composite_and_its_commands_exist():
    assert {"name", "description", "runs"} <= ACTION.keys()
    assert ACTION["runs"]["using"] == "composite"
    steps = ACTION["runs"]["steps"]
    lines = [step["run"] for step in steps if step.get("run", "").startswith("onto ")]
    assert len(lines) == 2
    for line in lines:
        words = re.split(r" (?:>|\|\|) ", line)[0].replace("$PATHS", "a b").replace('"$FAIL_ON"', "warning")
        options = parsed(words)
        assert options.paths == [Path("a"), Path("b")]
        assert options.format in {"github", "sarif"}
    for step in steps:
        assert ("run" in step) == ("shell" in step), "a composite step that runs something names its shell"


def test_the_action_uses_the_inputs_that_it_declares_and_never_within_a_script():
    text = (ROOT / "action.yml").read_text()
    assert set(re.findall(r"inputs\.([\w-]+)", text)) == set(ACTION["inputs"])
    for step in ACTION["runs"]["steps"]:
        assert "${{" not in step.get("run", ""), "an input in a script would be run as part of it"


def test_the_documented_workflow_gives_the_action_what_it_takes():
    (block,) = re.findall(r"(?s)```yaml\n(.*?)```", PAGE)
    _, copy, step, _ = yaml.safe_load(block)["jobs"]["check"]["steps"]
    assert step["uses"] == f"./{copy['with']['path']}"
    assert copy["with"]["path"].startswith("."), "`onto check .` passes over what is hidden"
    assert set(step["with"]) <= set(ACTION["inputs"])


def test_the_documented_script_writes_a_configuration_with_every_hook_at_one_commit(tmp_path):
    script = next(block for block in re.findall(r"(?s)```sh\n(.*?)```", PAGE) if "pre-commit" in block)
    copy = tmp_path / "onto-ev-wm"
    here = tmp_path / "mine"
    here.mkdir()
    git("init", "-q", str(copy))
    (copy / "README.md").write_text("A copy.\n")
    git("-C", str(copy), "add", ".")
    git("-C", str(copy), "-c", "user.name=A", "-c", "user.email=a@example.org", "commit", "-q", "-m", "Begin")
    git("-C", str(copy), "update-ref", "refs/remotes/origin/HEAD", "HEAD")  # as a clone has it, too
    subprocess.run(["/bin/sh", "-euc", script], cwd=here, check=True)
    (source,) = yaml.safe_load((here / ".pre-commit-config.yaml").read_text())["repos"]
    assert source["repo"] == "../onto-ev-wm"
    assert source["rev"] == git("-C", str(copy), "rev-parse", "HEAD").strip()
    assert {hook["id"] for hook in source["hooks"]} == {hook["id"] for hook in HOOKS}


def test_the_documented_commands_exist():
    commands = re.findall(r"(?m)^\$ (onto .*?)(?: >|$)", PAGE)
    assert len(commands) == 1
    for command in commands:
        parsed(command)
