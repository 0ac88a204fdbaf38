"""Scaffolds in Turtle: a new file with a header, or a block behind what a file holds already."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from pyoxigraph import NamedNode

from onto_compiler.check.model import Model, load_model
from onto_compiler.problems import OntoError
from onto_compiler.rdf import BASE, CORE, OWL, PREFIXES, RDF, SH
from onto_compiler.scaffold import templates
from onto_compiler.scaffold.names import WordedName
from onto_compiler.scaffold.values import Options, Terms, binding_values, predicate_values
from onto_compiler.sources import graph_of
from onto_compiler.turtle.source_map import map_text

__all__ = ["Options", "added", "new_ontology"]

_TYPE, _ONTOLOGY, _IMPORTS = NamedNode(RDF + "type"), NamedNode(OWL + "Ontology"), NamedNode(OWL + "imports")
_PRIORITY_ORDER = 110  # sh:order of the rule that reads what failure rules conclude
_PREFIX_LINE = re.compile(r"(?im)^[ \t]*@?prefix[^\n]*\n")
_USED = re.compile(r"(?<![\w:<-])([a-z][\w-]*):(?=[\w])")
_STRING = re.compile(r'"""(?s:.)*?"""|"[^"\n]*"')


def new_ontology(name: WordedName, options: Options) -> str:
    """A file that holds an ontology header and nothing else.

    Raises:
        OntoError: NEW005 if the given IRI is none that an ontology can have.

    """
    iri = (options.iri or f"https://example.org/{name.snake}").rstrip("#/")
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9+.-]*:[^\s<>\"{}|\\^`]+", iri) or iri.startswith(BASE):
        hint = "write one of your own, e.g. https://example.org/kitchen"
        raise OntoError.of("NEW005", f"`{options.iri}` cannot be the IRI of a new ontology", hint)
    title = name.text.capitalize()
    header = templates.HEADER.format(iri=iri, title=title, text=name.text, creator=f"The {title} authors")
    return _with_prefixes("", header, {})


def added(kind: str, name: WordedName, path: Path, text: str, options: Options) -> str:
    """``text``, the file at ``path``, with a ``kind`` of term called ``name`` at its end.

    Raises:
        OntoError: what is wrong with the file (TTL0nn); NEW002 if the term or its notation exists; NEW003 if the file
            has not one header; NEW005 if an option names a term that does not exist; NEW006 if options do not fit.

    """
    path = path.resolve()
    model = _model(path, text)
    iri = _header(model, path)
    source_map = map_text(text, str(path), path.as_uri())
    declared = {prefix.name: prefix.namespace for prefix in source_map.declared}
    own = next((p for p, namespace in declared.items() if p and namespace in {f"{iri}#", f"{iri}/"}), "")
    if not own:
        own = _fresh_prefix(iri, {*declared, *PREFIXES})
        declared[own] = f"{iri}#"
    terms = Terms(model, declared)
    terms.refuse_taken(kind, name.snake)
    values = {"own": own, "iri": iri, "snake": name.snake, "camel": name.camel, "text": name.text}
    if kind == "predicate":
        block = templates.PREDICATE.format(**values, **predicate_values(name, options, terms))
    elif kind == "binding":
        block = templates.BINDING.format(**values, **binding_values(name, options, terms))
    elif kind == "grounding":
        block = templates.GROUNDING.format(arity=options.arity, **values)
    elif kind == "route":
        admits = " , ".join(terms.a_class(term) for term in options.admits)
        supports = " , ".join(terms.a_class(term) for term in options.supports)
        block = templates.ROUTE.format(admits=admits, supports=supports, **values)
    else:
        order, priority = _free_order(model), _free_priority(model)
        block = templates.FAILURE.format(order=order, priority=priority, **values)
        needed = {"core": CORE, "rdfs": PREFIXES["rdfs"], own: declared[own]}
        block = _declarations(model, iri, needed) + block
    _refuse_existing(model, block, own, declared[own])
    if not _imports(model, iri):
        block = f"<{iri}> owl:imports <{BASE}manipulation> .\n\n{block}"
    return _with_prefixes(text, block, declared)


def _model(path: Path, text: str) -> Model:
    """The file and its Turtle neighbours that it may import, before the shipped ontology."""
    beside = [other for other in sorted(path.parent.glob("*.ttl")) if other.resolve() != path]
    try:
        return load_model([path, *beside], {path: text})
    except OntoError as error:
        own = [problem for problem in error.problems if problem.file == str(path)]
        if own:
            raise OntoError(*own) from None
    return load_model([path], {path: text})


def _header(model: Model, path: Path) -> str:
    graph = graph_of(path)
    found = [_value(quad.subject) for quad in model.store.quads_for_pattern(None, _TYPE, _ONTOLOGY, graph)]
    if len(found) != 1:
        raise OntoError.of(
            "NEW003",
            f"`{path.name}` has {len(found)} ontology headers, so that it is not clear which defines a new term",
            "give a file with one header; `onto new ontology NAME` writes one",
            str(path),
        )
    return found[0]


def _value(term: object) -> str:
    """The text of a term; a quoted triple has none."""
    return str(getattr(term, "value", ""))


def _fresh_prefix(iri: str, taken: Iterable[str]) -> str:
    word = "_".join(re.findall(r"[a-z0-9]+", iri.rpartition("/")[2].lower())) or "own"
    word = word if word[0].isalpha() else f"o{word}"
    candidates = [word, *(f"{word}{number}" for number in range(2, 1000))]
    return next(each for each in candidates if each not in set(taken))


def _refuse_existing(model: Model, block: str, own: str, namespace: str) -> None:
    for local in re.findall(rf"(?m)^{re.escape(own)}:(\w+) a ", block):
        if next(model.store.quads_for_pattern(NamedNode(namespace + local), None, None, None), None) is not None:
            raise OntoError.of("NEW002", f"`{own}:{local}` exists already", "choose another name")


def _numbers(model: Model, query: str) -> set[int]:
    return {
        int(float(row["number"].value)) for row in model.rows(query) if re.fullmatch(r"[\d.]+", row["number"].value)
    }


def _free_order(model: Model) -> int:
    """An sh:order that no rule has, in front of the rules that read what a failure rule concludes."""
    taken = _numbers(model, "SELECT ?number WHERE { ?rule a sh:SPARQLRule ; sh:order ?number }")
    tens = [*range(60, _PRIORITY_ORDER, 10), *range(1, _PRIORITY_ORDER)]
    return next((number for number in tens if number not in taken), _PRIORITY_ORDER - 1)


def _free_priority(model: Model) -> int:
    taken = _numbers(model, "SELECT ?number WHERE { ?failure core:priority ?number }")
    return max(taken, default=0) // 10 * 10 + 10


def _declarations(model: Model, iri: str, needed: dict[str, str]) -> str:
    """What the header must say of the prefixes within rules, and does not say yet."""
    prefix = NamedNode(SH + "prefix")
    inherited = {
        _value(quad.object)
        for entry in model.store.quads_for_pattern(NamedNode(iri), NamedNode(SH + "declare"), None, None)
        for quad in model.store.quads_for_pattern(entry.object, prefix, None, None)  # type: ignore[arg-type]
    }
    lines = [
        templates.DECLARE.format(iri=iri, prefix=name, namespace=namespace)
        for name, namespace in needed.items()
        if name not in inherited
    ]
    return "".join(lines) + "\n" if lines else ""


def _imports(model: Model, iri: str) -> bool:
    """Whether the manipulation vocabulary is imported, directly or not."""
    waiting, seen = [iri], set()
    while waiting:
        one = waiting.pop()
        seen.add(one)
        found = {_value(quad.object) for quad in model.store.quads_for_pattern(NamedNode(one), _IMPORTS, None, None)}
        waiting += found - seen
    return f"{BASE}manipulation" in seen


def _with_prefixes(text: str, block: str, declared: dict[str, str]) -> str:
    """``text`` and behind it ``block``, with a declaration of each prefix that the block is the first to use."""
    newline = "\r\n" if "\r\n" in text else "\n"
    bare = _STRING.sub(lambda match: '"' if not match[0].startswith('"""') else "", block)
    spaces = {**PREFIXES, **declared}
    head = {match[1] for match in re.finditer(r"(?im)^[ \t]*@?prefix[ \t]+([\w.-]*):", text)}
    missing = sorted(name for name in set(_USED.findall(bare)) if name in spaces and name not in head)
    lines = "".join(f"@prefix {name}: <{spaces[name]}> .\n" for name in missing)
    last = max((match.end() for match in _PREFIX_LINE.finditer(text)), default=0)
    gap = "\n" if not text[:last] and lines else ""
    before, after = text[:last], text[last:]
    if after and not after.endswith("\n"):
        after += newline
    join = newline if after.strip() else ""
    return before + (lines + gap).replace("\n", newline) + after + join + block.replace("\n", newline)
