"""The pre-commit hooks and the GitHub Action are YAML, and each of their command lines is one that `onto` takes."""

import re
import shlex
from pathlib import Path

import pytest

from runtime.cli.discovery import installed, load
from runtime.cli.parser import parser_of

yaml = pytest.importorskip("yaml")

ROOT = Path(__file__).resolve().parents[2]
HOOKS = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text())
ACTION = yaml.safe_load((ROOT / "action.yml").read_text())
PAGE = (ROOT / "docs/ci.md").read_text()


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
    blocks = [yaml.safe_load(block) for block in re.findall(r"(?s)```yaml\n(.*?)```", PAGE)]
    workflow, hooks = blocks
    step = workflow["jobs"]["check"]["steps"][1]
    assert set(step["with"]) <= set(ACTION["inputs"])
    assert {hook["id"] for hook in hooks["repos"][0]["hooks"]} == {hook["id"] for hook in HOOKS}


def test_the_documented_commands_exist():
    commands = re.findall(r"(?m)^\$ (onto .*?)(?: >|$)", PAGE)
    assert len(commands) == 1
    for command in commands:
        parsed(command)
