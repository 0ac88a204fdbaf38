"""A long check shows a bar at a terminal, and nothing anywhere else."""

import io
import time

from onto_compiler.check.model import load_model
from onto_compiler.check.progress import progress, silent
from onto_compiler.check.run import check_model


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_a_long_check_shows_what_it_does_at_a_terminal():
    stream = Terminal()
    with progress(stream, patience=0) as step:
        step("domains and ranges", 2, 12)
        end = time.monotonic() + 30
        while "domains and ranges" not in stream.getvalue() and time.monotonic() < end:
            time.sleep(0.02)
    assert "domains and ranges" in stream.getvalue()


def test_a_short_check_shows_nothing():
    stream = Terminal()
    with progress(stream, patience=60) as step:
        step("rules", 1, 12)
    assert stream.getvalue() == ""


def test_nothing_is_shown_where_nobody_looks_on():
    stream = io.StringIO()
    with progress(stream, patience=0) as step:
        assert step is silent
    assert stream.getvalue() == ""


def test_every_part_of_a_check_is_named_in_its_order(tmp_path):
    path = tmp_path / "x.ttl"
    path.write_text("<#a> a <http://www.w3.org/2002/07/owl#Klass> .\n")
    steps = []
    check_model(load_model([path]), step=lambda *step: steps.append(step))
    assert [done for _, done, _ in steps] == list(range(steps[0][2]))
    assert steps[-1][0] == "lines and columns"
    assert len({doing for doing, _, _ in steps}) == len(steps)
