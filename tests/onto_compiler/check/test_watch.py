"""``onto check --watch`` checks again when a file changes, and ends quietly."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from onto_compiler.check.watch import changes

ROOT = Path(__file__).resolve().parents[3]


def test_a_change_a_new_file_and_a_removed_one_are_seen(tmp_path):
    first = tmp_path / "a.ttl"
    first.write_text("")
    steps = iter(
        [
            lambda: None,
            lambda: first.write_text("<a:b> <a:c> <a:d> ."),
            lambda: (tmp_path / "notes.txt").write_text("no ontology"),
            lambda: (tmp_path / "b.bddl").write_text(""),
            first.unlink,
        ]
    )
    seen = changes([tmp_path], wait=lambda _: next(steps)())
    assert next(seen) == ()
    assert next(seen) == (first,)
    assert next(seen) == (tmp_path / "b.bddl",)
    assert next(seen) == (first,)


def test_files_may_be_added_while_watching(tmp_path):
    first, later = tmp_path / "a.ttl", tmp_path / "catalog-v001.xml"
    first.write_text("")
    steps = iter([lambda: None, lambda: later.write_text("<catalog/>"), later.unlink])
    watched = [first]
    seen = changes(watched, wait=lambda _: next(steps)())
    assert next(seen) == ()
    watched.append(later)
    assert next(seen) == (later,)
    assert next(seen) == (later,)


def test_ctrl_c_ends_it_without_a_traceback(tmp_path):
    path = tmp_path / "x.ttl"
    path.write_text("<https://e.org/a> <https://e.org/b> <https://e.org/c> .\n")
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    # A shell that runs the tests in the background lets its children ignore SIGINT.
    hear = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    program = f"{hear}import sys; from runtime.cli import main; sys.exit(main(sys.argv[1:]))"
    process = subprocess.Popen(
        [sys.executable, "-c", program, "check", str(path), "--watch"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    )
    try:
        said = [process.stderr.readline() for _ in range(2)]
        assert said[-1] == "watching; Ctrl-C ends\n"
        time.sleep(0.1)
        path.write_text("oops\n")
        said = [process.stderr.readline() for _ in range(4)]
        assert said[1].endswith("x.ttl changed\n")
        assert said[2] == "1 problem (1 error) in 1 file\n"
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=20)
    finally:
        process.kill()
    assert "TTL" in out
    assert "Traceback" not in err
    assert process.returncode == 1
