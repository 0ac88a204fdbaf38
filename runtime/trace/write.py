"""Records in, quads out: one named graph per ABox and per attempt, by the table of :mod:`runtime.trace.table`.

What is not defined (a NaN margin or score, an empty note) is left out, as RDF has no need of a word for nothing.
PROV relates the parts, so that `what led to this?` needs no other vocabulary.
"""

from __future__ import annotations

from collections.abc import Iterator

from pyoxigraph import Quad

from onto_compiler.rdf import BASE, PREFIXES, RDF, TRACE, node
from onto_compiler.record.places import Known, Spot, Statement
from onto_compiler.record.walk import quads_of, write_record
from onto_compiler.required_rdf import refuse_two_types, stated_facts, thresholds_of
from onto_compiler.schema import Schema
from runtime.loop.records import Episode, ExecutedPlan
from runtime.trace.names import iri_of, run_of
from runtime.trace.table import EPISODE

__all__ = ["VOCABULARY", "episode_quads"]

VOCABULARY = BASE + "trace/0.2.0"
"""The version of ``ontology/trace.ttl`` that episodes are written with."""


def episode_quads(episode: Episode, schema: Schema, run: str) -> Iterator[Quad]:
    """Every statement about ``episode`` as a part of ``run``, graph by graph.

    Raises:
        ValueError: where a part cannot be written as it is: one name stands for entities of two types, a fact has
            three arguments, an address comes twice, a setting is neither text nor a number nor a truth value.
    """
    top = iri_of(run, episode)
    thresholds = thresholds_of(schema)
    refuse_two_types(stated_facts(episode.required), thresholds)
    # A proposer gives its route by name or by IRI.
    routes = {key: route.iri for route in schema.routes.values() for key in (route.name, route.iri)}
    known = Known(thresholds, routes, _origins(episode, top))
    yield from quads_of(_run(top))
    yield from quads_of(write_record(EPISODE, Spot(episode, top, top, top, known)))


def _run(top: str) -> Iterator[Statement]:
    run = run_of(top)
    yield top, run, RDF + "type", node(TRACE + "Run")
    yield top, run, PREFIXES["dcterms"] + "conformsTo", node(VOCABULARY)


def _origins(episode: Episode, top: str) -> dict[str, tuple[str, ...]]:
    """For each observed ABox the activity that made it and the observation before it; for each turn the one before."""
    origins: dict[str, tuple[str, ...]] = {f"{top}/premise": (top,), f"{top}/initial": (top,)}
    earlier, maker = f"{top}/initial", top
    for turn in episode.turns:
        if isinstance(turn, ExecutedPlan):
            iri = f"{top}/plan/{turn.index}"
            origins |= {iri: (maker,), f"{iri}/predicted": (maker, earlier), f"{iri}/simulated": (iri, earlier)}
            earlier, maker = f"{iri}/simulated", iri
            continue
        observed, iri = f"{top}/observed/{turn.index}", f"{top}/attempt/{turn.index}"
        predicted = f"{iri}/predicted"
        origins |= {iri: (maker,), observed: (maker, earlier), predicted: (iri, observed)}
        earlier, maker = predicted if turn.prediction is not None and turn.prediction.adopted else observed, iri
    return {**origins, f"{top}/final": (maker, earlier)}
