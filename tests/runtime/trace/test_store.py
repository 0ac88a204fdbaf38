"""The store on disk: whole episodes or nothing, resumable, readable while it is written, repeatable in its export."""

from __future__ import annotations

import gzip
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from pyoxigraph import NamedNode, RdfFormat

from onto_compiler.problems import OntoError
from runtime.loop.records import GIVEN, state_digest
from runtime.trace import admission
from runtime.trace import store as module
from runtime.trace.store import TraceStore, dump, newest_trace, open_trace
from tests.runtime.trace import samples
from tests.runtime.trace.plain import plain

RUN = "test"


def filled(path, episodes=None):
    with TraceStore(path, samples.SCHEMA, RUN) as store:
        for episode in episodes or samples.all_samples():
            store.add(episode)
    return path


def code_of(error):
    (problem,) = error.value.problems
    assert problem.hint
    return problem.code


def test_what_was_added_is_there_after_reopening(tmp_path):
    filled(tmp_path / "store")
    trace = open_trace(tmp_path / "store")
    found = [plain(trace.episode(iri)) for iri in trace.episodes()]
    assert len(found) == 6
    assert sorted(found) == sorted(map(plain, samples.all_samples()))


def test_has_knows_exactly_the_recorded_episodes(tmp_path):
    with TraceStore(tmp_path / "store", samples.SCHEMA, RUN) as store:
        episode = samples.accepted()
        key = (episode.suite, episode.task, episode.state_index, episode.seed)
        assert not store.has(*key)
        store.add(episode)
        assert store.has(*key)
        assert not store.has(episode.suite, episode.task, 1, episode.seed)
        assert not store.has(*key[:3], seed=episode.seed + 1)
        assert not store.has(*key, trial=1)
        assert not store.has(*key, tags=[("light", "dim")])
    with TraceStore(tmp_path / "store", samples.SCHEMA, "other") as store:
        assert not store.has(*key)


def test_what_came_out_differently_stands_beside_what_was_recorded(tmp_path):
    shorter = replace(samples.accepted(), attempts=(), outcome="unresolved")
    with TraceStore(tmp_path / "store", samples.SCHEMA, RUN) as store:
        first = store.add(samples.accepted())
        second = store.add(shorter)
        assert (first, second) == store.episodes()
        assert plain(store.episode(first)) == plain(samples.accepted())
        assert plain(store.episode(second)) == plain(replace(shorter, trial=1))


def test_a_resumed_run_does_not_duplicate_what_it_records_again(tmp_path):
    for _ in range(2):
        with TraceStore(tmp_path / "store", samples.SCHEMA, RUN) as store:
            iris = [store.add(episode) for episode in samples.all_samples()]
            before = len(store._store)
            assert [store.add(episode) for episode in samples.all_samples()] == iris
            assert len(store._store) == before
            assert set(iris) == set(store.episodes())
    again = replace(samples.accepted(), outcome="unresolved")
    with TraceStore(tmp_path / "store", samples.SCHEMA, RUN) as store:
        assert store.add(again) == store.add(again)
        assert len(store.episodes()) == len(iris) + 1


@pytest.mark.parametrize(
    "changes",
    [{"seed": 8}, {"state_index": 1}, {"state_index": -1, "given": "0123456789ab"}, {"tags": (("light", "dim"),)}],
    ids=lambda changes: next(iter(changes)),
)
def test_episodes_of_other_names_are_other_episodes(tmp_path, changes):
    one, other = samples.accepted(), replace(samples.accepted(), **changes)
    with TraceStore(tmp_path / "store", samples.SCHEMA, RUN) as store:
        iris = [store.add(one), store.add(other)]
        assert len(set(iris)) == 2
        assert [plain(store.episode(iri)) for iri in iris] == [plain(one), plain(other)]


def test_three_given_states_are_three_episodes(tmp_path):
    digests = {state_digest(np.arange(5.0) + shift) for shift in range(3)}
    assert len(digests) == 3
    with TraceStore(tmp_path / "store", samples.SCHEMA, RUN) as store:
        for digest in digests:
            store.add(replace(samples.accepted(), state_index=GIVEN, given=digest))
        assert {store.episode(iri).given for iri in store.episodes()} == digests


def test_the_tags_of_a_store_are_those_of_its_episodes(tmp_path):
    with TraceStore(tmp_path / "store", samples.SCHEMA, RUN, tags=[("light", "dim"), ("arm", "panda")]) as store:
        iri = store.add(samples.accepted())
        assert store.episode(iri).tags == (("arm", "panda"), ("light", "dim"))
        assert iri.endswith("/trial-0;arm=panda;light=dim")


def test_an_episode_that_cannot_be_written_leaves_nothing(tmp_path, monkeypatch):
    real = admission.episode_quads

    def broken(*arguments):
        yield next(real(*arguments))
        raise ValueError("in the middle")

    with TraceStore(tmp_path / "store", samples.SCHEMA, RUN) as store:
        monkeypatch.setattr(admission, "episode_quads", broken)
        with pytest.raises(ValueError, match="in the middle"):
            store.add(samples.accepted())
        assert store.episodes() == ()
        assert store.query("ASK { GRAPH ?g { ?s a trace:Run } }").records() == [{"answer": False}]


def test_a_store_is_readable_while_another_process_writes_it(tmp_path):
    script = (
        "import sys; from runtime.trace.store import TraceStore; from tests.runtime.trace import samples;"
        f"store = TraceStore(sys.argv[1], samples.SCHEMA, {RUN!r}); store.add(samples.accepted());"
        "print('added', flush=True); sys.stdin.readline()"
    )
    path = tmp_path / "store"
    command = [sys.executable, "-c", script, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as writer:
        try:
            assert writer.stdout.readline() == "added\n"
            with pytest.raises(OntoError) as error:
                TraceStore(path, samples.SCHEMA, RUN)
            assert code_of(error) == "TRC001"
            assert "in use" in str(error.value)
            trace = open_trace(path)
            assert plain(trace.episode(trace.episodes()[0])) == plain(samples.accepted())
        finally:
            writer.communicate("stop\n")


def test_the_same_episodes_export_to_the_same_bytes_whatever_their_order(tmp_path):
    for name, episodes in (("a", samples.all_samples()), ("b", samples.all_samples()[::-1])):
        with TraceStore(tmp_path / name, samples.SCHEMA, RUN) as store:
            for episode in episodes:
                store.add(episode)
            store.export_trig(tmp_path / f"{name}.trig")
    text = (tmp_path / "a.trig").read_bytes()
    assert text == (tmp_path / "b.trig").read_bytes()
    assert text.startswith(b"@prefix")
    assert b"owl#Ontology" not in text
    assert b"owl:Ontology" not in text


@pytest.mark.parametrize("ending", ["trig", "nq", "jsonld", "trig.gz"])
def test_every_dump_reads_back_as_the_store(tmp_path, ending):
    trace = open_trace(filled(tmp_path / "store"))
    data = dump(trace.store, module.FORMATS["." + ending.partition(".")[0]])
    file = tmp_path / f"trace.{ending}"
    file.write_bytes(gzip.compress(data) if ending.endswith("gz") else data)
    again = open_trace(file)
    assert [plain(again.episode(i)) for i in again.episodes()] == [plain(trace.episode(i)) for i in trace.episodes()]
    assert dump(again.store, RdfFormat.N_QUADS) == dump(trace.store, RdfFormat.N_QUADS)


def test_an_unwritable_folder_is_a_problem_with_a_remedy(tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(OntoError) as error:
        TraceStore(tmp_path / "file" / "store", samples.SCHEMA, RUN)
    assert code_of(error) == "TRC001"
    with TraceStore(tmp_path / "store", samples.SCHEMA, RUN) as store, pytest.raises(OntoError) as error:
        store.export_trig(tmp_path / "file" / "trace.trig")
    assert code_of(error) == "TRC001"


def test_a_missing_trace_is_a_problem_with_a_remedy(tmp_path):
    (tmp_path / "notes.txt").write_text("x")
    (tmp_path / "empty").mkdir()
    for action in (
        lambda: open_trace(tmp_path / "gone.trig"),
        lambda: open_trace(tmp_path / "notes.txt"),
        lambda: open_trace(tmp_path / "empty"),
        lambda: newest_trace(tmp_path / "nothing"),
    ):
        with pytest.raises(OntoError) as error:
            action()
        assert code_of(error) == "TRC002"


def test_a_corrupt_trace_says_where(tmp_path):
    file = tmp_path / "trace.trig"
    file.write_text("@prefix a: <http://a/> .\na:g { a:s a:p . }\n")
    with pytest.raises(OntoError) as error:
        open_trace(file)
    assert code_of(error) == "TRC003"
    assert error.value.problems[0].line == 2
    (tmp_path / "trace.trig.gz").write_bytes(b"no gzip")
    with pytest.raises(OntoError) as error:
        open_trace(tmp_path / "trace.trig.gz")
    assert code_of(error) == "TRC003"
    broken = filled(tmp_path / "store")
    for part in broken.glob("MANIFEST*"):
        part.write_bytes(b"?")
    with pytest.raises(OntoError) as error:
        open_trace(broken)
    assert code_of(error) == "TRC003"


@pytest.mark.parametrize("lost", ["task", "requires", "memberFact", "index", "outcome", "query", "qpos"])
def test_a_record_that_lacks_a_statement_says_which(tmp_path, lost):
    file = tmp_path / "trace.nq"
    file.write_bytes(dump(open_trace(filled(tmp_path / "store", [samples.accepted()])).store, RdfFormat.N_QUADS))
    trace = open_trace(file)
    name = NamedNode(f"https://w3id.org/onto-evwm/trace#{lost}")
    quads = [q for q in trace.store.quads_for_pattern(None, name, None, None) if "/run/" in q.graph_name.value]
    assert quads
    for quad in quads:
        trace.store.remove(quad)
    with pytest.raises(OntoError) as error:
        trace.episode(trace.episodes()[0])
    assert code_of(error) == "TRC003"


def test_the_newest_trace_is_the_one_written_last(tmp_path):
    import os

    old, new = filled(tmp_path / "demo" / "store", [samples.accepted()]), tmp_path / "bench" / "trace.trig"
    new.parent.mkdir()
    new.write_bytes(dump(open_trace(old).store, RdfFormat.TRIG))
    os.utime(new, (4e9, 4e9))
    assert newest_trace(tmp_path) == new
    os.utime(new, (1, 1))
    assert newest_trace(tmp_path) == old


def test_a_store_that_is_opened_again_holds_the_ontology_as_it_is_now(tmp_path):
    own = tmp_path / "own.ttl"
    header = "<urn:own> a <http://www.w3.org/2002/07/owl#Ontology> ; <urn:own:edition> "
    asked = "SELECT ?edition { <urn:own> <urn:own:edition> ?edition }"
    for edition in (1, 2):
        own.write_text(f"{header} {edition} .")
        with TraceStore(tmp_path / "store", samples.SCHEMA, "run", ontology=[own]) as store:
            store.add(samples.accepted(state=edition))
            assert [row["edition"] for row in store.query(asked).records()] == [edition]
    assert len(open_trace(tmp_path / "store").episodes()) == 2
