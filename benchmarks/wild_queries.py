"""The SPARQL of generated shapes, as templates.

``@p@`` and ``@q@`` are properties, ``@c@`` a class, ``@v@`` a value and ``@n@`` a small number.
"""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["COMPONENTS", "CONSTRAINTS", "EXPRESSIONS", "FUNCTIONS", "RULES", "TARGETS", "TARGET_TYPES"]

_COUNTED = (
    "SELECT $this ?value WHERE { $this @p@ ?value { SELECT $this (COUNT(?o) AS ?n) { $this @q@ ?o } GROUP BY $this } "
    "FILTER (?n > 0) }"
)
CONSTRAINTS = (
    "SELECT $this ?value WHERE { $this @p@ ?value FILTER (?value > @n@) }",
    "SELECT $this ?value WHERE { $this $PATH ?value FILTER (!isLiteral(?value) || !langMatches(lang(?value), 'en')) }",
    "SELECT $this ?value WHERE { $this $PATH ?value . FILTER (STRLEN(STR(?value)) < 3) }",
    "SELECT $this (@p@ AS ?path) ?value WHERE { $this @p@ ?value . FILTER NOT EXISTS { ?value a @c@ } }",
    "SELECT $this WHERE { FILTER NOT EXISTS { $this @p@ ?any } }",
    "SELECT $this WHERE { OPTIONAL { $this @p@ ?one } FILTER (!bound(?one)) }",
    "SELECT $this WHERE { { $this @p@ ?one } UNION { $this @q@ ?one } FILTER (isIRI(?one)) }",
    "SELECT $this WHERE { $this @p@ ?one } GROUP BY $this HAVING (COUNT(?one) > 1)",
    "SELECT $this ?value WHERE { $this @p@/@q@ ?value }",
    "SELECT $this ?value WHERE { $this (@p@|^@q@)+ ?value . FILTER (isIRI(?value)) }",
    "SELECT $this ?value WHERE { ?value @p@ $this }",
    "SELECT DISTINCT $this ?value WHERE { $this @p@ ?value , ?other . FILTER (?value = ?other && isLiteral(?value)) }",
    "SELECT $this ?value WHERE { $this @p@ ?value . FILTER (STR(?value) = STR(@v@)) }",
    "SELECT $this ?value WHERE { $this @p@ ?value . FILTER (REGEX(STR(?value), '^0|[.]', 'i')) }",
    "SELECT $this ?value WHERE { $this @p@ ?value . FILTER (isNumeric(?value) && ?value * 2 >= @n@) }",
    "SELECT $this ?value WHERE { $this @p@ ?value . FILTER (datatype(?value) = xsd:integer) }",
    "SELECT $this ?value WHERE { $this @p@ ?one . BIND (IF(isIRI(?one), ?one, @p@) AS ?value) }",
    "SELECT $this ?value WHERE { $this @p@ ?value . FILTER (?value IN (@v@, 1, 'a')) }",
    _COUNTED,
    "SELECT $this WHERE { $this a @c@ . FILTER EXISTS { $this @p@ ?one . ?one @q@ ?two } }",
    "SELECT $this ?value WHERE { $this @p@ ?value . FILTER (sameTerm(?value, @v@)) }",
    "SELECT $this ?value WHERE { $this @p@ ?value . FILTER (COALESCE(?value + 1 > @n@, true)) }",
)
COMPONENTS: Mapping[str, tuple[str, str]] = {
    "ask": (
        """ex:AtLeast a sh:ConstraintComponent ; sh:parameter [ sh:path ex:atLeast ] ;
    sh:validator [ a sh:SPARQLAskValidator ;
        sh:ask 'ASK { FILTER (isNumeric($value) && $value >= $atLeast) }' ] .""",
        "ex:atLeast {n}",
    ),
    "ask of the data": (
        """ex:Known a sh:ConstraintComponent ; sh:parameter [ sh:path ex:known ] , [ sh:path ex:m ; sh:optional true ] ;
    sh:validator [ a sh:SPARQLAskValidator ; sh:ask 'ASK { $value $known ?any }' ] .""",
        "ex:known {p}",
    ),
    "select on a path": (
        """ex:Unlike a sh:ConstraintComponent ; sh:parameter [ sh:path ex:unlike ] ;
    sh:propertyValidator [ a sh:SPARQLSelectValidator ;
        sh:select 'SELECT DISTINCT $this ?value WHERE { $this $PATH ?value . $this $unlike ?value }' ] .""",
        "ex:unlike {p}",
    ),
    "select of both kinds": (
        """ex:Avoids a sh:ConstraintComponent ; sh:parameter [ sh:path ex:avoids ] ;
    sh:nodeValidator [ a sh:SPARQLSelectValidator ; sh:select 'SELECT $this WHERE { $this ?any $avoids }' ] ;
    sh:propertyValidator [ a sh:SPARQLSelectValidator ;
        sh:select 'SELECT DISTINCT $this ?value WHERE { $this $PATH ?value . FILTER (?value = $avoids) }' ] .""",
        "ex:avoids {v}",
    ),
}
"""Constraint components by name: what declares one, and how a shape uses it."""
TARGETS = (
    "SELECT ?this WHERE { ?this @p@ ?one }",
    "SELECT ?this WHERE { ?any @p@ ?this . FILTER (isIRI(?this)) }",
    "SELECT DISTINCT ?this WHERE { ?this a @c@ . FILTER NOT EXISTS { ?this @q@ ?two } }",
    "SELECT ?this WHERE { ?this @p@ ?one . FILTER (isNumeric(?one) && ?one > @n@) }",
)
TARGET_TYPES = (
    "ex:Having a sh:SPARQLTargetType ; rdfs:subClassOf sh:Target ; sh:parameter [ sh:path ex:property ] ;\n"
    "    sh:select 'SELECT ?this WHERE { ?this $property ?any }' ."
)
FUNCTIONS = """ex:double a sh:SPARQLFunction ; sh:parameter [ sh:path ex:op ] ; sh:returnType xsd:integer ;
    sh:select 'SELECT (?op * 2 AS ?result) WHERE { }' .
ex:greater a sh:SPARQLFunction ; sh:returnType xsd:boolean ;
    sh:parameter [ sh:path ex:one ; sh:order 1 ] , [ sh:path ex:two ; sh:order 2 ] ;
    sh:ask 'ASK { FILTER (?one > ?two) }' ."""
EXPRESSIONS = (
    "[ ex:greater ( [ sh:path @p@ ] @n@ ) ]",
    "[ ex:greater ( [ ex:double ( [ sh:path @p@ ] ) ] [ sh:path @q@ ] ) ]",
    "[ ex:greater ( 2 @n@ ) ]",
)
_TRIPLE = "a sh:TripleRule ; sh:subject sh:this ; sh:predicate "
_SPARQL = "a sh:SPARQLRule ; sh:prefixes ex:prefixes ; "
_SWAPPED = "sh:construct 'CONSTRUCT { ?v @p@ $this } WHERE { $this @q@ ?v . FILTER (isIRI(?v)) }'"
RULES = (
    _TRIPLE + "@p@ ; sh:object [ sh:path @q@ ]",
    _TRIPLE + "rdf:type ; sh:object @c@",
    _TRIPLE + "@p@ ; sh:object [ sh:union ( [ sh:path @q@ ] ex:d ) ]",
    _TRIPLE + "@p@ ; sh:object @n@ ; sh:condition [ a sh:NodeShape ; sh:property [ sh:path @q@ ; sh:minCount 1 ] ]",
    _SPARQL + "sh:construct 'CONSTRUCT { $this @p@ ?v } WHERE { $this @q@ ?v }'",
    _SPARQL + "sh:construct 'CONSTRUCT { $this a @c@ } WHERE { $this @p@ ?v FILTER (isNumeric(?v) && ?v > @n@) }'",
    _SPARQL + "sh:construct 'CONSTRUCT { $this @p@ ?w } WHERE { $this @q@ ?v BIND (?v + 1 AS ?w) FILTER (?v > 0) }'",
    _SPARQL + "sh:condition [ a sh:NodeShape ; sh:class @c@ ] ; " + _SWAPPED,
)
