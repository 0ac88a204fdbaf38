"""Rules with one ``sh:order``, where their order can matter.

It cannot where no case is one of both, and where they conclude the same. Whether one reads what the other concludes is
asked elsewhere (RUL008).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from collections.abc import Set as AbstractSet
from itertools import permutations

from pyoxigraph import NamedNode

from onto_compiler.check.finding import Finding, Term
from onto_compiler.check.patterns import Construct
from onto_compiler.rdf import CORE, SH
from onto_compiler.tables import ATTEMPT_STATUSES, STATUSES

__all__ = ["check_order"]

_PREDICATE = CORE + "Predicate"
_ORDER = NamedNode(SH + "order")
_HINT = "give them orders of their own, in tens, or let them exclude each other by kind or status"


def check_order(
    rules: Iterable[tuple[Term, float, Construct]], classes: Mapping[str, AbstractSet[str]]
) -> Iterator[Finding]:
    """RUL004 at each of two rules; ``classes`` holds each class with what is above it."""
    for (rule, order, query), (other, same, beside) in permutations(rules, 2):
        if order != same or not _differ(rule, query, other, beside):
            continue
        if _meet(query, beside, classes):
            yield Finding(
                "RUL004",
                "error",
                "`{subject}` and `{other}` have the same sh:order {object} and conclude different things of one case",
                _HINT,
                rule,
                _ORDER,
                values={"other": other, "object": f"{order:g}"},
            )


def _differ(rule: Term, query: Construct, other: Term, beside: Construct) -> bool:
    """Whether both write one property with different values; a rule's own name tells nothing of a case."""
    ours = {(step.predicate.iri, step.object) for step in query.writes if step.object != rule.value}
    theirs = {(step.predicate.iri, step.object) for step in beside.writes if step.object != other.value}
    return any(one == two and value != another for one, value in ours for two, another in theirs)


def _meet(query: Construct, beside: Construct, classes: Mapping[str, AbstractSet[str]]) -> bool:
    """Whether one case may be one of both; a rule that names no status, or no kind, speaks of all."""
    for statuses in (set(STATUSES), set(ATTEMPT_STATUSES)):
        ours, theirs = (statuses.intersection(name.iri for name in one.names) for one in (query, beside))
        if ours and theirs and not ours & theirs:
            return False
    ours, theirs = (
        {name.iri for name in one.names if _PREDICATE in classes.get(name.iri, ())} for one in (query, beside)
    )
    related = any(one in classes[two] or two in classes[one] for one in ours for two in theirs)
    return related or not (ours and theirs)
