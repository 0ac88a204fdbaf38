"""The text of each scaffold. A ``{own}`` is the prefix of the file's own namespace, ``{iri}`` its ontology."""

from __future__ import annotations

__all__ = ["BINDING", "DECLARE", "FAILURE", "GROUNDING", "HEADER", "PREDICATE", "ROUTE", "TASK"]

HEADER = """\
<{iri}> a owl:Ontology ;
    dcterms:title "{title}"@en ;
    dcterms:description "Terms of the domain `{text}`, on top of the manipulation vocabulary."@en ;
    dcterms:creator "{creator}" ;
    dcterms:license <https://spdx.org/licenses/MIT> ;
    owl:imports <https://w3id.org/onto-evwm/manipulation> ;
    owl:versionIRI <{iri}/0.1.0> ;
    owl:versionInfo "0.1.0" .
"""
PREDICATE = """\
{own}:{snake} a owl:NamedIndividual , {kind} ;
    rdfs:label "{text}"@en ;
    skos:definition "{definition}"@en ;
    skos:notation "{snake}" ;
    core:arity {arity} ;
    core:domain {domain} ;
{optional}    rdfs:isDefinedBy <{iri}> .
"""
BINDING = """\
{own}:{snake} a owl:NamedIndividual , core:Binding ;
    rdfs:label "{text}"@en ;
    skos:definition "Lifts the atom {native} of {classes}."@en ;
    core:native "{native}" ;
{arguments}    core:lifts {lifts} ;
    core:groundedBy "{function}" ;
    core:order {order} ;
    rdfs:isDefinedBy <{iri}> .
"""
GROUNDING = """\
{own}:{snake}_function a owl:NamedIndividual , core:GroundingFunction ;
    rdfs:label "{text} function"@en ;
    skos:definition "Grounds the predicate `{text}` in a state of the simulator."@en ;
    skos:notation "{snake}" ;
    core:tests {arity} ;
    rdfs:isDefinedBy <{iri}> .
"""
ROUTE = """\
{own}:{snake} a owl:NamedIndividual , core:ResidualRoute ;
    rdfs:label "{text}"@en ;
    skos:definition "Corrects what another route was rejected for, by the mechanism `{text}`."@en ;
    skos:editorialNote "It takes over from the routes that name it with core:onRejection."@en ;
    skos:notation "{snake}" ;
    core:level core:StateLevel ;
    core:admits {admits} ;
    core:supports {supports} ;
    rdfs:isDefinedBy <{iri}> .
"""
DECLARE = '<{iri}> sh:declare [ sh:prefix "{prefix}" ; sh:namespace "{namespace}"^^xsd:anyURI ] .\n'
FAILURE = '''\
{own}:{camel} a owl:Class ;
    rdfs:label "{text}"@en ;
    skos:definition "The failure of a required fact of the kind `{text} relation`."@en ;
    rdfs:subClassOf core:RelationMismatch ;
    skos:notation "{snake}" ;
    core:priority {priority} ;
    rdfs:isDefinedBy <{iri}> .

{own}:{camel}Relation a owl:Class ;
    rdfs:label "{text} relation"@en ;
    skos:definition "The kind of predicates that fail as `{text}`."@en ;
    rdfs:subClassOf core:Predicate ;
    rdfs:isDefinedBy <{iri}> .

{own}:{snake}_route a owl:NamedIndividual , core:StateRoute ;
    rdfs:label "{text} route"@en ;
    skos:definition "Corrects the failure `{text}`."@en ;
    skos:notation "{snake}_route" ;
    core:level core:StateLevel ;
    core:admits {own}:{camel} ;
    core:supports {own}:{camel}Relation ;
    rdfs:isDefinedBy <{iri}> .

{own}:{snake}_rules a sh:NodeShape ;
    rdfs:label "{text} rules"@en ;
    skos:definition "Names the failure `{text}`."@en ;
    sh:targetClass core:ObservedFact ;
    sh:rule {own}:{snake}_rule ;
    rdfs:isDefinedBy <{iri}> .

{own}:{snake}_rule a sh:SPARQLRule ;
    rdfs:label "{text} rule"@en ;
    skos:definition "A fact of the kind `{text} relation` that is unmet has the failure `{text}`."@en ;
    sh:order {order} ;
    sh:prefixes <{iri}> ;
    sh:construct """
CONSTRUCT {{ $this core:failureClass {own}:{camel} ; core:diagnosedBy {own}:{snake}_rule }}
WHERE {{
    $this core:status ?status ; core:fact/core:predicate ?predicate .
    ?predicate a/rdfs:subClassOf* ?kind .
    VALUES ?kind {{ {own}:{camel}Relation }}
    VALUES ?status {{ core:Absent core:ExplicitlyFalse core:MarginViolated }}
}}
""" ;
    rdfs:isDefinedBy <{iri}> .
'''
TASK = """\
(define (problem LIBERO_Tabletop_Manipulation)
  (:domain robosuite)

  (:language {sentence})

  (:regions
    (bowl_region
      (:target main_table)
      (:ranges ((-0.1 -0.01 -0.08 0.01)))
    )
    (plate_region
      (:target main_table)
      (:ranges ((0.04 -0.03 0.06 -0.01)))
    )
  )

  (:fixtures
    main_table - table
  )

  (:objects
    akita_black_bowl_1 - akita_black_bowl
    plate_1 - plate
  )

  (:obj_of_interest
    akita_black_bowl_1
    plate_1
  )

  (:init
    (On akita_black_bowl_1 main_table_bowl_region)
    (On plate_1 main_table_plate_region)
  )

  (:goal
    (And (On akita_black_bowl_1 plate_1))
  )
)
"""
