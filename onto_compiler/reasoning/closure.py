"""OWL 2 RL forward chaining that remembers why: each fact keeps its premises, and each clash can name its axioms.

Source: OWL 2 Profiles, section 4.3, tables 4 to 7. Left out are property chains, keys, datatype reasoning and the
replacement of classes and properties by equal ones; what is derived is sound.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from pyoxigraph import Literal

from onto_compiler.reasoning.axioms import TYPE, Axioms, Fact, Term, owl

__all__ = ["Clash", "Closure", "close"]

_SAME, _NOTHING, _THING = owl("sameAs"), owl("Nothing"), owl("Thing")


@dataclass(frozen=True, slots=True)
class Clash:
    """Facts and axioms that cannot hold together; ``about`` is the individual that they meet at."""

    about: Term
    premises: tuple[Fact, ...]


@dataclass
class Closure:
    """``premises[fact]`` is empty for what was given."""

    axioms: Axioms
    premises: dict[Fact, tuple[Fact, ...]] = field(default_factory=dict)
    clashes: list[Clash] = field(default_factory=list)
    types: defaultdict[Term, set[Term]] = field(default_factory=lambda: defaultdict(set))
    members: defaultdict[Term, set[Term]] = field(default_factory=lambda: defaultdict(set))
    out: defaultdict[tuple[Term, Term], list[Term]] = field(default_factory=lambda: defaultdict(list))
    into: defaultdict[tuple[Term, Term], list[Term]] = field(default_factory=lambda: defaultdict(list))
    about: defaultdict[Term, list[Fact]] = field(default_factory=lambda: defaultdict(list))
    waiting: deque[Fact] = field(default_factory=deque)

    def add(self, fact: Fact, *premises: Fact) -> None:
        """Note a fact, once; a literal is the subject of none."""
        if fact not in self.premises and not isinstance(fact[0], Literal):
            self.premises[fact] = premises
            self.waiting.append(fact)

    def clash(self, about: Term, *premises: Fact) -> None:
        """Note that these cannot hold together."""
        self.clashes.append(Clash(about, premises))

    def given(self, facts: Iterable[Fact]) -> tuple[Fact, ...]:
        """The given triples that ``facts`` were derived from, each once, in the order in which they are needed."""
        found: dict[Fact, None] = {}
        waiting, seen = list(facts)[::-1], set()
        while waiting:
            fact = waiting.pop()
            if fact in seen:
                continue
            seen.add(fact)
            because = self.premises.get(fact, ())
            if because:
                waiting += because[::-1]
            else:
                found[fact] = None
        return tuple(found)

    def run(self) -> None:
        """Derive until nothing new follows."""
        while self.waiting:
            fact = self.waiting.popleft()
            subject, predicate, value = fact
            if predicate == TYPE:
                self.types[subject].add(value)
                self.members[value].add(subject)
                self.typed(subject, value, fact)
            elif predicate == _SAME:
                self.same(subject, value, fact)
            else:
                self.out[subject, predicate].append(value)
                self.into[predicate, value].append(subject)
                self.related(subject, predicate, value, fact)
            self.about[subject].append(fact)
            for twin in self.out.get((subject, _SAME), ()):
                if predicate != _SAME:
                    self.add((twin, predicate, value), fact, (subject, _SAME, twin))

    def typed(self, subject: Term, cls: Term, fact: Fact) -> None:
        """The consequences of ``subject`` being a ``cls``."""
        axioms = self.axioms
        if cls == _NOTHING:
            self.clash(subject, fact)
        for above, axiom in axioms.above.get(cls, ()):
            self.add((subject, TYPE, above), fact, axiom)
        for whole, members, axiom in axioms.both.get(cls, ()):
            if all(member in self.types[subject] for member in members):
                self.add((subject, TYPE, whole), *((subject, TYPE, member) for member in members), axiom)
        for group, axiom in axioms.disjoint.get(cls, ()):
            if len(group) == 1:
                self.clash(subject, fact, axiom)
            for other in sorted(group & self.types[subject], key=str):
                if other != cls:
                    self.clash(subject, (subject, TYPE, other), fact, axiom)
        self.restricted(subject, cls, fact)

    def restricted(self, subject: Term, cls: Term, fact: Fact) -> None:
        """The consequences of ``subject`` being a ``cls``, where that is a restriction or the filler of one."""
        axioms = self.axioms
        for prop, filler, axiom in axioms.only.get(cls, ()):
            for value in self.out.get((subject, prop), ()):
                self.add((value, TYPE, filler), (subject, prop, value), fact, axiom)
        for prop, value, axiom in axioms.value.get(cls, ()):
            self.add((subject, prop, value), fact, axiom)
        for restriction, prop, axiom in axioms.some_of.get(cls, ()):
            for source in self.into.get((prop, subject), ()):
                self.add((source, TYPE, restriction), (source, prop, subject), fact, axiom)
        for prop, _, _, _ in axioms.at_most.get(cls, ()):
            self.counted(subject, prop)
        for prop, source in self.qualified(cls, subject):
            self.counted(source, prop)

    def qualified(self, cls: Term, value: Term) -> Iterator[tuple[Term, Term]]:
        """Where a qualified cardinality counts ``value`` now that it is a ``cls``."""
        for restriction, limits in self.axioms.at_most.items():
            for prop, _, qualifier, _ in limits:
                if qualifier == cls:
                    for source in self.into.get((prop, value), ()):
                        if restriction in self.types[source]:
                            yield prop, source

    def related(self, subject: Term, prop: Term, value: Term, fact: Fact) -> None:
        """The consequences of ``subject prop value``."""
        axioms = self.axioms
        for wider, axiom in axioms.wider.get(prop, ()):
            self.add((subject, wider, value), fact, axiom)
        for inverse, axiom in axioms.inverse.get(prop, ()):
            self.add((value, inverse, subject), fact, axiom)
        for cls, axiom in axioms.domain.get(prop, ()):
            self.add((subject, TYPE, cls), fact, axiom)
        for cls, axiom in axioms.range.get(prop, ()):
            self.add((value, TYPE, cls), fact, axiom)
        self.filled(subject, prop, value, fact)
        self.counted(subject, prop)
        self.functional(subject, prop, value, fact)
        self.characteristic(subject, prop, value, fact)
        for group, axiom in axioms.disjoint_property.get(prop, ()):
            if len(group) == 1:
                self.clash(subject, fact, axiom)
            for other in group - {prop}:
                if (subject, other, value) in self.premises:
                    self.clash(subject, fact, (subject, other, value), axiom)
        if fact in axioms.negative:
            self.clash(subject, fact, axioms.negative[fact])

    def filled(self, subject: Term, prop: Term, value: Term, fact: Fact) -> None:
        """The consequences of ``subject prop value`` for the restrictions on ``prop``."""
        axioms = self.axioms
        for restriction, axiom in axioms.has_value.get((prop, value), ()):
            self.add((subject, TYPE, restriction), fact, axiom)
        for restriction, filler, axiom in axioms.some.get(prop, ()):
            if filler == _THING:
                self.add((subject, TYPE, restriction), fact, axiom)
            elif filler in self.types[value]:
                self.add((subject, TYPE, restriction), fact, (value, TYPE, filler), axiom)
        for cls in tuple(self.types[subject]):
            for wanted, filler, axiom in axioms.only.get(cls, ()):
                if wanted == prop:
                    self.add((value, TYPE, filler), fact, (subject, TYPE, cls), axiom)

    def characteristic(self, subject: Term, prop: Term, value: Term, fact: Fact) -> None:
        """The consequences of ``prop`` being symmetric, transitive, asymmetric or irreflexive."""
        marks = self.axioms.marks
        if axiom := marks.get((prop, "SymmetricProperty")):
            self.add((value, prop, subject), fact, axiom)
        if axiom := marks.get((prop, "TransitiveProperty")):
            for further in self.out.get((value, prop), ()):
                self.add((subject, prop, further), fact, (value, prop, further), axiom)
            for before in self.into.get((prop, subject), ()):
                self.add((before, prop, value), (before, prop, subject), fact, axiom)
        if (axiom := marks.get((prop, "AsymmetricProperty"))) and (value, prop, subject) in self.premises:
            self.clash(subject, fact, (value, prop, subject), axiom)
        if (axiom := marks.get((prop, "IrreflexiveProperty"))) and subject == value:
            self.clash(subject, fact, axiom)

    def functional(self, subject: Term, prop: Term, value: Term, fact: Fact) -> None:
        """The consequences of ``prop`` being functional or inverse functional."""
        marks = self.axioms.marks
        if axiom := marks.get((prop, "FunctionalProperty")):
            for other in self.out[subject, prop]:
                self.equal(subject, value, other, fact, (subject, prop, other), axiom)
        if axiom := marks.get((prop, "InverseFunctionalProperty")):
            for other in self.into[prop, value]:
                self.equal(subject, subject, other, fact, (other, prop, value), axiom)

    def counted(self, subject: Term, prop: Term) -> None:
        """Hold the values of ``prop`` against every maximum that ``subject`` is under."""
        for cls in tuple(self.types[subject]):
            for wanted, most, qualifier, axiom in self.axioms.at_most.get(cls, ()):
                if wanted != prop:
                    continue
                because = ((subject, TYPE, cls), axiom)
                values = [
                    value
                    for value in dict.fromkeys(self.out.get((subject, prop), ()))
                    if qualifier in {None, _THING} or qualifier in self.types[value]
                ]
                counted = [
                    ((subject, prop, value), *(() if qualifier in {None, _THING} else ((value, TYPE, qualifier),)))
                    for value in values
                ]
                if most == 0 and values:
                    self.clash(subject, *counted[0], *because)
                for one, reasons in zip(values[1:], counted[1:], strict=True):
                    if most == 1:
                        self.equal(subject, values[0], one, *counted[0], *reasons, *because)

    def equal(self, about: Term, one: Term, other: Term, *premises: Fact) -> None:
        """Two names for one thing; two literals are never one."""
        if one == other:
            return
        if isinstance(one, Literal) or isinstance(other, Literal):
            if isinstance(one, Literal) and isinstance(other, Literal) and one.datatype == other.datatype:
                self.clash(about, *premises)
            return
        self.add((one, _SAME, other), *premises)
        self.add((other, _SAME, one), *premises)

    def same(self, one: Term, other: Term, fact: Fact) -> None:
        """Whatever holds of ``one`` holds of ``other``."""
        for group, axiom in self.axioms.different.get(one, ()):
            if other in group and other != one:
                self.clash(one, fact, axiom)
        self.out[one, _SAME].append(other)
        self.add((other, _SAME, one), fact)
        for known in tuple(self.about[one]):
            if known[1] != _SAME or known[2] != other:
                self.add((other, known[1], known[2]), known, fact)


def close(axioms: Axioms, facts: Iterable[Fact], assumed: Mapping[Fact, tuple[Fact, ...]] | None = None) -> Closure:
    """The closure of ``facts`` under ``axioms``."""
    closure = Closure(axioms)
    for fact in facts:
        closure.add(fact)
    for fact, because in axioms.facts:
        closure.add(fact, because)
    for fact, premises in (assumed or {}).items():
        closure.add(fact, *premises)
    for one, groups in axioms.different.items():
        for axiom in (axiom for group, axiom in groups if len(group) == 1):
            closure.clash(one, axiom)
    closure.run()
    return closure
