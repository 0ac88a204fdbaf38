"""Large files that are made, not collected: an ontology of any size, and a building as Brick describes one."""

from __future__ import annotations

import random
from collections.abc import Iterator

__all__ = ["brick_shapes", "building", "ontology_text"]

_HEAD = """@prefix : <https://example.org/made#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix skos: <http://www.w3.org/2004/02/skos/core#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .

<https://example.org/made> a owl:Ontology ; rdfs:label "made"@en .
"""


def ontology_text(terms: int) -> str:
    """An ontology with ``terms`` terms in Turtle: half classes in a tree, a quarter properties, a quarter individuals.

    One term in a hundred has a fault: a class that is not declared, or a value outside a range.
    """
    rng = random.Random(terms)  # noqa: S311 - reproducible by design, and no secret
    classes, properties = terms // 2, terms // 4
    blocks = [_HEAD]
    for n in range(classes):
        above = f" ; rdfs:subClassOf :Class{(n - 1) // 4}" if n else ""
        blocks.append(f":Class{n} a owl:Class ; {_said(n, 'class')}{above} .\n")
    for n in range(properties):
        domain, values = rng.randrange(classes), rng.randrange(classes)
        kind, target = ("ObjectProperty", f":Class{values}") if n % 2 else ("DatatypeProperty", "xsd:integer")
        blocks.append(
            f":has{n} a owl:{kind} ; {_said(n, 'property')} ; rdfs:domain :Class{domain} ; rdfs:range {target} .\n"
        )
    for n in range(terms - classes - properties):
        fault = n % 25 == 0
        of = f"Clas{n}" if fault else f"Class{rng.randrange(classes)}"
        values = rng.randrange(0, properties, 2)
        blocks.append(f":thing{n} a :{of} ; {_said(n, 'individual')} ; :has{values} {n} .\n")
    return "\n".join(blocks)


def _said(number: int, kind: str) -> str:
    return f'rdfs:label "{kind} {number}"@en ; skos:definition "The {kind} with the number {number}."@en'


_PREFIXES = """@prefix bldg: <https://example.org/building#> .
@prefix brick: <https://example.org/brick#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix tag: <https://example.org/tag#> .
@prefix unit: <https://example.org/unit#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
"""
_SHAPES = """
brick:prefixes a owl:Ontology ;
    sh:declare [ sh:prefix "brick" ; sh:namespace "https://example.org/brick#"^^xsd:anyURI ] ,
        [ sh:prefix "owl" ; sh:namespace "http://www.w3.org/2002/07/owl#"^^xsd:anyURI ] ,
        [ sh:prefix "rdfs" ; sh:namespace "http://www.w3.org/2000/01/rdf-schema#"^^xsd:anyURI ] .
brick:EntityShape a sh:NodeShape ; sh:targetClass brick:Entity ;
    sh:property [ sh:path rdfs:label ; sh:minCount 1 ; sh:datatype xsd:string ; sh:minLength 1 ] ;
    sh:sparql [ sh:prefixes brick:prefixes ; sh:message "its class is deprecated" ;
        sh:select '''SELECT $this ?class WHERE { $this a ?class .
            ?class owl:deprecated true ; brick:isReplacedBy ?new }''' ] .
brick:VirtualMeters a sh:NodeShape ; sh:targetClass brick:Entity ;
    sh:sparql [ sh:prefixes brick:prefixes ; sh:message "only meters are virtual meters" ;
        sh:select '''SELECT $this WHERE { $this brick:isVirtualMeter true .
            FILTER NOT EXISTS { $this a/rdfs:subClassOf* brick:Meter } }''' ] .
brick:PointShape a sh:NodeShape ; sh:targetClass brick:Point ;
    sh:property [ sh:path brick:isPointOf ; sh:minCount 1 ;
            sh:or ( [ sh:class brick:Equipment ] [ sh:class brick:Location ] ) ] ,
        [ sh:path brick:hasUnit ; sh:maxCount 1 ; sh:in ( unit:DEG_C unit:PA unit:PERCENT unit:PPM ) ] ,
        [ sh:path brick:value ; sh:maxCount 1 ; sh:node brick:ValueShape ] ,
        [ sh:path brick:hasPoint ; sh:maxCount 0 ] .
brick:ValueShape a sh:NodeShape ; sh:nodeKind sh:BlankNodeOrIRI ;
    sh:property [ sh:path brick:hasValue ; sh:minCount 1 ; sh:maxCount 1 ; sh:datatype xsd:decimal ] ,
        [ sh:path brick:timestamp ; sh:maxCount 1 ; sh:datatype xsd:dateTime ] .
brick:TemperatureShape a sh:NodeShape ; sh:targetClass brick:Temperature_Sensor ;
    sh:property [ sh:path ( brick:value brick:hasValue ) ; sh:minInclusive -60.0 ; sh:maxInclusive 200.0 ] ,
        [ sh:path brick:hasUnit ; sh:hasValue unit:DEG_C ] .
brick:EquipmentShape a sh:NodeShape ; sh:targetClass brick:Equipment ;
    sh:property [ sh:path brick:hasLocation ; sh:minCount 1 ; sh:class brick:Location ] ,
        [ sh:path brick:feeds ; sh:or ( [ sh:class brick:Equipment ] [ sh:class brick:Location ] ) ] ,
        [ sh:path brick:serial ; sh:pattern "^[A-Z]{2}-[0-9]+$" ; sh:maxCount 1 ] ,
        [ sh:path [ sh:inversePath brick:isPointOf ] ; sh:qualifiedValueShape [ sh:class brick:Temperature_Sensor ] ;
            sh:qualifiedMinCount 1 ] .
brick:LocationShape a sh:NodeShape ; sh:targetClass brick:Location ;
    sh:property [ sh:path brick:hasPart ; sh:class brick:Location ] ,
        [ sh:path brick:area ; sh:datatype xsd:decimal ; sh:minExclusive 0.0 ] .
brick:UsesUnits a sh:NodeShape ; sh:targetSubjectsOf brick:hasUnit ; sh:class brick:Point .
brick:FedThings a sh:NodeShape ; sh:targetObjectsOf brick:feeds ; sh:not [ sh:class brick:Point ] .
brick:Tagged a sh:NodeShape ; sh:targetClass brick:Point ; sh:property [ sh:path brick:hasTag ; sh:minCount 2 ] .
"""
_UNITS = {"Temperature": "DEG_C", "Pressure": "PA", "Humidity": "PERCENT", "CO2": "PPM"}
_KINDS = ("Sensor", "Setpoint", "Alarm", "Command", "Status", "Parameter")
_OF = (
    *("Zone_Air", "Supply_Air", "Return_Air", "Outside_Air", "Exhaust_Air"),
    *("Chilled_Water", "Hot_Water", "Condenser_Water"),
)
_MACHINES = ("AHU", "VAV", "Chiller", "Pump", "Fan", "Boiler", "Meter")


def brick_shapes() -> str:
    """Shapes of the forms that Brick 1.5 has, and for each kind and quantity of a point the rule that tags it."""
    written = [_PREFIXES, _SHAPES]
    for name in (*_KINDS, *_UNITS):
        target = name if name in _KINDS else f"{name}_Point"
        written.append(
            f"brick:Tag{name} a sh:NodeShape ; sh:targetClass brick:{target} ; sh:rule [ a sh:TripleRule ; "
            f"sh:subject sh:this ; sh:predicate brick:hasTag ; sh:object tag:{name} ] .\n"
        )
    return "".join(written)


def building(triples: int) -> str:
    """A building of about so many triples in Turtle; one entity in some two hundred breaks a shape."""
    rng = random.Random(triples)  # noqa: S311 - reproducible by design, and no secret
    return _PREFIXES + "".join(_classes()) + "".join(_room(rng, n) for n in range(max(triples // 88, 1)))


def _classes() -> Iterator[str]:
    """A tree of six levels: what is measured, of what, and by which kind of point."""
    for top in ("Point", "Equipment", "Location"):
        yield f"brick:{top} rdfs:subClassOf brick:Entity .\n"
    yield "brick:Room rdfs:subClassOf brick:Space . brick:Space rdfs:subClassOf brick:Location .\n"
    for name in _MACHINES:
        yield f"brick:{name} rdfs:subClassOf brick:Equipment .\n"
    for kind in _KINDS:
        yield f"brick:{kind} rdfs:subClassOf brick:Point .\n"
    for quantity in _UNITS:
        yield f"brick:{quantity}_Point rdfs:subClassOf brick:Point .\n"
        for kind in _KINDS:
            yield f"brick:{quantity}_{kind} rdfs:subClassOf brick:{kind} , brick:{quantity}_Point .\n"
            for medium in _OF:
                yield f"brick:{medium}_{quantity}_{kind} rdfs:subClassOf brick:{quantity}_{kind} .\n"
    yield "brick:Old_Sensor rdfs:subClassOf brick:Sensor ; owl:deprecated true ; brick:isReplacedBy brick:Sensor .\n"


def _room(rng: random.Random, number: int) -> str:
    """A room with two machines, each with five points: some ninety triples."""
    written = [f'bldg:room{number} a brick:Room ; rdfs:label "room {number}" ; brick:area {rng.randint(1, 90)}.5 .\n']
    for machine in range(2):
        name = f"bldg:machine{number}_{machine}"
        serial = "none" if rng.random() < 0.01 else f"AB-{number}"
        fed = f"bldg:machine{number}_1" if machine == 0 else f"bldg:room{number}"
        written.append(
            f'{name} a brick:{rng.choice(_MACHINES)} ; rdfs:label "machine {number}" ; brick:serial "{serial}" ; '
            f"brick:hasLocation bldg:room{number} ; brick:feeds {fed} .\n"
        )
        for point in range(5):
            quantity = "Temperature" if point == 0 else rng.choice(list(_UNITS))
            kind = f"{rng.choice(_OF)}_{quantity}_{'Sensor' if point == 0 else rng.choice(_KINDS)}"
            unit = "PERCENT" if rng.random() < 0.005 else _UNITS[quantity]
            value = "900.0" if rng.random() < 0.005 else f"{rng.randint(15, 28)}.5"
            written.append(
                f'{name}_{point} a brick:{kind} ; rdfs:label "point {point}" ; brick:isPointOf {name} ; '
                f"brick:hasUnit unit:{unit} ; brick:value [ brick:hasValue {value} ; "
                f'brick:timestamp "2026-01-0{rng.randint(1, 9)}T00:00:00Z"^^xsd:dateTime ] .\n'
            )
    return "".join(written)
