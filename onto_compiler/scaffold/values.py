"""What stands in the blocks of predicates and bindings: chosen terms, held against the ontology that is loaded."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from pyoxigraph import NamedNode

from onto_compiler.check.model import Model
from onto_compiler.problems import OntoError, near
from onto_compiler.rdf import CORE, OWL, PREFIXES, RDF
from onto_compiler.registered import GROUNDINGS, points
from onto_compiler.scaffold.names import WordedName
from onto_compiler.scaffold.sentences import holds_when
from onto_compiler.wording import counted

__all__ = ["Options", "Terms", "binding_values", "predicate_values"]

_UNITS = "SELECT ?this WHERE { ?this a qudt:Unit }"
_NOTATIONS = {
    "predicate": "?this a/rdfs:subClassOf* core:Predicate",
    "route": "?this a/rdfs:subClassOf* core:CorrectionRoute",
    "failure": "?this rdfs:subClassOf* core:Failure",
    "grounding": "?this a core:GroundingFunction",
}
_PREDICATES = "SELECT ?this WHERE { ?this a/rdfs:subClassOf* core:Predicate }"


@dataclass(frozen=True, slots=True)
class Options:
    """What a person may choose; names of terms are written with a prefix, and empty where nothing was chosen."""

    iri: str = ""
    kind: str = "man:ObjectRelation"
    admits: Sequence[str] = ("man:RelationMissing",)
    supports: Sequence[str] = ("man:ObjectRelation",)
    arity: int = 2
    domain: str = "man:Object"
    range: str = ""
    unit: str = "unit:M"
    grounded_by: str = ""
    lifts: str = ""
    native: str = ""
    definition: str = ""


@dataclass(frozen=True, slots=True)
class Terms:
    """The terms that are loaded, as a person names them; ``declared`` gets the prefixes that are used."""

    model: Model
    declared: dict[str, str]

    def a_class(self, term: str) -> str:
        """A class with its prefix; raises NEW005 for what is none."""
        return self._known(term, self._typed(OWL + "Class"), "class")

    def unit(self, term: str) -> str:
        """A unit with its prefix, which may be left out; raises NEW005 for one that no margin is given in."""
        named = term if ":" in term else f"unit:{term}"
        return self._known(named, self._found(_UNITS), "unit")

    def predicate(self, term: str) -> str:
        """A predicate with its prefix; raises NEW005 for what is none."""
        return self._known(term, self._found(_PREDICATES), "predicate")

    def grounding(self, name: str, arity: int) -> str:
        """The name of a registered or declared function of ``arity`` names; raises NEW005 or NEW006."""
        tests = {
            str(row["name"].value): int(row["tests"].value)
            for row in self.model.rows(
                "SELECT ?name ?tests WHERE { ?this a core:GroundingFunction ; skos:notation ?name ; core:tests ?tests }"
            )
        }
        known = {*tests, *(point.name for point in points(GROUNDINGS))}
        if name not in known:
            hint = near(name, known) or f"`onto new grounding {name}` begins one; register and declare it first"
            raise OntoError.of("NEW005", f"no grounding function is registered or declared as `{name}`", hint)
        if tests.get(name, arity) != arity:
            fitting = sorted(each for each, number in tests.items() if number == arity)
            raise OntoError.of(
                "NEW006",
                f"`{name}` tests {counted(tests[name], 'name')} and the new term has {counted(arity, 'argument')}",
                f"of that arity are {', '.join(fitting)}" if fitting else "begin one with `onto new grounding`",
            )
        return name

    def refuse_taken(self, kind: str, notation: str) -> None:
        """Raise NEW002 where another term of the ``kind`` has the notation; task files do not look at case."""
        if kind not in _NOTATIONS:
            return
        for row in self.model.rows(f"SELECT ?this ?name WHERE {{ {_NOTATIONS[kind]} ; skos:notation ?name }}"):
            if row["name"].value.lower() == notation:
                message = f"`{self._text(row['this'].value)}` has the notation `{row['name'].value}` already"
                raise OntoError.of("NEW002", message, "choose another name")

    def values(self, term: str, predicate: str) -> list[str]:
        """What a declared term says with a property of ``core:``: names with prefixes, or texts."""
        node, name = self._node(term), NamedNode(CORE + predicate)
        found = (quad.object for quad in self.model.store.quads_for_pattern(node, name, None, None))
        return [self._text(value.value) if isinstance(value, NamedNode) else str(value.value) for value in found]  # type: ignore[union-attr]

    def _known(self, term: str, known: Sequence[str], what: str) -> str:
        prefix = term.partition(":")[0]
        if self._node(term).value not in known:
            names = sorted(map(self._text, known))
            few = f"give one of {', '.join(names)}" if len(names) < 8 else f"give a declared {what} with its prefix"
            raise OntoError.of("NEW005", f"`{term}` is no {what} that is declared", near(term, names) or few)
        self.declared.setdefault(prefix, self._spaces[prefix])
        return term

    @property
    def _spaces(self) -> Mapping[str, str]:
        return {**PREFIXES, **self.declared}

    def _node(self, term: str) -> NamedNode:
        prefix, _, local = term.partition(":")
        iri = self._spaces.get(prefix, "urn:unknown:") + local
        try:
            return NamedNode(iri)
        except ValueError:
            return NamedNode("urn:unknown:term")

    def _text(self, iri: str) -> str:
        fitting = (
            f"{prefix}:{iri.removeprefix(space)}" for prefix, space in self._spaces.items() if iri.startswith(space)
        )
        return next(fitting, f"<{iri}>")

    def _typed(self, cls: str) -> list[str]:
        quads = self.model.store.quads_for_pattern(None, NamedNode(RDF + "type"), NamedNode(cls), None)
        return [quad.subject.value for quad in quads if isinstance(quad.subject, NamedNode)]

    def _found(self, query: str) -> list[str]:
        return [str(row["this"].value) for row in self.model.rows(query)]


def predicate_values(name: WordedName, options: Options, terms: Terms) -> dict[str, str]:
    """What the block of a predicate is filled with.

    Raises:
        OntoError: NEW005, NEW006.

    """
    if options.range and options.arity == 1:
        raise OntoError.of("NEW006", "`--range` is of the second argument, and there is one", "leave out --range")
    function = options.grounded_by or ("on_object" if options.arity > 1 else "")
    lines = [
        f"core:range {terms.a_class(options.range or 'man:Object')}" if options.arity > 1 else "",
        f"core:marginUnit {terms.unit(options.unit)}",
        f'core:groundedBy "{terms.grounding(function, options.arity)}"' if function else "",
    ]
    return {
        "kind": terms.a_class(options.kind),
        "definition": options.definition or holds_when(name, options.arity),
        "arity": str(options.arity),
        "domain": terms.a_class(options.domain),
        "optional": _lines(lines),
    }


def binding_values(name: WordedName, options: Options, terms: Terms) -> dict[str, str]:
    """What the block of a binding is filled with: the classes are those of the predicate that it lifts.

    Raises:
        OntoError: NEW005, NEW006.

    """
    if not options.lifts:
        raise OntoError.of("NEW006", "a binding lifts a predicate", "name one with --lifts, such as man:on")
    lifts = terms.predicate(options.lifts)
    classes = [*terms.values(lifts, "domain")[:1], *terms.values(lifts, "range")[:1]]
    function = options.grounded_by or next(iter(terms.values(lifts, "groundedBy")), "")
    if not function:
        raise OntoError.of("NEW006", f"nothing is said to measure `{lifts}`", "name a function with --grounded-by")
    orders = (row["number"].value for row in terms.model.rows("SELECT ?number WHERE { ?this core:order ?number }"))
    highest = max((int(float(order)) for order in orders if order.replace(".", "", 1).isdigit()), default=0)
    native = options.native or name.camel
    return {
        "native": native,
        "classes": " and ".join(classes),
        "arguments": _lines(
            [f"core:nativeArgument{place} {terms.a_class(each)}" for place, each in enumerate(classes, 1)]
        ),
        "lifts": lifts,
        "function": terms.grounding(function, len(classes)),
        "order": str(highest // 10 * 10 + 10),
    }


def _lines(parts: Iterable[str]) -> str:
    return "".join(f"    {part} ;\n" for part in parts if part)
