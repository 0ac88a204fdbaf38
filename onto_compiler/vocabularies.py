"""The terms of the vocabularies that an ontology is written with, by namespace: W3C's and Dublin Core's.

Sources: the vocabularies' own files; of SHACL, the Recommendation, the Advanced Features and the drafts of 1.2.
"""

from __future__ import annotations

import re
from typing import Final

from onto_compiler.problems import near
from onto_compiler.rdf import OWL, PREFIXES, PROV, RDF, RDFS, SH, SKOS, XSD, namespace_of, shorten

__all__ = ["TERMS", "meant"]

_ITEM = re.compile(r"_[1-9][0-9]*")  # rdf:_1, rdf:_2 and so on are terms without end

_DCTERMS = """
Agent AgentClass BibliographicResource Box DCMIType DDC FileFormat Frequency IMT ISO3166 ISO639-2 ISO639-3
Jurisdiction LCC LCSH LicenseDocument LinguisticSystem Location LocationPeriodOrJurisdiction MESH MediaType
MediaTypeOrExtent MethodOfAccrual MethodOfInstruction NLM Period PeriodOfTime PhysicalMedium PhysicalResource Point
Policy ProvenanceStatement RFC1766 RFC3066 RFC4646 RFC5646 RightsStatement SizeOrDuration Standard TGN UDC URI W3CDTF
abstract accessRights accrualMethod accrualPeriodicity accrualPolicy alternative audience available
bibliographicCitation conformsTo contributor coverage created creator date dateAccepted dateCopyrighted dateSubmitted
description educationLevel extent format hasFormat hasPart hasVersion identifier instructionalMethod isFormatOf
isPartOf isReferencedBy isReplacedBy isRequiredBy isVersionOf issued language license mediator medium modified
provenance publisher references relation replaces requires rights rightsHolder source spatial subject tableOfContents
temporal title type valid
"""
_OWL = """
AllDifferent AllDisjointClasses AllDisjointProperties Annotation AnnotationProperty AsymmetricProperty Axiom Class
DataRange DatatypeProperty DeprecatedClass DeprecatedProperty FunctionalProperty InverseFunctionalProperty
IrreflexiveProperty NamedIndividual NegativePropertyAssertion Nothing ObjectProperty Ontology OntologyProperty
ReflexiveProperty Restriction SymmetricProperty Thing TransitiveProperty allValuesFrom annotatedProperty
annotatedSource annotatedTarget assertionProperty backwardCompatibleWith bottomDataProperty bottomObjectProperty
cardinality complementOf datatypeComplementOf deprecated differentFrom disjointUnionOf disjointWith distinctMembers
equivalentClass equivalentProperty hasKey hasSelf hasValue imports incompatibleWith intersectionOf inverseOf
maxCardinality maxQualifiedCardinality members minCardinality minQualifiedCardinality onClass onDataRange onDatatype
onProperties onProperty oneOf priorVersion propertyChainAxiom propertyDisjointWith qualifiedCardinality rational real
sameAs someValuesFrom sourceIndividual targetIndividual targetValue topDataProperty topObjectProperty unionOf
versionIRI versionInfo withRestrictions
"""
_PROV = """
Accept Activity ActivityInfluence Agent AgentInfluence Association Attribution Bundle Collection Communication
Contribute Contributor Copyright Create Creator Delegation Derivation Dictionary DirectQueryService EmptyCollection
EmptyDictionary End Entity EntityInfluence Generation Influence Insertion InstantaneousEvent Invalidation
KeyEntityPair Location Modify Organization Person Plan PrimarySource Publish Publisher Quotation Removal Replace
Revision RightsAssignment RightsHolder Role ServiceDescription SoftwareAgent Start Submit Usage actedOnBehalfOf
activity activityOfInfluence agent agentOfInfluence alternateOf aq asInBundle atLocation atTime category component
constraints contributed definition derivedByInsertionFrom derivedByRemovalFrom describesService dictionary dm
editorialNote editorsDefinition ended endedAtTime entity entityOfInfluence generalizationOf generated
generatedAsDerivation generatedAtTime hadActivity hadDelegate hadDerivation hadDictionaryMember hadGeneration
hadInfluence hadMember hadPlan hadPrimarySource hadRevision hadRole hadUsage has_anchor has_provenance
has_query_service influenced influencer informed insertedKeyEntityPair invalidated invalidatedAtTime inverse
locationOf mentionOf n order pairEntity pairKey pingback provenanceUriTemplate qualifiedAssociation
qualifiedAssociationOf qualifiedAttribution qualifiedAttributionOf qualifiedCommunication qualifiedCommunicationOf
qualifiedDelegation qualifiedDelegationOf qualifiedDerivation qualifiedDerivationOf qualifiedEnd qualifiedEndOf
qualifiedForm qualifiedGeneration qualifiedGenerationOf qualifiedInfluence qualifiedInfluenceOf qualifiedInsertion
qualifiedInvalidation qualifiedInvalidationOf qualifiedPrimarySource qualifiedQuotation qualifiedQuotationOf
qualifiedRemoval qualifiedRevision qualifiedSourceOf qualifiedStart qualifiedStartOf qualifiedUsage
qualifiedUsingActivity quotedAs removedKey revisedEntity sharesDefinitionWith specializationOf started startedAtTime
todo unqualifiedForm used value wasActivityOfInfluence wasAssociateFor wasAssociatedWith wasAttributedTo
wasDerivedFrom wasEndedBy wasGeneratedBy wasInfluencedBy wasInformedBy wasInvalidatedBy wasMemberOf wasPlanOf
wasPrimarySourceOf wasQuotedFrom wasRevisionOf wasRoleIn wasStartedBy wasUsedBy wasUsedInDerivation
"""
_RDF = """
Alt Bag CompoundLiteral HTML JSON List PlainLiteral Property Seq Statement XMLLiteral dirLangString direction first
langString language nil object predicate reifies rest subject type value
"""
_RDFS = """
Class Container ContainerMembershipProperty Datatype Literal Resource comment domain isDefinedBy label member range
seeAlso subClassOf subPropertyOf
"""
_SH = """
AbstractResult AndConstraintComponent AndConstraintComponent-and BlankNode BlankNodeOrIRI BlankNodeOrLiteral
ClassConstraintComponent ClassConstraintComponent-class ClosedConstraintComponent ClosedConstraintComponent-closed
ClosedConstraintComponent-ignoredProperties ConstraintComponent DatatypeConstraintComponent
DatatypeConstraintComponent-datatype Debug DisjointConstraintComponent DisjointConstraintComponent-disjoint
EqualsConstraintComponent EqualsConstraintComponent-equals ExpressionConstraintComponent
ExpressionConstraintComponent-expression Function HasValueConstraintComponent HasValueConstraintComponent-hasValue IRI
IRIOrLiteral InConstraintComponent InConstraintComponent-in Info JSConstraint JSConstraint-js JSConstraintComponent
JSExecutable JSFunction JSLibrary JSRule JSTarget JSTargetType JSValidator LanguageInConstraintComponent
LanguageInConstraintComponent-languageIn LessThanConstraintComponent LessThanConstraintComponent-lessThan
LessThanOrEqualsConstraintComponent LessThanOrEqualsConstraintComponent-lessThanOrEquals Literal
MaxCountConstraintComponent MaxCountConstraintComponent-maxCount MaxExclusiveConstraintComponent
MaxExclusiveConstraintComponent-maxExclusive MaxInclusiveConstraintComponent
MaxInclusiveConstraintComponent-maxInclusive MaxLengthConstraintComponent MaxLengthConstraintComponent-maxLength
MinCountConstraintComponent MinCountConstraintComponent-minCount MinExclusiveConstraintComponent
MinExclusiveConstraintComponent-minExclusive MinInclusiveConstraintComponent
MinInclusiveConstraintComponent-minInclusive MinLengthConstraintComponent MinLengthConstraintComponent-minLength
NodeConstraintComponent NodeConstraintComponent-node NodeKind NodeKindConstraintComponent
NodeKindConstraintComponent-nodeKind NodeShape NotConstraintComponent NotConstraintComponent-not OrConstraintComponent
OrConstraintComponent-or Parameter Parameterizable PatternConstraintComponent PatternConstraintComponent-flags
PatternConstraintComponent-pattern PrefixDeclaration PropertyConstraintComponent PropertyConstraintComponent-property
PropertyGroup PropertyShape QualifiedMaxCountConstraintComponent
QualifiedMaxCountConstraintComponent-qualifiedMaxCount QualifiedMaxCountConstraintComponent-qualifiedValueShape
QualifiedMaxCountConstraintComponent-qualifiedValueShapesDisjoint QualifiedMinCountConstraintComponent
QualifiedMinCountConstraintComponent-qualifiedMinCount QualifiedMinCountConstraintComponent-qualifiedValueShape
QualifiedMinCountConstraintComponent-qualifiedValueShapesDisjoint ResultAnnotation Rule Rules SPARQLAskExecutable
SPARQLAskValidator SPARQLConstraint SPARQLConstraintComponent SPARQLConstraintComponent-sparql
SPARQLConstructExecutable SPARQLExecutable SPARQLFunction SPARQLRule SPARQLSelectExecutable SPARQLSelectValidator
SPARQLTarget SPARQLTargetType SPARQLUpdateExecutable Severity Shape ShapeClass Target TargetType Trace TripleRule
UniqueLangConstraintComponent UniqueLangConstraintComponent-uniqueLang ValidationReport ValidationResult Validator
Violation Warning XoneConstraintComponent XoneConstraintComponent-xone agentInstruction alternativePath and
annotationProperty annotationValue annotationVarName ask class closed codeIdentifier condition conformanceDisallows
conforms construct count datatype deactivated declare defaultValue desc description detail disjoint distinct else
entailment equals exists expression filterShape flags focusNode group groupConcat hasValue if ignoredProperties in
intent intersection inversePath js jsFunctionName jsLibrary jsLibraryURL labelTemplate languageIn lessThan
lessThanOrEquals limit max maxCount maxExclusive maxInclusive maxLength maxListLength memberShape message min minCount
minExclusive minInclusive minLength minListLength minus name namespace node nodeByExpression nodeKind nodeValidator
nodes not object offset oneOrMorePath optional or order orderBy parameter path pattern predicate prefix prefixes
property propertyValidator qualifiedMaxCount qualifiedMinCount qualifiedValueShape qualifiedValueShapesDisjoint
reificationRequired reifierShape result resultAnnotation resultMessage resultPath resultSeverity returnType rootClass
rule select separator severity shape shapesGraph shapesGraphWellFormed singleLine someValue sourceConstraint
sourceConstraintComponent sourceShape sparql subject subsetOf suggestedShapesGraph sum target targetClass targetNode
targetObjectsOf targetSubjectsOf targetWhere then this union uniqueLang uniqueMembers update validator value values
xone zeroOrMorePath zeroOrOnePath
"""
_SKOS = """
Collection Concept ConceptScheme OrderedCollection altLabel broadMatch broader broaderTransitive changeNote closeMatch
definition editorialNote exactMatch example hasTopConcept hiddenLabel historyNote inScheme mappingRelation member
memberList narrowMatch narrower narrowerTransitive notation note prefLabel related relatedMatch scopeNote
semanticRelation topConceptOf
"""
_XSD = """
Assertions ENTITIES ENTITY ID IDREF IDREFS NCName NMTOKEN NMTOKENS NOTATION Name QName anyURI base64Binary boolean
bounded byte cardinality date dateTime dateTimeStamp day dayTimeDuration decimal double duration enumeration
explicitTimezone float fractionDigits gDay gMonth gMonthDay gYear gYearMonth hexBinary hour int integer language
length long maxExclusive maxInclusive maxLength minExclusive minInclusive minLength minute month negativeInteger
nonNegativeInteger nonPositiveInteger normalizedString numeric ordered pattern positiveInteger second short string
time timezoneOffset token totalDigits unsignedByte unsignedInt unsignedLong unsignedShort whiteSpace year
yearMonthDuration
"""

TERMS: Final = {
    namespace: frozenset(names.split())
    for namespace, names in (
        (PREFIXES["dcterms"], _DCTERMS),
        (OWL, _OWL),
        (PROV, _PROV),
        (RDF, _RDF),
        (RDFS, _RDFS),
        (SH, _SH),
        (SKOS, _SKOS),
        (XSD, _XSD),
    )
}
"""Local names by namespace."""


def meant(iri: str) -> str | None:
    """What to write instead of ``iri``, where it claims to be a term of :data:`TERMS`; None for any other."""
    namespace = namespace_of(iri)
    names = TERMS.get(namespace)
    name = iri[len(namespace) :]
    if names is None or not name or name in names or (namespace == RDF and _ITEM.fullmatch(name)):
        return None
    same = next((one for one in names if one.lower() == name.lower()), None)
    question = f"did you mean `{same}`?" if same else near(name, sorted(names))
    whole = question.replace("`", f"`{shorten(namespace + 'x')[:-1]}", 1)
    return whole or "look the name up in that vocabulary, or mint a term in a namespace of your own"
