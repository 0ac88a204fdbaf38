"""Whether an ontology contradicts itself: its OWL 2 RL closure, with one assumed instance of each class.

A clash at an assumed instance means that its class can have none. What two of the SPARQL checks say already, of
disjoint classes and subclasses alone (OWL005, OWL006), is left to them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import cast

from pyoxigraph import Literal, NamedNode

from onto_compiler.check.finding import Finding
from onto_compiler.check.model import Model
from onto_compiler.rdf import OWL, RDF, RDFS, SH, shorten
from onto_compiler.reasoning.axioms import TYPE, Axioms, Fact, Term, owl
from onto_compiler.reasoning.closure import close
from onto_compiler.reasoning.lean import contentious, lean, representatives

__all__ = ["check_consistency"]

_ASSUMED = "urn:onto-evwm:some:"
_SUBCLASS = RDFS + "subClassOf"
_SAID_ELSEWHERE = {TYPE.value, _SUBCLASS, OWL + "disjointWith", OWL + "members"}
_THING = owl("Thing")
_SCHEMA = (OWL, RDFS, SH)
_WORDS = {
    _SUBCLASS: "{} is under {}",
    OWL + "equivalentClass": "{} is {}",
    OWL + "disjointWith": "{} and {} are disjoint",
    OWL + "complementOf": "{} is what is not {}",
    RDFS + "domain": "what has {} is {}",
    RDFS + "range": "a value of {} is {}",
    OWL + "inverseOf": "{} is the inverse of {}",
    RDFS + "subPropertyOf": "{} implies {}",
    OWL + "differentFrom": "{} and {} are different",
}


def check_consistency(model: Model) -> Iterator[Finding]:
    """One finding for each class without possible instances, and for each contradiction between given facts."""
    axioms = model.axioms
    classes = [quad.subject for quad in model.store.quads_for_pattern(None, TYPE, owl("Class"), None)]
    named = {cls for cls in classes if isinstance(cls, NamedNode)}
    if _THING in axioms.above or _THING in axioms.disjoint:
        named.add(_THING)  # of everything, one instance is enough: what else there is, is under it
    suspects = _suspects(model, axioms, named)
    if suspects is None:
        return
    closure = close(axioms, _facts(model, axioms.properties), _instances(suspects))
    empty: dict[NamedNode, tuple[Fact, ...]] = {}
    reported: set[frozenset[Fact]] = set()
    for clash in closure.clashes:
        given = closure.given(clash.premises)
        # Of a class that is disjoint with itself, or with everything, nothing is said elsewhere.
        pair = len(clash.premises) > 2
        if pair and all(one[1].value in _SAID_ELSEWHERE and owl("Nothing") not in one for one in given):
            continue
        about = {part.value for fact in given for part in fact if _is_assumed(part)}
        real = tuple(fact for fact in given if not any(map(_is_assumed, fact)))
        if len(about) == 1:
            empty.setdefault(NamedNode(about.pop().removeprefix(_ASSUMED)), real)
        elif not about and frozenset(given) not in reported:
            reported.add(frozenset(given))
            yield _contradiction(model, given)
    for cls, given in empty.items():
        above = closure.types[NamedNode(_ASSUMED + cls.value)] - {cls}
        twins = {one for one in above if cls in closure.types[NamedNode(_ASSUMED + _text(one))]}
        if not (above - twins) & empty.keys():  # a subclass of an empty class is empty for the same reason
            yield _empty_class(model, cls, given)


def _suspects(model: Model, axioms: Axioms, classes: set[NamedNode]) -> set[NamedNode] | None:
    """The classes that may have no instances; None if nothing clashes at all.

    One instance for each different set of classes that matter is enough to know: whatever clashes at an instance also
    clashes at another that is under no less.
    """
    upper = contentious(axioms, classes)
    stand_ins = cast("list[NamedNode]", representatives(axioms, upper, classes))
    closure = close(lean(axioms), _facts(model, axioms.properties), _instances(stand_ins))
    if not closure.clashes:
        return None
    about = {
        NamedNode(part.value.removeprefix(_ASSUMED))
        for clash in closure.clashes
        for fact in closure.given(clash.premises)
        for part in fact
        if _is_assumed(part)
    }
    clashing = {upper[one] for one in about}
    return {cls for cls in classes if upper[cls] and any(upper[cls] <= one for one in clashing)}


def _instances(classes: Iterable[NamedNode]) -> dict[Fact, tuple[Fact, ...]]:
    return {(NamedNode(_ASSUMED + cls.value), TYPE, cls): () for cls in classes}


def _facts(model: Model, properties: set[Term]) -> Iterator[Fact]:
    for quad in model.store.quads_for_pattern(None, TYPE, None, None):
        if not _text(cast("Term", quad.object)).startswith(_SCHEMA):
            yield cast("Fact", (quad.subject, quad.predicate, quad.object))
    for prop in (*properties, owl("sameAs")):
        if isinstance(prop, NamedNode) and not prop.value.startswith(RDF):
            for quad in model.store.quads_for_pattern(None, prop, None, None):
                yield cast("Fact", (quad.subject, quad.predicate, quad.object))


def _is_assumed(term: Term) -> bool:
    return isinstance(term, NamedNode) and term.value.startswith(_ASSUMED)


def _text(term: Term) -> str:
    return term.value


def _empty_class(model: Model, cls: NamedNode, given: tuple[Fact, ...]) -> Finding:
    because, values = _because(given)
    own = [fact for fact in given if fact[0] == cls] or [fact for fact in given if _is_reported(model, fact)]
    at = own[0] if own else None
    return Finding(
        "OWL010",
        "error",
        f"`{{empty}}` can have no instance: {because}",
        "one of these axioms is wrong: correct it, or remove it",
        cls if at is None or at[0] == cls else at[0],
        None if at is None else at[1],
        None if at is None else at[2],
        values={**values, "empty": cls},
        general=True,
    )


def _contradiction(model: Model, given: tuple[Fact, ...]) -> Finding:
    because, values = _because(given)
    here = [fact for fact in given if _is_reported(model, fact)]
    facts = [fact for fact in here if not _text(fact[1]).startswith(_SCHEMA)]
    related = [fact for fact in facts if fact[1] != TYPE]
    at: Fact = (related or facts or here or list(given))[0]
    return Finding(
        "OWL009",
        "error",
        f"these cannot all hold: {because}",
        "one of them is wrong: correct it, or remove it",
        at[0],
        at[1],
        at[2],
        values=values,
        general=True,
    )


def _is_reported(model: Model, fact: Fact) -> bool:
    subject, predicate, value = fact
    quads = model.store.quads_for_pattern(subject, predicate, value, None)  # type: ignore[arg-type]
    return any(quad.graph_name in model.graphs for quad in quads)


def _because(given: tuple[Fact, ...]) -> tuple[str, dict[str, Term | str]]:
    """The triples as sentences, in which a slot such as ``{t3}`` stands for each named term."""
    slots: dict[Term, str] = {}

    def name(term: Term) -> str:
        if isinstance(term, NamedNode):
            return f"`{{{slots.setdefault(term, f't{len(slots)}')}}}`"
        return '"' + term.value.replace("{", "(").replace("}", ")") + '"' if isinstance(term, Literal) else "[...]"

    text = "; ".join(dict.fromkeys(_sentence(fact, name) for fact in given))
    return text, {slot: term for term, slot in slots.items()}


def _sentence(fact: Fact, name: Callable[[Term], str]) -> str:
    subject, predicate, value = fact
    if predicate == TYPE:
        mark = _text(value).removeprefix(OWL)
        if mark != _text(value):
            return f"{name(subject)} is {mark.removesuffix('Property').lower()}"
        return f"{name(subject)} is a {name(value)}"
    if predicate == owl("members"):
        return "an owl:AllDisjointClasses holds them apart"
    if words := _WORDS.get(_text(predicate)):
        return words.format(name(subject), name(value))
    if _text(predicate).startswith(OWL):
        return f"{shorten(_text(predicate))} {name(value)}"
    return f"{name(subject)} {name(predicate)} {name(value)}"
