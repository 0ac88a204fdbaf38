"""The dense layout that planners use: every term a small number, every signature a mask, every rule table an array.

Arrays are nested lists; -1 stands for none. Codes of evidence and attempt statuses are those of the run time.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from onto_compiler.emit.tbox import TBox
from onto_compiler.rdf import CORE
from onto_compiler.tables import ATTEMPT_STATUSES, LEVELS, STATUSES, compile_tables

__all__ = ["emit"]

_ENTITY = CORE + "Entity"
_PLACES = 2


def emit(tbox: TBox) -> str:
    """JSON.

    ``classes``: C class IRIs. ``predicates``: P records, in the order of their index. ``argument_mask``: P x 2 x C, 1
    where an argument of that class is allowed (all 0: no such argument). ``diagnosis``: P x 2 x S, the failure that
    follows from predicate, polarity (0: must not hold) and evidence status. ``priority``: F. ``routing``:
    L x P x F x R+1 x A, the route that follows from the level at which the loop may act, predicate, failure, previous
    route (R: none) and attempt status.

    Raises:
        OntoError: RUN002 if two rules conclude different things of one combination.
    """
    schema = tbox.schema
    tables = compile_tables(tbox.store, schema)
    predicates, failures, routes = sorted(schema.predicates), sorted(schema.failures), sorted(schema.routes)
    used = {wanted for signature in schema.predicates.values() for wanted in signature.parameters}
    classes = sorted({*tbox.below(_ENTITY), *(sub for wanted in used for sub in tbox.below(wanted))})
    levels = [level for level in LEVELS if any(route.level == level for route in schema.routes.values())]
    units = sorted({signature.margin_unit for signature in schema.predicates.values() if signature.margin_unit})
    failed = {
        key: failures.index(entry.failure) for key, entry in tables.diagnosis.items() if entry.failure in failures
    }
    routed = {key: routes.index(entry.route) for key, entry in tables.routing.items() if entry.route in routes}
    order = {(f, entry.priority) for entry in tables.diagnosis.values() if (f := entry.failure) in failures}
    layout: dict[str, Any] = {
        "generated": "by `onto schema --emit dense`; edit the ontology instead",
        "classes": classes,
        "units": units,
        "predicates": [
            {
                "iri": iri,
                "name": schema.predicates[iri].name,
                "kind": schema.predicates[iri].kind,
                "arity": len(schema.predicates[iri].parameters),
                "unit": _index(units, schema.predicates[iri].margin_unit),
            }
            for iri in predicates
        ],
        "argument_mask": [
            [_mask(tbox, classes, schema.predicates[iri].parameters[place : place + 1]) for place in range(_PLACES)]
            for iri in predicates
        ],
        "statuses": list(STATUSES),
        "attempt_statuses": list(ATTEMPT_STATUSES),
        "levels": levels,
        "failures": failures,
        "priority": [min((p for f, p in order if f == one), default=schema.failures[one]) for one in failures],
        "routes": [{"iri": iri, "name": schema.routes[iri].name, "level": schema.routes[iri].level} for iri in routes],
        "diagnosis": [
            [[failed.get((iri, polarity, status), -1) for status in STATUSES] for polarity in (False, True)]
            for iri in predicates
        ],
        "routing": [
            [
                [
                    [
                        [routed.get((iri, failure, status, previous, level), -1) for status in ATTEMPT_STATUSES]
                        for previous in (*routes, None)
                    ]
                    for failure in failures
                ]
                for iri in predicates
            ]
            for level in levels
        ],
    }
    return _text(layout)


def _index(known: Sequence[str], one: str | None) -> int:
    return known.index(one) if one in known else -1


def _mask(tbox: TBox, classes: Sequence[str], wanted: Sequence[str]) -> list[int]:
    return [int(any(tbox.schema.is_a(cls, one) for one in wanted)) for cls in classes]


def _text(layout: dict[str, Any]) -> str:
    """One line per row of a table, so that a difference of two versions can be read."""
    parts = []
    for key, value in layout.items():
        if isinstance(value, list) and value:
            rows = ",\n    ".join(json.dumps(row, ensure_ascii=False) for row in value)
            parts.append(f"  {json.dumps(key)}: [\n    {rows}\n  ]")
        else:
            parts.append(f"  {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}")
    return "{\n" + ",\n".join(parts) + "\n}\n"
