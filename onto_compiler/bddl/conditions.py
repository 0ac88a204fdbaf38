"""Preconditions of a goal: what must hold before a fact can be brought about under dynamics, as typed facts.

The TBox declares them (``core:Precondition``); here each is written out for the objects of one task and lifted as an
atom of the goal would be. A state that is written needs none, so they are derived only for runs that execute actions.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

from onto_compiler.bddl.ast import NOWHERE, Atom, Symbol, TaskSpec
from onto_compiler.bddl.lift import lift_atom
from onto_compiler.bddl.scope import Named, Scope, scope_of
from onto_compiler.problems import Span
from onto_compiler.required import Entity, Fact, Precondition, RequiredABox
from onto_compiler.schema import PreconditionRule, Schema

__all__ = ["with_preconditions"]


def with_preconditions(required: RequiredABox, spec: TaskSpec, schema: Schema) -> RequiredABox:
    """``required`` with the preconditions of its facts, which ``spec`` asks for and ``schema`` declares.

    A precondition that the initial state denies has preconditions of its own, which stand before it: of a stack, what
    is on top is taken off first. An atom that does not lift in this task (a joint without a threshold, another
    domain's predicate) is no condition.
    """
    writer = _Writer(required, schema, scope_of(spec, schema), spec.domain)
    found: dict[tuple[Fact, str], list[int]] = {}
    for index, fact in enumerate(required.facts):
        for condition, iri in writer.before(fact):
            indices = found.setdefault((condition, iri), [])
            if index not in indices:
                indices.append(index)
    return replace(
        required,
        preconditions=tuple(
            Precondition(replace(fact, span=required.facts[before[0]].span), tuple(before), iri)
            for (fact, iri), before in found.items()
        ),
    )


@dataclass(frozen=True, slots=True)
class _Writer:
    required: RequiredABox
    schema: Schema
    scope: Scope
    domain: str

    def before(self, fact: Fact, above: tuple[Fact, ...] = ()) -> Iterator[tuple[Fact, str]]:
        """The facts that must hold before ``fact`` and the rules that ask for them, in the order that they are met.

        ``above`` are the facts that ``fact`` itself comes before.
        """
        for rule in self.schema.preconditions:
            for needing in self._needing(rule, fact):
                for atom in _atoms(rule, needing, self.scope, self.schema):
                    lifted = lift_atom(atom, self.scope, self.schema, self.domain, polarity=rule.must_hold)
                    if lifted is None:
                        continue
                    lifted = replace(lifted, span=None)
                    if lifted not in above and self._denied(lifted):
                        yield from self.before(lifted, (*above, lifted))
                    yield lifted, rule.iri

    def _needing(self, rule: PreconditionRule, fact: Fact) -> Iterator[Fact]:
        """``fact``, if it needs what ``rule`` asks for; else the facts of its arguments' places that do."""
        if self._is(fact, rule.precedes):
            yield fact
        if not self._is(fact, rule.extends):
            return
        moved = self.schema.predicates[fact.predicate].moves
        waiting = [
            (each, [] if place == moved else list(self.required.facts)) for place, each in enumerate(fact.arguments)
        ]
        seen = {fact.native}
        while waiting:
            # An object is worked on where it is, another thing where the goal wants it, or else where it is.
            entity, goal = waiting.pop(0)
            for placed in self._places(entity, goal) or self._places(entity, self.required.premise):
                if placed.native in seen:
                    continue
                seen.add(placed.native)
                if self._is(placed, rule.precedes):
                    yield placed
                if self._is(placed, rule.extends):
                    waiting += [(each, goal) for each in placed.arguments if each != entity]

    def _places(self, entity: Entity, facts: Sequence[Fact]) -> list[Fact]:
        """Those of ``facts`` that say where ``entity`` is."""
        found = []
        for fact in facts:
            moved = self.schema.predicates[fact.predicate].moves
            if fact.polarity and moved is not None and fact.arguments[moved] == entity:
                found.append(fact)
        return found

    def _denied(self, fact: Fact) -> bool:
        """Whether the declared initial state says that ``fact`` does not hold."""
        return any(fact.native == each.native and fact.polarity != each.polarity for each in self.required.premise)

    def _is(self, fact: Fact, kinds: Collection[str]) -> bool:
        kind = self.schema.predicates[fact.predicate].kind
        return any(fact.predicate == one or self.schema.is_a(kind, one) for one in kinds)


def _atoms(rule: PreconditionRule, fact: Fact, scope: Scope, schema: Schema) -> Iterator[Atom]:
    """The atoms that ``rule`` asks for before ``fact``, at the place of the fact."""
    if rule.argument >= len(fact.arguments):
        return
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
