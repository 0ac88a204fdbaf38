"""Read the names that a fact's native atom tests; a typed fact may name a landmark instead, which is not tested."""

from __future__ import annotations

from onto_compiler.problems import OntoError, Problem
from onto_compiler.required import Fact
from onto_compiler.schema import Schema, local_name

__all__ = ["one_name", "tolerance_of", "two_names", "unsuited"]


def one_name(fact: Fact) -> str:
    """The single native argument; raises ``SIM006`` when there is another number of them."""
    if len(fact.native.arguments) != 1:
        raise unsuited(fact, f"`{fact.grounded_by}` tests one name, `{fact.native}` has {len(fact.native.arguments)}")
    return fact.native.arguments[0]


def two_names(fact: Fact) -> tuple[str, str]:
    """Both native arguments; raises ``SIM006`` when there is another number of them."""
    if len(fact.native.arguments) != 2:
        raise unsuited(fact, f"`{fact.grounded_by}` tests two names, `{fact.native}` has {len(fact.native.arguments)}")
    first, second = fact.native.arguments
    return first, second


def tolerance_of(fact: Fact, schema: Schema) -> float:
    """The tolerance that the TBox gives the fact's predicate; raises ``SIM006`` if it gives none."""
    tolerance = schema.predicates[fact.predicate].tolerance
    if tolerance is None:
        name = local_name(fact.predicate)
        raise unsuited(fact, f"`{name}` has no tolerance to count a margin from", f"give `{name}` a core:tolerance")
    return tolerance


def unsuited(fact: Fact, message: str, hint: str = "") -> OntoError:
    """A ``SIM006`` at the fact's place in its task file."""
    if fact.span is None:
        return OntoError.of("SIM006", message, hint)
    return OntoError(Problem.at(fact.span, "SIM006", message, hint))
