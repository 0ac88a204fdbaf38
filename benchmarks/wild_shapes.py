"""From a number to shapes and data in Turtle: what SHACL Core, SHACL-SPARQL and SHACL-AF know, drawn at random.

Every name, path and value comes from small pools that shapes and data share, so that most constraints meet values that
fulfil them and values that do not. One node of the data is blank, and each shape without a name has a label: both
engines then speak of the same terms.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from benchmarks.wild_queries import COMPONENTS, CONSTRAINTS, EXPRESSIONS, FUNCTIONS, RULES, TARGET_TYPES, TARGETS

__all__ = ["KINDS", "PREFIXES", "Pair", "pair"]

PREFIXES = """@prefix ex: <https://example.org/> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
"""
_DECLARED = (
    'ex:prefixes a owl:Ontology ; sh:declare [ sh:prefix "ex" ; sh:namespace "https://example.org/"^^xsd:anyURI ] ,\n'
    '    [ sh:prefix "xsd" ; sh:namespace "http://www.w3.org/2001/XMLSchema#"^^xsd:anyURI ] .\n'
)
NAMES = ("ex:a", "ex:b", "ex:c", "ex:d")
NODES = (*NAMES, "_:x")
CLASSES = ("ex:A", "ex:B", "ex:C")
PROPERTIES = ("ex:p", "ex:q", "ex:r", "ex:s")
NUMBERS = ("0", "1", "2", "3", "-1", "1.5", "2.0", "1.0e0", "2e0", '"3"^^xsd:byte', '"2"^^xsd:nonNegativeInteger')
TEXTS = ('"a"', '"ab"', '"Abc"', '"a\\nb"', '""', '"a b"', '"a"@en', '"b"@en-GB', '"c"@de', '"ab"@en', '"a"@EN')
TIMES = (
    *('"2020-02-29"^^xsd:date', '"2021-01-01"^^xsd:date', '"2020-01-01T00:00:00"^^xsd:dateTime'),
    *('"2020-01-01T00:00:00Z"^^xsd:dateTime', '"2020-01-01T03:00:00+02:00"^^xsd:dateTime'),
    *('"10:00:00"^^xsd:time', '"12:30:00"^^xsd:time', '"P1D"^^xsd:dayTimeDuration', '"PT36H"^^xsd:dayTimeDuration'),
    *('"P1Y"^^xsd:yearMonthDuration', '"2020"^^xsd:gYear'),
)
BOOLEANS = ("true", "false", '"1"^^xsd:boolean', '"0"^^xsd:boolean')
FORMS = (
    *(
        '"007"^^xsd:integer',
        "1.50",
        "1.5",
        '"+7"^^xsd:integer',
        "7",
        "1.0E1",
        "1e1",
        "10",
        "1e400",
        '"INF"^^xsd:double',
        '"NaN"^^xsd:double',
    ),
    *('"01"^^xsd:byte', '"300"^^xsd:byte', '"-0"^^xsd:integer', '"0.10"^^xsd:decimal', '"+01"^^xsd:integer'),
    *('"many"^^xsd:integer', '"yes"^^xsd:boolean', '"2020-13-01"^^xsd:date', '"2021-02-29"^^xsd:date', '"x"^^ex:type'),
    *('"http://a b"^^xsd:anyURI', '"http://a"^^xsd:anyURI', '"0aFf"^^xsd:hexBinary', '"0g"^^xsd:hexBinary'),
    *('"a b"^^xsd:token', '"-1"^^xsd:nonNegativeInteger', '"2020-01-01T24:00:00"^^xsd:dateTime', '"1"', '"1"@en'),
)
TRIPLES = tuple(f"<<( {one} ex:p {other} )>>" for one in ("ex:a", "ex:b") for other in ("1", "ex:c", '"x"@en'))
DATATYPES = (
    *("integer", "string", "decimal", "double", "boolean", "date", "dateTime", "byte", "nonNegativeInteger", "time"),
    *("anyURI", "hexBinary", "token", "dayTimeDuration", "gYear"),
)
KINDS_OF_NODES = ("IRI", "Literal", "BlankNode", "BlankNodeOrIRI", "BlankNodeOrLiteral", "IRIOrLiteral")
_TAGS = ('"en"', '"de"', '"en-GB"', '"EN"', '"fr"')
PATTERNS = ("^a", "b$", "^[A-Z]", "a.b", "^.{2}$", "^$", "\\\\d+", "example", "A b", "(a|b)c", "^\\\\s*[ab]+\\\\s*$")
RANGES = ("minInclusive", "maxInclusive", "minExclusive", "maxExclusive")


@dataclass(frozen=True, slots=True)
class Pair:
    """Shapes and data, by file: ``shapes.ttl`` and ``data.ttl``, and others that these import."""

    number: int
    kind: str
    files: Mapping[str, str]


@dataclass(slots=True)
class Draw:
    """Random choices, and what has been written so far: ``blocks`` are top-level blocks of the shapes graph."""

    rng: random.Random
    literals: Sequence[str]
    parts: Sequence[Part]
    paths: bool = False
    depth: int = 2
    blocks: list[str] = field(default_factory=list)
    shapes: int = 0
    loops: tuple[str, ...] = ()  # names of shapes that any shape may refer to

    def one(self, *options: str) -> str:
        """One of ``options``."""
        return self.rng.choice(options)

    def value(self) -> str:
        """A value as data have them, no blank node."""
        return self.rng.choice((*NAMES, *self.literals, *self.literals))

    def property(self) -> str:
        """A property of the data."""
        return self.rng.choice(PROPERTIES)

    def many(self, pool: Callable[[], str], least: int, most: int) -> str:
        """Some of what ``pool`` gives, between spaces."""
        return " ".join(pool() for _ in range(self.rng.randint(least, most)))


Part = tuple[str, Callable[[Draw, bool], str]]  # parameter, and what it writes of it on a shape with a path or without


def path(draw: Draw, depth: int = 2) -> str:
    """A property path."""
    form = draw.rng.randrange(8) if depth else 0
    if form < 2:
        return draw.property()
    inner = [path(draw, depth - 1) for _ in range(2)]
    match form:
        case 2 | 3:
            return f"[ sh:inversePath {inner[0]} ]"
        case 4:
            return f"( {inner[0]} {inner[1]} )"
        case 5:
            return f"[ sh:alternativePath ( {inner[0]} {inner[1]} ) ]"
        case _:
            return f"[ sh:{draw.one('zeroOrMorePath', 'oneOrMorePath', 'zeroOrOnePath')} {inner[0]} ]"


def shape(draw: Draw, *, on_path: bool, own: str = "") -> str:
    """The properties of a shape between brackets or of a block; ``own`` stands before its constraints."""
    draw.shapes += 1
    written = [own] if own else [f'rdfs:label "{draw.shapes}"']
    if on_path:
        written.append(f"sh:path {path(draw) if draw.paths else draw.property()}")
    chosen = dict(draw.rng.choices(draw.parts, k=draw.rng.randint(1, 3)))
    written += [write(draw, on_path) for write in chosen.values()]
    if draw.rng.random() < 0.15:
        written.append(f"sh:severity {draw.one('sh:Warning', 'sh:Info', 'ex:Grave')}")
    if draw.rng.random() < 0.05:
        written.append(f"sh:deactivated {draw.one('true', 'false')}")
    return " ; ".join(one for one in written if one)


def nested(draw: Draw, *, on_path: bool = False) -> str:
    """A reference to another shape: between brackets, or by a name of its own."""
    if draw.loops and draw.rng.random() < 0.3 and not on_path:
        return draw.one(*draw.loops)
    if draw.depth == 0:
        draw.shapes += 1
        plain = (
            f"sh:class {draw.one(*CLASSES)}" if draw.parts is OPAQUE else f"sh:nodeKind sh:{draw.one(*KINDS_OF_NODES)}"
        )
        simple = f'rdfs:label "{draw.shapes}" ; {plain}'
        return f"[ {simple} ; sh:path {draw.property()} ]" if on_path else f"[ {simple} ]"
    draw.depth -= 1
    name = f"ex:Shape_{draw.shapes}"
    text = shape(draw, on_path=on_path)
    draw.depth += 1
    if draw.rng.random() < 0.2:
        draw.blocks.append(f"{name} a sh:{'PropertyShape' if on_path else 'NodeShape'} ; {text} .")
        return name
    return f"[ {text} ]"


def _of(name: str, write: Callable[[Draw], str], *, on_path: bool = False) -> Part:
    """A parameter whose value ``write`` gives; ``on_path`` where only a property shape may have it."""
    return name, lambda draw, path: f"sh:{name} {write(draw)}" if path or not on_path else ""


def _count(draw: Draw) -> str:
    return str(draw.rng.randrange(3))


def _listed(draw: Draw) -> str:
    return f"( {draw.many(draw.value, 0, 5)} )"


def _shapes(draw: Draw) -> str:
    return f"( {draw.many(lambda: nested(draw), 1, 3)} )"


def _closed(draw: Draw, _: bool) -> str:  # noqa: FBT001 - a part's signature
    ignored = f" ; sh:ignoredProperties ( {draw.many(draw.property, 0, 2)} rdf:type )"
    property_shape = f' ; sh:property [ rdfs:label "c{draw.shapes}" ; sh:path {draw.property()} ]'
    return f"sh:closed {draw.one('true', 'true', 'false')}" + draw.one("", ignored) + draw.one("", property_shape)


def _qualified(draw: Draw, on_path: bool) -> str:  # noqa: FBT001 - a part's signature
    if not on_path:
        return ""
    disjoint = draw.one("", " ; sh:qualifiedValueShapesDisjoint true")
    bounds = draw.one(f"sh:qualifiedMinCount {_count(draw)}", f"sh:qualifiedMaxCount {_count(draw)}")
    return f"sh:qualifiedValueShape {nested(draw)} ; {bounds}{disjoint}"


def _pattern(draw: Draw, _: bool) -> str:  # noqa: FBT001 - a part's signature
    return f'sh:pattern "{draw.one(*PATTERNS)}"' + draw.one("", "", ' ; sh:flags "i"')


def _custom(draw: Draw, on_path: bool) -> str:  # noqa: FBT001 - a part's signature
    name = draw.one(*COMPONENTS)
    text, use = COMPONENTS[name]
    if text not in draw.blocks:
        draw.blocks.append(text)
    fits = on_path or "$PATH" not in text or "nodeValidator" in text
    return use.format(p=draw.property(), v=draw.value(), n=_count(draw)) if fits else ""


def _sparql(draw: Draw, on_path: bool) -> str:  # noqa: FBT001 - a part's signature
    query = draw.one(*(one for one in CONSTRAINTS if on_path or "$PATH" not in one))
    return f"sh:sparql [ sh:prefixes ex:prefixes ; sh:select '''{_filled(draw, query)}''' ]"


def _expression(draw: Draw, _: bool) -> str:  # noqa: FBT001 - a part's signature
    if FUNCTIONS not in draw.blocks:
        draw.blocks.append(FUNCTIONS)
    return f"sh:expression {_filled(draw, draw.one(*EXPRESSIONS))}"


def _filled(draw: Draw, text: str) -> str:
    names = {
        "p": draw.property(),
        "q": draw.property(),
        "n": _count(draw),
        "c": draw.one(*CLASSES),
        "v": draw.value().replace("\\", "\\\\"),
    }
    for name, value in names.items():
        text = text.replace(f"@{name}@", value)
    return text


TERMS: tuple[Part, ...] = (
    _of("class", lambda draw: draw.one(*CLASSES)),
    _of("datatype", lambda draw: f"xsd:{draw.one(*DATATYPES)}"),
    _of("nodeKind", lambda draw: f"sh:{draw.one(*KINDS_OF_NODES)}"),
    _of("in", _listed),
    _of("hasValue", Draw.value),
)
COUNTS = (_of("minCount", _count, on_path=True), _of("maxCount", _count, on_path=True))
TEXT: tuple[Part, ...] = (
    *(_of(name, lambda draw: str(draw.rng.randrange(5))) for name in ("minLength", "maxLength")),
    ("pattern", _pattern),
    _of("languageIn", lambda draw: f"( {draw.many(lambda: draw.one(*_TAGS), 1, 2)} )"),
    _of("uniqueLang", lambda draw: draw.one("true", "true", "false"), on_path=True),
)
ORDER: tuple[Part, ...] = tuple(_of(name, lambda draw: draw.one(*NUMBERS, *TIMES, *FORMS[:8])) for name in RANGES)
PAIRS: tuple[Part, ...] = (
    *(_of(name, Draw.property) for name in ("equals", "disjoint")),
    *(_of(name, Draw.property, on_path=True) for name in ("lessThan", "lessThanOrEquals")),
)
LOGIC: tuple[Part, ...] = (
    *(_of(name, _shapes) for name in ("and", "or", "xone")),
    *(_of(name, nested) for name in ("not", "node")),
    ("property", lambda draw, _: f"sh:property {nested(draw, on_path=True)}"),
)
CLOSED: tuple[Part, ...] = (("closed", _closed),)
QUALIFIED: tuple[Part, ...] = (("qualifiedValueShape", _qualified),)
CORE = (*TERMS, *COUNTS, *TEXT, *ORDER, *PAIRS, *LOGIC, *CLOSED, *QUALIFIED)
OPAQUE = (*COUNTS, TERMS[0], TERMS[3], TERMS[4], *PAIRS, *CLOSED, *QUALIFIED, *LOGIC)
PLAIN = (*NUMBERS, *TEXTS)
KINDS: Mapping[str, tuple[Sequence[str], Sequence[Part]]] = {
    "core": ((*PLAIN, *TIMES, *BOOLEANS), CORE),
    "terms": ((*PLAIN, *BOOLEANS), (*TERMS, *COUNTS, *CLOSED)),
    "texts": (TEXTS, (*TEXT, *TERMS)),
    "order": ((*NUMBERS, *TIMES, *BOOLEANS, '"a"', '"b"'), (*ORDER, *PAIRS)),
    "paths": (PLAIN, (*TERMS, *COUNTS, *COUNTS, *PAIRS)),
    "logic": (PLAIN, (*LOGIC, *LOGIC, *TERMS, *COUNTS)),
    "qualified": (PLAIN, (*QUALIFIED, *QUALIFIED, LOGIC[-1], *TERMS)),
    "recursion": (PLAIN[:4], (*LOGIC, *LOGIC, *TERMS, *COUNTS)),
    "lexical forms": (FORMS, (*TERMS, *ORDER, *TEXT, ("sparql", _sparql))),
    "constraints": (PLAIN, (("sparql", _sparql), ("sparql", _sparql), *LOGIC)),
    "components": (PLAIN, (("custom", _custom), ("custom", _custom), *LOGIC)),
    "targets": (PLAIN, (*TERMS, *COUNTS)),
    "expressions": (NUMBERS[:5], (("expression", _expression), *COUNTS, *TERMS)),
    "rules": (NUMBERS[:5], (*COUNTS, *TERMS, *PAIRS)),
    "imports": (PLAIN, CORE),
    "triple terms": (PLAIN[:4], OPAQUE),
}
"""What is drawn for a pair: the literals of its data, and the parameters of its shapes."""


def pair(number: int) -> Pair:
    """The pair with that number; equal numbers give equal text."""
    rng = random.Random(number)  # noqa: S311 - reproducible by design, and no secret
    kind = list(KINDS)[number % len(KINDS)]
    literals, parts = KINDS[kind]
    if kind == "triple terms":
        literals = (*literals, *TRIPLES)
    draw = Draw(rng, literals, parts, paths=kind in {"core", "paths", "constraints", "components"})
    if kind == "recursion":
        draw.loops = ("ex:Shape1", "ex:Shape2", "ex:Shape3")
    for top in range(1, rng.randint(3, 4) if kind == "recursion" else rng.randint(2, 3)):
        draw.blocks.append(_root(draw, kind, top))
    declared = {block.partition(" ")[0] for block in draw.blocks}
    for name in sorted(set(draw.loops) - declared):
        draw.blocks.append(f"{name} a sh:NodeShape ; {shape(draw, on_path=False)} .")
    return Pair(number, kind, _files(draw, kind))


def _root(draw: Draw, kind: str, top: int) -> str:
    """A block for a shape with a target; a property shape has its path on the outside."""
    on_path = draw.rng.random() < 0.3 and kind != "recursion"
    name = "ex:A" if kind == "targets" and top == 1 and draw.rng.random() < 0.3 else f"ex:Shape{top}"
    own = f"{_target(draw, kind)}"
    if name == "ex:A":
        own += " ; a rdfs:Class"
    if kind == "rules":
        own += f" ; {_rules(draw)}"
    text = shape(draw, on_path=on_path, own=own)
    return f"{name} a sh:{'PropertyShape' if on_path else 'NodeShape'} ; {text} ; {_property(draw, on_path)} ."


def _property(draw: Draw, on_path: bool) -> str:  # noqa: FBT001 - as above
    """Most node shapes have property shapes."""
    if on_path or draw.rng.random() < 0.2:
        return ""
    return " ; ".join(f"sh:property {nested(draw, on_path=True)}" for _ in range(draw.rng.randint(1, 3)))


def _target(draw: Draw, kind: str) -> str:
    if kind == "targets" and draw.rng.random() < 0.6:
        if draw.rng.random() < 0.4:
            if TARGET_TYPES not in draw.blocks:
                draw.blocks.append(TARGET_TYPES)
            return f"sh:target [ a ex:Having ; ex:property {draw.property()} ]"
        query = _filled(draw, draw.one(*TARGETS))
        return f"sh:target [ a sh:SPARQLTarget ; sh:prefixes ex:prefixes ; sh:select '''{query}''' ]"
    return draw.one(
        f"sh:targetClass {draw.one(*CLASSES)}",
        f"sh:targetNode {draw.one(*NAMES, *PLAIN)} , {draw.one(*NAMES)}",
        f"sh:targetSubjectsOf {draw.property()}",
        f"sh:targetObjectsOf {draw.property()}",
    )


def _rules(draw: Draw) -> str:
    chosen = draw.rng.sample(RULES, draw.rng.randint(1, 3))
    return " ; ".join(
        f"sh:rule [ sh:order {order} ; {_filled(draw, text)} ]" for order, text in enumerate(chosen, draw.shapes * 10)
    )


def _data(draw: Draw) -> list[str]:
    rng = draw.rng
    statements = {f"{name} a {rng.choice(CLASSES)} ." for name in NODES if rng.random() < 0.6}
    for _ in range(rng.randint(3, 16)):
        subject = rng.choice(NODES)
        value = rng.choice(NODES) if rng.random() < 0.5 else rng.choice(draw.literals)
        statements.add(f"{subject} {draw.property()} {value} .")
    if rng.random() < 0.7:
        statements.add("ex:B rdfs:subClassOf ex:A .")
    return sorted(statements)


def _files(draw: Draw, kind: str) -> dict[str, str]:
    blocks = [_DECLARED, *draw.blocks]
    statements = _data(draw)
    if kind != "imports":
        return {"shapes.ttl": PREFIXES + "\n".join(blocks) + "\n", "data.ttl": PREFIXES + "\n".join(statements) + "\n"}
    files = {}
    for name, parts in (("shapes", blocks), ("data", statements)):
        cut = draw.rng.randint(0, len(parts))
        header = f"<https://example.org/{name}> a owl:Ontology ; owl:imports <lib/{name}.ttl> .\n"
        files[f"{name}.ttl"] = PREFIXES + header + "\n".join(parts[:cut]) + "\n"
        files[f"lib/{name}.ttl"] = PREFIXES + "\n".join(parts[cut:]) + "\n"
    return files
