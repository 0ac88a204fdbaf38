"""Every command that takes a query, a shape, a function, a target, a validator, a rule or an import stays at home."""

import io
import shutil
import sys

import pytest

from benchmarks.listening import listening
from benchmarks.network_calls import CALL, IMPORTING, PLACES, PREFIXES, QUERIES
from onto_compiler.command import FINDINGS, MISUSE
from runtime.cli import main


@pytest.fixture
def listener():
    """The address of a server on this machine, and the connections that were made to it."""
    with listening() as (address, made):
        yield address, made


@pytest.fixture
def put(tmp_path, monkeypatch, listener):
    monkeypatch.chdir(tmp_path)

    def write(name, text):
        (tmp_path / name).write_text(text.replace("URL", listener[0]), encoding="utf-8")
        return name

    return write


def told(capsys):
    out, err = capsys.readouterr()
    return out + err


def test_the_server_would_notice(listener):
    """Otherwise the tests below would prove nothing."""
    from pyoxigraph import Store

    url, made = listener
    with pytest.raises(OSError, match=r"."):
        list(Store().query(f"SELECT * {{ {CALL.replace('URL', url)} }}"))
    assert made


@pytest.mark.parametrize("place", PLACES)
def test_a_query_in_a_file_is_refused_by_every_command_that_reads_it(place, put, listener, capsys):
    shapes = put("shapes.ttl", f"{PREFIXES}{PLACES[place]}")
    data = put("data.ttl", f"{PREFIXES}ex:a ex:p 1 .")
    for words in (["check", data, "--shapes", shapes], ["check", shapes]):
        assert main(words) == FINDINGS
        text = told(capsys)
        assert "error[QRY001]" in text
        assert "shapes.ttl:" in text
    for words in (["docs", "--out", "site", "--ontology", shapes], ["schema", "--emit", "dense", "--ontology", shapes]):
        if main(words) != 0:
            text = told(capsys)
            assert "error[QRY001]" in text
            assert "shapes.ttl:" in text
    assert listener[1] == []


@pytest.mark.parametrize("query", QUERIES)
def test_a_query_of_a_trace_is_refused(query, put, listener, capsys, monkeypatch):
    trace = put("trace.ttl", f"{PREFIXES}ex:a ex:p 1 .")
    file = put("question.rq", f"# asks\n{query}")
    assert main(["trace", "query", file, trace]) in {FINDINGS, MISUSE}
    text = told(capsys)
    assert "error[QRY00" in text
    assert "question.rq:2:" in text
    monkeypatch.setattr(sys, "stdin", io.StringIO(query.replace("URL", listener[0])))
    assert main(["trace", "query", "-", trace]) in {FINDINGS, MISUSE}
    assert "error[QRY00" in told(capsys)
    assert listener[1] == []


def test_imports_and_contexts_are_not_fetched(put, listener, capsys):
    shapes, data, context, entity, question = (put(name, text) for name, text in IMPORTING.items())
    main(["check", data, "--shapes", shapes])
    main(["check", shapes])
    capsys.readouterr()
    for file in (context, entity):
        assert main(["check", file, "--shapes", shapes]) == FINDINGS
        assert file in told(capsys)
    shutil.copy(context, "trace.jsonld")
    assert main(["trace", "query", question, "trace.jsonld"]) != 0
    assert "trace.jsonld" in told(capsys)
    assert listener[1] == []
