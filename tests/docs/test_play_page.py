"""docs/play.md shows what `onto play` does."""

import re
import shlex
import textwrap
from pathlib import Path

import pytest

from onto_compiler.command import CLEAN
from runtime.cli import main

pytestmark = pytest.mark.sim
ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/play.md").read_text()


def without_numbers(text):
    """Text in which no digit counts: contact may differ in its last digits between processors."""
    return re.sub(r"[+-]?\d+(\.\d+)?", "#", " ".join(text.split()))


def test_the_story_of_task_76_is_what_the_command_prints(capsys):
    ((command, story),) = re.findall(r"(?s)```console\n\$ ([^\n]+)\n(.*?)```", PAGE)
    assert main(shlex.split(command)[1:]) == CLEAN
    printed = capsys.readouterr().out
    assert without_numbers(printed) == without_numbers(story)
    assert all(len(line) <= 80 or " " not in line.strip() for line in printed.splitlines())


def test_the_trace_of_task_76_tells_the_same_story(capsys):
    trace = str(ROOT / "docs/examples/task76.trig")
    assert main(["trace", "show", "1", trace]) == CLEAN
    shown = without_numbers(capsys.readouterr().out)
    ((story,),) = [re.findall(r"(?s)```console\n\$ [^\n]+\n(.*?)  \d+ of \d+ control steps", PAGE)]
    assert shown == without_numbers(story)


def test_the_program_prints_what_the_page_shows(capsys):
    ((program, printed),) = re.findall(r"(?s)```python\n(.*?)```\n\n```text\n(.*?)```", PAGE)
    exec(compile(textwrap.dedent(program), "docs/play.md", "exec"), {})  # noqa: S102 - our own page
    assert capsys.readouterr().out == printed
