"""The program of docs/notebook.md prints what the page shows, and its table lists what the module gives."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import onto_evwm

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/notebook.md").read_text()


@pytest.mark.sim
def test_the_example_prints_what_the_page_shows():
    ((program, printed),) = re.findall(r"(?s)```python\n(.*?)```\n\n```text\n(.*?)```", PAGE)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=ROOT, env=environment
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout == printed


def test_the_table_lists_every_name_of_the_module():
    named = set(re.findall(r"^\| `(\w+)", PAGE, re.MULTILINE))
    assert named == set(onto_evwm.__all__) - {"main"}
