"""Compiled code on disk: kept, and compiled again where what was kept is damaged or cannot be written."""

from __future__ import annotations

import importlib.util
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


@pytest.fixture
def anew(tmp_path, monkeypatch):
    """Call the function as a module that was just imported has it, with compiled code in `tmp_path`: as above."""
    from numba.core import config

    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path / "kept"))
    monkeypatch.setattr(config, "CACHE_LOCATOR_CLASSES", "UserProvidedCacheLocator")

    def run():
        spec = importlib.util.spec_from_file_location("twice", tmp_path / "twice.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module.twice(21), sum(module.twice.stats.cache_hits.values())

    return run


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
@pytest.mark.parametrize("size", [0, 20])
@pytest.mark.usefixtures("call")
def test_a_truncated_file_is_compiled_again_and_replaced(anew, tmp_path, caplog, ending, size):
    assert anew() == (42, 0)
    (path,) = (tmp_path / "kept").rglob(f"*.{ending}")
    os.truncate(path, size)
    assert anew() == (42, 0)
    assert "compiled again" in caplog.text
    caplog.clear()
    assert anew() == (42, 1)
    assert caplog.text == ""


def test_without_a_folder_each_process_compiles(call, tmp_path):
    (tmp_path / "file").write_text("")
    found, said = call(tmp_path / "file" / "kept")
    assert found == ["42", "0"]
    assert "cannot be kept" in said
