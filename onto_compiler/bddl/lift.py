"""The compiler's last pass: native atoms become typed facts (paper, section 3: phi_req).

Takes a task and the TBox; removes quantifiers, connectives and native names, introduces predicate and class IRIs. The
spans of atoms survive, so a finding about a fact still points into the task file.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from onto_compiler.bddl import codes
from onto_compiler.bddl.ast import Atom, Symbol, TaskSpec, atoms
from onto_compiler.bddl.dialects import LIBERO, dialect_of
from onto_compiler.bddl.impossible import impossible
from onto_compiler.bddl.lint import lint
from onto_compiler.bddl.literals import goal_of
from onto_compiler.bddl.scope import Named, Scope, scope_of
from onto_compiler.problems import OntoError, Problem, near
from onto_compiler.required import Entity, Fact, NativeAtom, RequiredABox
from onto_compiler.schema import Binding, JointThreshold, PredicateSignature, Schema, local_name
from onto_compiler.wording import plural

__all__ = ["lift", "lift_atom", "required_abox"]


def required_abox(spec: TaskSpec, schema: Schema, task: str) -> RequiredABox:
    """The facts that ``spec`` requires, under the name ``task``; warnings are dropped (see :func:`lift`).

    Raises:
        OntoError: the goal does not lift.

    """
    return lift(spec, schema, task)[0]


def lift(spec: TaskSpec, schema: Schema, task: str) -> tuple[RequiredABox, tuple[Problem, ...]]:
    """The facts that ``spec`` requires, and warnings: the initial facts that do not lift, and what :func:`lint` finds.

    Raises:
        OntoError: the goal does not lift; carries the warnings too.

    """
    scope = scope_of(spec, schema)
    lifter, initial = _Lifter(schema, scope, spec.domain), _Lifter(schema, scope, spec.domain, premise=True)
    wanted, problems = goal_of(spec)
    goal = [lifter.fact(atom, polarity=polarity) for atom, polarity in wanted.literals]
    premise = [initial.fact(atom, polarity=True) for atom in spec.init]
    premise += [initial.fact(atom, polarity=False) for atom in spec.absent]
    if problems:
        # What could not be written out is not among the literals, and its predicates may lack a binding too.
        goal += [_Result(problems=lifter.unbound(atom)) for atom in atoms(spec.goal)]
    # One atom under a quantifier gives one problem, however many instances it was ground with.
    errors = list(dict.fromkeys([*problems, *(problem for result in goal for problem in result.problems)]))
    findings = [replace(problem, severity="warning") for result in premise for problem in result.problems]
    warnings = tuple(sorted({*findings, *lint(spec, None if problems else wanted)}))
    if errors:
        raise OntoError(*errors, *warnings)
    abox = RequiredABox(
        task=task,
        language=spec.language,
        problem=spec.problem,
        facts=tuple(result.fact for result in goal if result.fact is not None),
        premise=tuple(result.fact for result in premise if result.fact is not None),
        source=spec.file,
        alternatives=wanted.alternatives,
    )
    return abox, _with_impossible(abox, schema, warnings)


def _with_impossible(abox: RequiredABox, schema: Schema, warnings: tuple[Problem, ...]) -> tuple[Problem, ...]:
    """What the typed facts exclude, where the atoms alone did not show it."""
    if any(each.code in {codes.CONTRADICTION, codes.ITSELF, codes.OPPOSITES} for each in warnings):
        return warnings
    return tuple(sorted({*warnings, *(replace(each, severity="warning") for each in impossible(abox, schema))}))


def lift_atom(atom: Atom, scope: Scope, schema: Schema, domain: str, *, polarity: bool) -> Fact | None:
    """One atom over the names of a task as a goal would have it; None if it does not lift."""
    return _Lifter(schema, scope, domain).fact(atom, polarity=polarity).fact


@dataclass(frozen=True, slots=True)
class _Result:
    """A fact, or the problems that kept an atom from becoming one."""

    fact: Fact | None = None
    problems: tuple[Problem, ...] = ()


@dataclass(frozen=True, slots=True)
class _Lifter:
    schema: Schema
    scope: Scope
    domain: str
    premise: bool = False

    def fact(self, atom: Atom, *, polarity: bool) -> _Result:
        """Lift one atom; an atom with several faults has a problem for each."""
        bindings, direct = self.candidates(atom.predicate)
        unbound = self.unbound(atom)
        if unbound and self.foreign:
            return _Result(problems=unbound)
        signatures = [each.arguments for each in bindings] or ([direct.parameters] if direct else [])
        problems = [problem for symbol in atom.arguments for problem in self.unknown_name(symbol)]
        count = len(atom.arguments)
        if unbound:
            problems += unbound
        elif count not in {len(each) for each in signatures} and not (direct and count == len(direct.parameters)):
            problems.append(_wrong_count(atom, signatures))
        if problems or any(symbol.name.startswith("?") for symbol in atom.arguments):
            return _Result(problems=tuple(problems))
        named = [self.scope.names[symbol.name] for symbol in atom.arguments]
        for binding in bindings:
            if self.fits(named, binding.arguments) and (entities := self.arguments(named, binding)) is not None:
                return self.bound(atom, binding, named[0], entities, polarity=polarity)
        if direct and self.fits(named, direct.parameters):
            return self.direct(atom, direct, named, polarity=polarity)
        return _Result(problems=(self.wrong_types(atom, named, signatures),))

    @property
    def foreign(self) -> bool:
        """Whether the domain's predicates share no more than names with ours, so that each needs a binding."""
        return dialect_of(self.domain) is not LIBERO

    def candidates(self, predicate: str) -> tuple[list[Binding], PredicateSignature | None]:
        """What may lift the atoms of ``predicate``: bindings in their order, and the predicate of that name."""
        name = predicate.casefold()
        bindings = [
            each
            for each in self.schema.bindings
            if each.native.casefold() == name and (each.domain == self.domain or not (each.domain or self.foreign))
        ]
        return bindings, None if self.foreign else self.schema.predicate_named(name)

    def unbound(self, atom: Atom) -> tuple[Problem, ...]:
        """A problem where nothing can lift the atoms of this predicate."""
        bindings, direct = self.candidates(atom.predicate)
        if bindings or direct:
            return ()
        return (self.no_binding(atom) if self.foreign else self.unknown_predicate(atom),)

    def fits(self, named: Sequence[Named], classes: Sequence[str]) -> bool:
        """Whether each argument is of the class at its place, and their numbers agree."""
        return len(named) == len(classes) and all(
            self.schema.is_a(each.entity.type, cls) for each, cls in zip(named, classes, strict=True)
        )

    # With a binding

    def arguments(self, named: Sequence[Named], binding: Binding) -> tuple[Entity, ...] | None:
        """The lifted arguments as ``binding`` has them, thresholds apart; None if its landmark is not there."""
        if binding.landmark is None:
            return tuple(each.entity for each in named[: 1 if binding.threshold else None])
        region = named[1].region if len(named) > 1 else None
        match = binding.landmark.fullmatch(region.name) if region is not None else None
        landmark = self.scope.landmark(match["landmark"]) if match is not None else None
        return None if landmark is None else (named[0].entity, landmark)

    def bound(
        self, atom: Atom, binding: Binding, first: Named, entities: tuple[Entity, ...], *, polarity: bool
    ) -> _Result:
        if binding.threshold:
            threshold = self.threshold(first.category, atom.predicate)
            if threshold is None:
                return _Result(problems=(self.no_threshold(atom, first),))
            entities = (*entities, Entity(local_name(threshold.iri), threshold.iri))
        signature = self.schema.predicates[binding.lifts]
        # A threshold is an individual of the TBox, not of the scene: the shapes of the TBox check its class.
        checked = entities[:-1] if binding.threshold else entities
        agree = all(
            self.schema.is_a(entity.type, cls) for entity, cls in zip(checked, signature.parameters, strict=False)
        )
        if len(entities) != len(signature.parameters) or not agree:
            message = (
                f"`{binding.native}` lifts to `{_signature(signature.name, signature.parameters)}`, "
                f"which does not take {_types(entities)}"
            )
            hint = f"correct the binding `{local_name(binding.iri)}` or the predicate's parameters"
            return _Result(problems=(Problem.at(atom.span, codes.ARGUMENT_TYPE, message, hint),))
        grounded_by = (self.premise and binding.premise_grounded_by) or binding.grounded_by
        fact = _fact(atom, signature.iri, entities, grounded_by, polarity=polarity)
        needed = -max(binding.premise_tolerance, 0.0) if self.premise else binding.goal_margin
        return _Result(replace(fact, threshold=needed) if needed else fact)

    def threshold(self, category: str, native: str) -> JointThreshold | None:
        """The threshold of ``category`` for ``native``; predicates are compared without case."""
        folded = native.casefold()
        return next(
            (
                threshold
                for (owner, predicate), threshold in self.schema.thresholds.items()
                if owner == category and predicate.casefold() == folded
            ),
            None,
        )

    # Without one

    def direct(self, atom: Atom, signature: PredicateSignature, named: Sequence[Named], *, polarity: bool) -> _Result:
        if signature.grounded_by is None:
            message = f"`{signature.name}` has no grounding: nothing says how to tell whether it holds"
            hint = "declare a binding for it, or name its grounding function in the TBox"
            return _Result(problems=(Problem.at(atom.name_span, codes.NO_GROUNDING, message, hint),))
        entities = tuple(each.entity for each in named)
        return _Result(_fact(atom, signature.iri, entities, signature.grounded_by, polarity=polarity))

    # Problems

    def no_binding(self, atom: Atom) -> Problem:
        message = f"`{atom.predicate}` of the domain `{self.domain}` has no binding"
        hint = f'declare a core:Binding with core:native "{atom.predicate}" and core:nativeDomain "{self.domain}"'
        return Problem.at(atom.name_span, codes.NO_BINDING, message, hint)

    def unknown_name(self, symbol: Symbol) -> Iterator[Problem]:
        if symbol.name in self.scope.names or symbol.name.startswith("?"):
            return  # a variable that nothing binds has a problem already
        orphan = self.scope.orphans.get(symbol.name)
        if orphan is not None:
            message = f"`{symbol.name}` is a region of `{orphan.target.name}`, which is not declared"
            yield Problem.at(symbol.span, codes.UNDECLARED_TARGET, message, f"declare `{orphan.target.name}`")
            return
        message = f"`{symbol.name}` is not an object, fixture or region of this task"
        hint = near(symbol.name, [*self.scope.names, *self.scope.orphans]) or self.bare_region(symbol.name)
        yield Problem.at(symbol.span, codes.UNKNOWN_NAME, message, hint)

    def bare_region(self, name: str) -> str:
        """A hint for a region that is named without its target."""
        sites = [
            site for site, each in self.scope.names.items() if each.region is not None and each.region.name == name
        ]
        return f"a region is named with its target: `{sites[0]}`" if sites else ""

    def unknown_predicate(self, atom: Atom) -> Problem:
        known = {each.native for each in self.schema.bindings} | {
            each.name for each in self.schema.predicates.values() if each.grounded_by is not None
        }
        # Compared without case, and shown as the ontology spells it.
        spelling = {name.casefold(): name for name in sorted(known)}
        hint = near(atom.predicate.casefold(), spelling)
        for folded, name in spelling.items():
            hint = hint.replace(f"`{folded}`", f"`{name}`")
        return Problem.at(
            atom.name_span,
            codes.UNKNOWN_PREDICATE,
            f"`{atom.predicate}` is not a predicate of the ontology",
            hint or f"predicates are {', '.join(f'`{name}`' for name in sorted(known))}",
        )

    def wrong_types(self, atom: Atom, named: Sequence[Named], signatures: Sequence[tuple[str, ...]]) -> Problem:
        candidates = [each for each in signatures if len(each) == len(named)]
        places = [
            next(
                (i for i, cls in enumerate(classes) if not self.schema.is_a(named[i].entity.type, cls)),
                len(named),
            )
            for classes in candidates
        ]
        place = max(places, default=0)
        span = atom.arguments[place].span if place < len(named) else atom.span
        message = f"`{atom.predicate}` does not take {_types([each.entity for each in named])}"
        hint = f"it takes {_shown(atom.predicate, signatures)}"
        wrong = named[place] if place < len(named) else None
        if wrong is not None and wrong.region is None and wrong.category not in self.schema.categories:
            hint += f"; nothing says which class a `{wrong.category}` is of: declare a core:Category"
        return Problem.at(span, codes.ARGUMENT_TYPE, message, hint)

    def no_threshold(self, atom: Atom, first: Named) -> Problem:
        folded = atom.predicate.casefold()
        others = sorted(owner for owner, native in self.schema.thresholds if native.casefold() == folded)
        message = f"no threshold says when a `{first.category}` counts as `{atom.predicate}`"
        known = f"; declared for {', '.join(f'`{each}`' for each in others)}" if others else ""
        return Problem.at(
            atom.arguments[0].span, codes.NO_THRESHOLD, message, f"declare one for the category in the TBox{known}"
        )


def _fact(atom: Atom, predicate: str, entities: tuple[Entity, ...], grounded_by: str, *, polarity: bool) -> Fact:
    native = NativeAtom(atom.predicate, tuple(symbol.name for symbol in atom.arguments))
    return Fact(predicate, entities, native, grounded_by, polarity=polarity, span=atom.span)


def _wrong_count(atom: Atom, signatures: Sequence[tuple[str, ...]]) -> Problem:
    expected = sorted({len(each) for each in signatures})
    counts = " or ".join(map(str, expected))
    message = f"`{atom.predicate}` takes {counts} {plural(expected[-1], 'argument')}, found {len(atom.arguments)}"
    return Problem.at(atom.span, codes.ARGUMENT_COUNT, message, f"write {_shown(atom.predicate, signatures)}")


def _shown(name: str, signatures: Sequence[tuple[str, ...]]) -> str:
    """Each signature once, in the order of the bindings."""
    return " or ".join(dict.fromkeys(f"`{_signature(name, classes)}`" for classes in signatures))


def _signature(name: str, classes: Sequence[str]) -> str:
    return f"{name}({', '.join(map(local_name, classes))})"


def _types(entities: Sequence[Entity]) -> str:
    return ", ".join(f"`{entity.name}` ({local_name(entity.type)})" for entity in entities) or "no arguments"
