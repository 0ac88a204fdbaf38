"""The required ABox as RDF: its facts, its premise, its alternatives and the things that they speak of."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from urllib.parse import quote

from pyoxigraph import Literal, Quad

from onto_compiler.problems import Span
from onto_compiler.rdf import CORE, PROV, RDF, RDFS, TRACE, node
from onto_compiler.required import Entity, Fact, RequiredABox
from onto_compiler.schema import Schema
from onto_compiler.statements import Statement, describe, link, quads_of

__all__ = [
    "entity_iri",
    "fact_statements",
    "refuse_two_types",
    "required_quads",
    "required_statements",
    "stated_facts",
    "thresholds_of",
]

_DERIVED = PROV + "wasDerivedFrom"


def required_quads(required: RequiredABox, schema: Schema, top: str) -> Iterator[Quad]:
    """Every statement about a required ABox and its premise, below the IRI ``top``, as an episode holds them.

    Raises:
        ValueError: where one name stands for entities of two types.
    """
    thresholds = thresholds_of(schema)
    refuse_two_types(stated_facts(required), thresholds)
    facts, premise = f"{top}/required", f"{top}/premise"
    graphs = [
        (facts, required_statements(facts, top, required, thresholds)),
        (premise, fact_statements(premise, top, required.premise, thresholds)),
    ]
    yield from quads_of(graphs)


def thresholds_of(schema: Schema) -> frozenset[str]:
    """The IRIs that may stand as arguments and are no entities of a scene."""
    return frozenset(threshold.iri for threshold in schema.thresholds.values())


def entity_iri(top: str, name: str) -> str:
    """The IRI of an argument below ``top``: ``plate_1`` of two scenes is two things."""
    return f"{top}/entity/{quote(name, safe='')}"


def required_statements(iri: str, top: str, required: RequiredABox, thresholds: frozenset[str]) -> Iterator[Statement]:
    """The ABox ``iri`` with the facts of the goal; its premise stands in a graph of its own."""
    yield from describe(
        iri,
        [TRACE + "RequiredABox"],
        trace_task=required.task,
        trace_language=required.language,
        trace_problem=required.problem,
        trace_taskFile=required.source,
    )
    yield from link(iri, TRACE + "declares", *(f"{top}/premise/fact/{i}" for i in range(len(required.premise))))
    yield from link(iri, TRACE + "memberFact", *(f"{iri}/fact/{i}" for i in range(len(required.facts))))
    yield from fact_statements(iri, top, required.facts, thresholds)
    yield from fact_statements(f"{iri}/precondition", top, [p.fact for p in required.preconditions], thresholds)
    for index, precondition in enumerate(required.preconditions):
        yield from link(f"{iri}/precondition/fact/{index}", CORE + "declaration", precondition.declared)
        for later in precondition.before:
            yield from link(f"{iri}/fact/{later}", CORE + "precondition", f"{iri}/precondition/fact/{index}")
    for index, way in enumerate(required.alternatives):
        alternative = f"{iri}/alternative/{index}"
        yield from link(iri, TRACE + "alternative", alternative)
        yield from describe(alternative, [TRACE + "Alternative"], trace_index=index)
        yield from link(alternative, TRACE + "asksFor", *(f"{iri}/fact/{i}" for i in way))
        yield from link(alternative, _DERIVED, iri)


def fact_statements(abox: str, top: str, facts: Sequence[Fact], thresholds: frozenset[str]) -> Iterator[Statement]:
    """Each of ``facts`` as ``abox/fact/INDEX``, and its arguments as entities below ``top``."""
    for index, fact in enumerate(facts):
        arguments = [node(a.type if a.type in thresholds else entity_iri(top, a.name)) for a in fact.arguments]
        yield from describe(
            f"{abox}/fact/{index}",
            [CORE + "RequiredFact"],
            core_predicate=node(fact.predicate),
            core_argument1=arguments[0] if arguments else None,
            core_argument2=arguments[1] if len(arguments) > 1 else None,
            core_polarity=fact.polarity,
            core_requiredMargin=float(fact.threshold),
            core_nativeAtom=str(fact.native),
            core_groundedBy=fact.grounded_by,
            trace_index=index,
            trace_place=_place(fact.span),
            trace_taskFile=fact.span.file if fact.span else None,
        )
        yield from link(f"{abox}/fact/{index}", _DERIVED, f"{top}/required")
        for argument in fact.arguments:
            if argument.type not in thresholds:
                yield from _entity(entity_iri(top, argument.name), argument)


def stated_facts(required: RequiredABox) -> tuple[Fact, ...]:
    """Every fact that the record of a required ABox holds."""
    return (*required.facts, *required.premise, *(each.fact for each in required.preconditions))


def refuse_two_types(facts: Iterable[Fact], thresholds: frozenset[str]) -> None:
    """Hold ``facts`` to what can be read back: plain atoms, and one type for each name.

    Raises:
        ValueError: where it cannot.
    """
    types: dict[str, str] = {}
    for fact in facts:
        if str(fact.native).count("(") != 1 or len(fact.arguments) > 2:
            raise ValueError(f"`{fact.native}` is not an atom of at most two plain names")
        for argument in fact.arguments:
            if argument.type in thresholds:
                continue
            if types.setdefault(argument.name, argument.type) != argument.type:
                raise ValueError(f"`{argument.name}` is both a {types[argument.name]} and a {argument.type}")


def _entity(iri: str, entity: Entity) -> Iterator[Statement]:
    yield iri, RDF + "type", node(entity.type)
    yield iri, RDFS + "label", Literal(entity.name)


def _place(span: Span | None) -> str | None:
    return f"{span.line}:{span.column}-{span.end_line}:{span.end_column}" if span else None
