"""Episodes go to a file and back without a store."""

import pytest

from onto_compiler.problems import OntoError
from runtime.trace.file import write_trace
from runtime.trace.store import open_trace
from tests.runtime.trace.plain import plain
from tests.runtime.trace.samples import SCHEMA, planned


def test_a_trace_that_is_packed_reads_back_and_another_ending_is_refused(tmp_path):
    path = tmp_path / "trace.nq.gz"
    write_trace(path, [("run", [planned()])], SCHEMA)
    trace = open_trace(path)
    assert plain(trace.episode(*trace.episodes())) == plain(planned())
    with pytest.raises(OntoError) as caught:
        write_trace(tmp_path / "trace.ttl", [], SCHEMA)
    assert caught.value.problems[0].code == "TRC001"
