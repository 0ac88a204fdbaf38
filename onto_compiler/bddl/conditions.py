"""Preconditions of a goal: what must hold before a fact can be brought about under dynamics, as typed facts.

The TBox declares them (``core:Precondition``); here each is written out for the objects of one task and lifted as an
atom of the goal would be. A state that is written needs none, so they are derived only for runs that execute actions.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from onto_compiler.bddl.ast import NOWHERE, Atom, Symbol, TaskSpec
from onto_compiler.bddl.lift import lift_atom
from onto_compiler.bddl.scope import Named, Scope, scope_of
from onto_compiler.problems import Span
from onto_compiler.required import Fact, Precondition, RequiredABox
from onto_compiler.schema import PreconditionRule, Schema

__all__ = ["with_preconditions"]


def with_preconditions(required: RequiredABox, spec: TaskSpec, schema: Schema) -> RequiredABox:
    """``required`` with the preconditions of its facts, which ``spec`` asks for and ``schema`` declares.

    An atom that does not lift in this task (a joint without a threshold, another domain's predicate) is no condition.
    """
    scope = scope_of(spec, schema)
    found: dict[tuple[Fact, str], list[int]] = {}
    for index, fact in enumerate(required.facts):
        for rule in schema.preconditions:
            if not _concerns(rule, fact, schema):
                continue
            for atom in _atoms(rule, fact, scope, schema):
                lifted = lift_atom(atom, scope, schema, spec.domain, polarity=rule.must_hold)
                if lifted is not None:
                    found.setdefault((replace(lifted, span=None), rule.iri), []).append(index)
    return replace(
        required,
        preconditions=tuple(
            Precondition(replace(fact, span=required.facts[before[0]].span), tuple(before), iri)
            for (fact, iri), before in found.items()
        ),
    )


def _concerns(rule: PreconditionRule, fact: Fact, schema: Schema) -> bool:
    kind = schema.predicates[fact.predicate].kind
    return rule.argument < len(fact.arguments) and any(
        fact.predicate == one or schema.is_a(kind, one) for one in rule.precedes
    )


def _atoms(rule: PreconditionRule, fact: Fact, scope: Scope, schema: Schema) -> Iterator[Atom]:
    """The atoms that ``rule`` asks for before ``fact``, at the place of the fact."""
    about = _about(rule, scope.names.get(fact.arguments[rule.argument].name), scope, schema)
    if about is None:
        return
    span = fact.span or NOWHERE
    if rule.others is None:
        yield _atom(rule.native, span, about)
        return
    for name, each in scope.names.items():
        if name != about and each.region is None and schema.is_a(each.entity.type, rule.others):
            yield _atom(rule.native, span, name, about)


def _about(rule: PreconditionRule, named: Named | None, scope: Scope, schema: Schema) -> str | None:
    """The argument, or what it is a region of, whichever is of the class that the rule speaks of."""
    if named is None:
        return None
    if schema.is_a(named.entity.type, rule.argument_class):
        return named.entity.name
    owner = scope.names.get(named.region.target.name) if named.region is not None else None
    return owner.entity.name if owner is not None and schema.is_a(owner.entity.type, rule.argument_class) else None


def _atom(predicate: str, span: Span, *names: str) -> Atom:
    return Atom(predicate, tuple(Symbol(name, span) for name in names), span, span)
