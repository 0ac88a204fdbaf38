"""Compiled code on disk: kept, and compiled again where what was kept is damaged or cannot be written."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CALL = """
import logging, sys
sys.path[:0] = [sys.argv[1], sys.argv[2]]
logging.basicConfig(stream=sys.stderr, format="%(message)s")
import twice
print(twice.twice(21), sum(twice.twice.stats.cache_hits.values()))
"""


@pytest.fixture
def call(tmp_path):
    """Call a compiled function in a fresh process: what it prints (its value, hits of the cache) and logs."""
    (tmp_path / "twice.py").write_text(
        "from grounding.jit import compiled\n\n\n@compiled\ndef twice(a):\n    return 2 * a\n"
    )

    def run(folder):
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder)}
        environment["NUMBA_CACHE_LOCATOR_CLASSES"] = "UserProvidedCacheLocator"
        command = [sys.executable, "-c", CALL, str(tmp_path), str(ROOT)]
        done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
        return done.stdout.split(), done.stderr

    return run


def test_what_was_compiled_is_found_again(call, tmp_path):
    assert call(tmp_path / "kept") == (["42", "0"], "")
    assert call(tmp_path / "kept") == (["42", "1"], "")


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
@pytest.mark.parametrize("size", [0, 20])
def test_a_truncated_file_is_compiled_again_and_replaced(call, tmp_path, ending, size):
    call(tmp_path / "kept")
    (path,) = (tmp_path / "kept").rglob(f"*.{ending}")
    os.truncate(path, size)
    found, said = call(tmp_path / "kept")
    assert found == ["42", "0"]
    assert "compiled again" in said
    assert call(tmp_path / "kept") == (["42", "1"], "")


def test_without_a_folder_each_process_compiles(call, tmp_path):
    (tmp_path / "file").write_text("")
    found, said = call(tmp_path / "file" / "kept")
    assert found == ["42", "0"]
    assert "cannot be kept" in said
