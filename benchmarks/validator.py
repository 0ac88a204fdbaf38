"""The runtime validator beside pySHACL: the same verdicts, and what a record and a whole graph cost.

Records: ABoxes of generated episodes, whole and damaged (:mod:`benchmarks.mutations`), each given to both together with
the shipped ontology. Graph: one graph of many episodes, some of them damaged, for the engine of ``onto check`` and for
pySHACL in one process, each with the graph ready in its own form; only validation is timed.
"""

from __future__ import annotations

import logging
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import Any

import numpy as np
from pyoxigraph import BlankNode, Literal, NamedNode, Quad, Store, Triple

import ontology
from benchmarks.generated import generated_episode
from benchmarks.mutations import MUTATIONS
from benchmarks.protocol import Protocol, Row, Trial
from benchmarks.shapes_pyshacl import as_graph, read_report
from onto_compiler.knowledge import Knowledge, load_knowledge
from onto_compiler.rdf import RDF, node
from onto_compiler.shapes import ShapeResult, compile_shapes, validate
from onto_compiler.sources import load_store, read_into
from onto_compiler.turtle.source_map import canonical
from onto_compiler.validator.engine import with_implications
from onto_compiler.validator.records import Validator, compile_validator
from runtime.trace.write import episode_quads

__all__ = ["VALIDATOR", "Bench", "bench", "damaged"]

SEED = 20_260
ABOXES, GRAPH = 100, 100_000  # ABoxes of each kind of mutation; triples of the graph
SMALL_ABOXES, SMALL_GRAPH = 4, 5_000
PASSES = 5
DAMAGED = 10  # one episode in ten of the graph
# Left out of the graph, since the two print these values differently: rdflib rewrites a malformed boolean to `false`,
# and of two bounds that NaN fails pySHACL reports one.
_UNEQUAL = ("malformed", "out of range", "two")
_SHAPES = ("implications.ttl", "trace.ttl")
_TYPE = node(RDF + "type")

Term = NamedNode | BlankNode | Literal
Found = frozenset[tuple[object, ...]]


@dataclass(frozen=True)
class Bench:
    """The shipped ontology and its ABox shapes, for our validators and for pySHACL."""

    knowledge: Knowledge
    vocabulary: tuple[Quad, ...]
    shapes: Store

    @cached_property
    def validator(self) -> Validator:
        """The validator of single records."""
        return compile_validator(self.vocabulary, self.shapes)

    @cached_property
    def ontology_graph(self) -> Any:  # noqa: ANN401 - an rdflib graph
        """The ontology for pySHACL."""
        return as_graph(_store(self.vocabulary))

    @cached_property
    def shapes_graph(self) -> Any:  # noqa: ANN401 - an rdflib graph
        """The shapes for pySHACL."""
        return as_graph(self.shapes)

    def data_graph(self, triples: Iterable[Triple]) -> Any:  # noqa: ANN401 - an rdflib graph
        """``triples`` beside the ontology, for pySHACL."""
        with _quiet():
            graph = as_graph(_store(_quads(triples)))
            graph += self.ontology_graph
            return graph

    def oracle(self, graph: Any) -> Found:  # noqa: ANN401 - an rdflib graph
        """What pySHACL finds in a :meth:`data_graph`."""
        import pyshacl  # noqa: PLC0415 - a second to import, in the process that runs the trial

        with _quiet():
            _, report, _ = pyshacl.validate(
                graph, shacl_graph=self.shapes_graph, inference="none", advanced=False, inplace=True, meta_shacl=False
            )
            return frozenset((_plain(row[0]), _plain(row[1]), _plain(row[2]), row[3]) for row in read_report(report))

    def oracle_of(self, triples: Iterable[Triple]) -> Found:
        """As :meth:`oracle` of the :meth:`data_graph` of ``triples``, without a copy of the ontology for each."""
        graph = self.ontology_graph
        with _quiet():
            added = [each for each in as_graph(_store(_quads(triples))) if each not in graph]
        for each in added:
            graph.add(each)
        try:
            return self.oracle(graph)
        finally:
            for each in added:
                graph.remove(each)

    def records(self, triples: Iterable[Triple]) -> int:
        """How many of the described nodes are records that a shape speaks of."""
        targets = (target for shape in self.validator.shapes.roots for target in shape.targets)
        wanted = {target.term for target in targets if target.kind == "class"}
        return len({triple.subject for triple in triples if triple.predicate == _TYPE and triple.object in wanted})


@lru_cache(maxsize=1)
def bench() -> Bench:
    """What every trial needs, loaded once a process."""
    shapes = Store()
    for path in ontology.turtle_files():
        if path.parent.name == "shapes" and path.name in _SHAPES:
            read_into(shapes, path)
    return Bench(load_knowledge(), tuple(load_store()), shapes)


def episode_triples(one: Bench, rng: np.random.Generator, number: int) -> list[Triple]:
    """A generated episode as it is written, its graphs merged."""
    episode = generated_episode(rng, one.knowledge, number)
    return list(dict.fromkeys(quad.triple for quad in episode_quads(episode, one.knowledge.schema, "bench")))


def damaged(one: Bench, kind: str, seed: int) -> list[Triple]:
    """An ABox with a mutation of ``kind``, the same for the same ``seed``."""
    rng = np.random.default_rng([SEED, seed])
    return MUTATIONS[kind](rng, episode_triples(one, rng, seed))


def found_by(results: Iterable[ShapeResult]) -> Found:
    """Results in the form of :meth:`Bench.oracle`."""
    return frozenset((_plain(r.focus), _plain(r.path), _plain(r.value), r.component) for r in results)


@contextmanager
def _quiet() -> Iterator[None]:
    """No word from rdflib on literals that are malformed on purpose."""
    logger = logging.getLogger("rdflib.term")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logger.setLevel(level)


def _plain(term: Term | Triple | None) -> object:
    """A term as both agree on it: no blank node's name, no lexical form."""
    if term is None or isinstance(term, BlankNode):
        return None if term is None else "blank"
    return canonical(term)


def _quads(triples: Iterable[Triple]) -> Iterator[Quad]:
    return (Quad(each.subject, each.predicate, each.object) for each in triples)


def _store(quads: Iterable[Quad]) -> Store:
    store = Store()
    store.bulk_extend(quads)
    return store


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """One trial for each kind of mutation, and the graph."""
    aboxes, triples = (ABOXES, GRAPH) if full else (SMALL_ABOXES, SMALL_GRAPH)
    kinds: list[Trial] = [{"key": f"aboxes/{kind}", "kind": kind, "aboxes": aboxes} for kind in MUTATIONS]
    return [*kinds, {"key": "graph", "kind": "graph", "at_least": triples}]


def run(trial: Trial) -> list[Row]:
    """One row."""
    row = _graph(trial["at_least"]) if trial["kind"] == "graph" else _aboxes(trial["kind"], trial["aboxes"])
    return [{"mode": "none", "sees": "none", **row}]


def _aboxes(kind: str, count: int) -> Row:
    one = bench()
    first = list(MUTATIONS).index(kind) * ABOXES
    corpus = [damaged(one, kind, seed) for seed in range(first, first + count)]
    tally: Counter[str] = Counter()
    unequal = []
    for seed, triples in enumerate(corpus, first):
        mine, theirs = found_by(one.validator.validate(triples)), one.oracle_of(triples)
        tally["records"] += one.records(triples)
        tally["invalid"] += bool(theirs)
        tally["mismatches"] += bool(mine) != bool(theirs)
        if mine != theirs:
            tally["results_differ"] += 1
            unequal.append(seed)
    names = ("records", "invalid", "mismatches", "results_differ")
    return {**{name: tally[name] for name in names}, "unequal_seeds": unequal, "validate_s": _best(one, corpus)}


def _best(one: Bench, corpus: Sequence[Sequence[Triple]]) -> float:
    """Seconds that all ABoxes take, statements to verdicts: of each the best of :data:`PASSES`."""
    least = (min(_timed(partial(one.validator.validate, triples))[0] for _ in range(PASSES)) for triples in corpus)
    return round(sum(least), 6)


def _graph(at_least: int) -> Row:
    one = bench()
    rng = np.random.default_rng([SEED, 0])
    kinds = [kind for kind in MUTATIONS if kind not in {"none", *_UNEQUAL}]
    triples: dict[Triple, None] = {}
    episodes = 0
    while len(triples) < at_least:
        written = episode_triples(one, rng, episodes)
        if episodes % DAMAGED == 0:
            written = MUTATIONS[kinds[(episodes // DAMAGED) % len(kinds)]](rng, written)
        triples.update(dict.fromkeys(written))
        episodes += 1
    data = [Quad(triple.subject, triple.predicate, triple.object) for triple in triples]
    store, graph = _store([*data, *one.vocabulary]), one.data_graph(triples)
    engine_s, mine = _timed(lambda: found_by(validate(store, with_implications(compile_shapes(one.shapes)))))
    plain_s, plain = _timed(lambda: found_by(one.validator.validate(triples)))
    pyshacl_s, theirs = _timed(lambda: one.oracle(graph))
    return {
        "episodes": episodes,
        "triples": len(triples),
        "results": len(theirs),
        "differ": len(mine ^ theirs),
        "plain_differ": len(plain ^ theirs),
        "engine_s": engine_s,
        "plain_s": plain_s,
        "pyshacl_s": pyshacl_s,
    }


def _timed(call: Callable[[], Any]) -> tuple[float, Any]:
    started = time.perf_counter()
    value = call()
    return round(time.perf_counter() - started, 6), value


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Sums over the ABoxes; of the graph, pySHACL's time divided by ours."""
    whole = [row for row in rows if "crashed" not in row]
    aboxes = [row for row in whole if row["kind"] != "graph"]
    records = sum(row["records"] for row in aboxes)
    sums = {name: sum(row[name] for row in aboxes) for name in ("aboxes", "invalid", "mismatches", "results_differ")}
    found: dict[str, float] = {
        "records": records,
        **sums,
        "us_per_record": 1e6 * sum(row["validate_s"] for row in aboxes) / max(records, 1),
        "crashed": len(rows) - len(whole),
    }
    for row in whole:
        if row["kind"] == "graph":
            found |= {
                "graph_triples": row["triples"],
                "graph_results": row["results"],
                "graph_mismatches": row["differ"],
                "graph_engine_s": row["engine_s"],
                "graph_pyshacl_s": row["pyshacl_s"],
                "graph_ratio": row["pyshacl_s"] / row["engine_s"],
                "graph_plain_ratio": row["pyshacl_s"] / row["plain_s"],
            }
    return found


VALIDATOR = Protocol(
    name="validator",
    help="record and graph validation beside pySHACL: verdicts, microseconds a record, ratio on a graph",
    seeds=(SEED,),
    trials=trials,
    run=run,
    metrics=metrics,
    timed=frozenset({"validate_s", "engine_s", "plain_s", "pyshacl_s"}),
    of_tree=frozenset({"records", "invalid", "results_differ", "unequal_seeds", "triples", "results"}),
)
