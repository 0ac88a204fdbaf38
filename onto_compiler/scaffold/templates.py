"""The text of each scaffold. A ``{own}`` is the prefix of the file's own namespace, ``{iri}`` its ontology."""

from __future__ import annotations

__all__ = ["DECLARE", "FAILURE", "HEADER", "PREDICATE", "ROUTE", "TASK"]

HEADER = """\
<{iri}> a owl:Ontology ;
    dcterms:title "{title}"@en ;
    dcterms:description "What is asked of {text}, on top of the manipulation vocabulary."@en ;
    dcterms:creator "{creator}" ;
    dcterms:license <https://spdx.org/licenses/MIT> ;
    owl:imports <https://w3id.org/onto-evwm/manipulation> ;
    owl:versionIRI <{iri}/0.1.0> ;
    owl:versionInfo "0.1.0" .
"""
PREDICATE = """\
{own}:{snake} a owl:NamedIndividual , {kind} ;
    rdfs:label "{text}"@en ;
    skos:definition "Holds when the first argument is {text} the second."@en ;
    skos:notation "{snake}" ;
    core:arity 2 ;
    core:domain man:Object ;
    core:range man:Object ;
    core:marginUnit unit:M ;
    core:groundedBy "on_object" ;
    rdfs:isDefinedBy <{iri}> .
"""
ROUTE = """\
{own}:{snake} a owl:NamedIndividual , core:ResidualRoute ;
    rdfs:label "{text}"@en ;
    skos:definition "Corrects, after another route was rejected, what {text} can correct."@en ;
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
    skos:definition "A required {text} relation does not hold as required."@en ;
    rdfs:subClassOf core:RelationMismatch ;
    skos:notation "{snake}" ;
    core:priority {priority} ;
    rdfs:isDefinedBy <{iri}> .

{own}:{camel}Relation a owl:Class ;
    rdfs:label "{text} relation"@en ;
    skos:definition "The kind of predicates whose failure is {text}."@en ;
    rdfs:subClassOf core:Predicate ;
    rdfs:isDefinedBy <{iri}> .

{own}:{snake}_route a owl:NamedIndividual , core:StateRoute ;
    rdfs:label "{text} route"@en ;
    skos:definition "Corrects what is {text}."@en ;
    skos:notation "{snake}_route" ;
    core:level core:StateLevel ;
    core:admits {own}:{camel} ;
    core:supports {own}:{camel}Relation ;
    rdfs:isDefinedBy <{iri}> .

{own}:{snake}_rules a sh:NodeShape ;
    rdfs:label "{text} rules"@en ;
    skos:definition "Names the failure {text}."@en ;
    sh:targetClass core:ObservedFact ;
    sh:rule {own}:{snake}_rule ;
    rdfs:isDefinedBy <{iri}> .

{own}:{snake}_rule a sh:SPARQLRule ;
    rdfs:label "{text} rule"@en ;
    skos:definition "A required {text} relation that is unmet, in whatever way, is {text}."@en ;
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
