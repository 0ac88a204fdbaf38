"""Every syntax rule of SHACL: what breaks it is reported with its parameter, and what keeps it is not."""

import pytest

from onto_compiler.rdf import SH
from onto_compiler.shacl.compile import compile_graph
from onto_compiler.shacl.graph import Graph
from onto_compiler.shacl.reader import local
from onto_compiler.shacl.rules import infer
from onto_compiler.shacl.syntax import PARAMETERS
from onto_compiler.shacl.validate import validate_graph
from onto_compiler.shacl.wellformed import misspelt, sound_part
from onto_compiler.vocabularies import TERMS
from tests.onto_compiler.shacl.test_engines import EX, PREFIXES, graph_of

NODE, PROPERTY = "ex:S a sh:NodeShape ; {} .", "ex:S sh:property [ sh:path ex:p ; {} ] ."
GOOD = {
    "and": "( ex:O [ sh:class ex:C ] )",
    "class": "ex:C , ex:D",
    "closed": '"1"^^xsd:boolean',
    "datatype": "xsd:string",
    "deactivated": "true",
    "disjoint": "ex:q",
    "equals": "ex:q",
    "flags": '"i" ; sh:pattern "a"',
    "hasValue": "1",
    "ignoredProperties": "( ex:q ) ; sh:closed true",
    "in": '( 1 ex:a "b" )',
    "languageIn": '( "en" )',
    "lessThan": "ex:q",
    "lessThanOrEquals": "ex:q",
    "maxCount": "0",
    "maxExclusive": "1.5",
    "maxInclusive": "1",
    "maxLength": "3",
    "message": '"one"@en , "eins"@de',
    "minCount": "1",
    "minExclusive": "1",
    "minInclusive": "1",
    "minLength": "1",
    "node": "ex:O",
    "nodeKind": "sh:IRI",
    "not": "[ sh:class ex:C ]",
    "or": "( ex:O )",
    "pattern": '"a"',
    "property": "[ sh:path ex:q ]",
    "qualifiedMaxCount": "1 ; sh:qualifiedValueShape ex:O",
    "qualifiedMinCount": "1 ; sh:qualifiedValueShape ex:O",
    "qualifiedValueShape": "ex:O ; sh:qualifiedMinCount 1",
    "qualifiedValueShapesDisjoint": "true ; sh:qualifiedValueShape ex:O ; sh:qualifiedMinCount 1",
    "severity": "sh:Info",
    "sparql": '[ sh:select "SELECT $this WHERE { $this ?p 1 }" ]',
    "targetClass": "ex:C",
    "targetNode": "ex:a",
    "targetObjectsOf": "ex:p",
    "targetSubjectsOf": "ex:p",
    "uniqueLang": "false",
    "xone": "( ex:O )",
}
IRI, COUNT, BOOLEAN = ['"ex:C"', "1", "[]"], ['"1"', "-1", "1.0", "ex:a", '"x"^^xsd:integer'], ['"true"', "1", "ex:a"]
LIST, SHAPE = ["ex:a", '"a"', "[ rdf:first 1 ]", "[ rdf:first ex:a , ex:b ; rdf:rest () ]"], ["ex:NoSuch", '"ex:O"']
BAD = (
    {name: IRI for name in PARAMETERS if PARAMETERS[name].expected == "an IRI"}
    | {name: COUNT for name in PARAMETERS if name.lower().endswith(("count", "length"))}
    | dict.fromkeys(("closed", "deactivated", "qualifiedValueShapesDisjoint", "uniqueLang"), BOOLEAN)
    | {"in": LIST, "ignoredProperties": [*LIST, "( [] )"], "hasValue": []}
    | {name: [*LIST, "()", "( ex:NoSuch )"] for name in ("and", "or", "xone")}
    | dict.fromkeys(("node", "not", "qualifiedValueShape"), SHAPE)
    | {f"{side}{kind}": ["ex:a", '"x"^^xsd:integer'] for side in ("min", "max") for kind in ("Inclusive", "Exclusive")}
    | {
        "flags": ["1", "ex:a"],
        "languageIn": [*LIST, "( 1 )"],
        "message": ["1", "ex:a"],
        "nodeKind": ["sh:Violation", '"sh:IRI"', "ex:IRI"],
        "path": [
            '"ex:p"',
            "()",
            "( ex:p )",
            "( ex:p ( ex:q ) )",
            "[ sh:inversePath 1 ]",
            "[ sh:inversePath ex:p , ex:q ]",
            "[ sh:inversePath ex:p ; sh:zeroOrMorePath ex:q ]",
            "[ sh:alternativePath () ]",
            "[ sh:alternativePath ( ex:p ) ]",
            "[]",
            "_:p . _:p sh:inversePath _:p ; ex:about ex:q",
            "_:p . _:p sh:alternativePath ( ex:p _:p ) ; ex:about ex:q",
            "_:p . _:p rdf:first ex:p ; rdf:rest _:p ; ex:about ex:q",
            "_:p . _:p rdf:first ex:p , ex:q ; rdf:rest ( ex:p ) ; ex:about ex:q",
        ],
        "pattern": ["1", "ex:a", '"([a"', '"a"@en'],
        "property": ["ex:NoSuch", "[ sh:minCount 1 ]", '"p"'],
        "severity": ['"Warning"', "[]"],
        "sparql": [
            '"SELECT $this {}"',
            "[]",
            '[ sh:select "SELECT ?x WHERE { ?x ?y ?z }" ]',
            '[ sh:select "ASK { $this ?y ?z }" ]',
            '[ sh:select "SELECT * WHERE { ?x ?y ?z # $this\\n }" ]',
            '[ sh:select "SELECT $this {}" , "SELECT $this { }" ]',
        ],
        "targetNode": ["[]"],
    }
)


def faults_of(text):
    faults = []
    sound = sound_part(graph_of(f"{PREFIXES} ex:O a sh:NodeShape ; sh:class ex:C . {text}"), faults)
    return sound, faults


def test_every_parameter_is_tested():
    assert PARAMETERS.keys() == BAD.keys() == GOOD.keys() | {"path"}
    assert PARAMETERS.keys() <= TERMS[SH]


@pytest.mark.parametrize("name", GOOD)
def test_what_keeps_the_rules_is_left_alone(name):
    forms = [PROPERTY] if PARAMETERS[name].on_property or name.startswith("qualified") else [NODE, PROPERTY]
    for form in forms:
        sound, faults = faults_of(form.format(f"sh:{name} {GOOD[name]}"))
        assert faults == []
        assert sound.holders(next(t.predicate for t in sound if t.predicate.value == SH + name))


@pytest.mark.parametrize(("name", "value"), [(name, value) for name, values in BAD.items() for value in values])
def test_what_breaks_a_rule_is_reported_once(name, value):
    companion = {"flags": 'sh:pattern "a" ;', "ignoredProperties": "sh:closed true ;"}.get(name, "")
    if name.startswith("qualified"):
        other = "sh:qualifiedMinCount 1" if name == "qualifiedValueShape" else "sh:qualifiedValueShape ex:O"
        companion = f"{other} ; " + ("sh:qualifiedMinCount 1 ;" if name.endswith("Disjoint") else "")
    form = PROPERTY if name != "path" else "ex:S sh:property _:s . _:s {} ."
    _, (fault,) = faults_of(form.format(f"{companion} sh:{name} {value}"))
    assert local(fault.parameter) in {name, "select"}
    assert fault.problems[0].code == "SHP002"


@pytest.mark.parametrize("name", [name for name in GOOD if PARAMETERS[name].single])
def test_one_value_where_there_may_be_one(name):
    two = {
        "datatype": "xsd:string , xsd:integer",
        "nodeKind": "sh:IRI , sh:Literal",
        "severity": "sh:Info , sh:Warning",
    }
    given = GOOD[name].split(" ; ")[0]
    other = {"(": "( ex:other )", '"': '"other"', "e": "[ sh:class ex:D ]"}.get(given[0], "7")
    if BAD[name] is BOOLEAN:
        given, other = "true", "false"
    elif name == "languageIn":
        other = '( "de" )'
    _, faults = faults_of(PROPERTY.format(f"sh:{name} {two.get(name, f'{given} , {other}')}"))
    assert [str(fault).count("values, and may have one") for fault in faults if fault.parameter == name] == [1]


@pytest.mark.parametrize("name", [name for name in GOOD if PARAMETERS[name].on_property])
def test_a_node_shape_has_no_parameter_of_property_shapes(name):
    _, faults = faults_of(NODE.format(f"sh:{name} {GOOD[name]}"))
    assert name in [fault.parameter for fault in faults]


@pytest.mark.parametrize("name", [name for name in GOOD if PARAMETERS[name].wants])
def test_a_parameter_that_means_nothing_alone(name):
    _, (fault,) = faults_of(PROPERTY.format(f"sh:{name} {GOOD[name].split(' ; ')[0]}"))
    assert "stands without" in str(fault)


@pytest.mark.parametrize(
    ("shape", "said"),
    [
        ("ex:S a sh:PropertyShape ; sh:class ex:C .", "a property shape has no sh:path"),
        ("ex:S a sh:NodeShape ; sh:path ex:p .", "a node shape has a sh:path"),
    ],
)
def test_the_kind_of_a_shape_is_the_one_that_it_says(shape, said):
    _, (fault,) = faults_of(shape)
    assert said in str(fault)


@pytest.mark.parametrize(
    ("shape", "hint"),
    [
        ("sh:propery [ sh:path ex:p ]", "sh:property"),
        ("sh:property [ sh:path ex:p ; sh:mincount 1 ]", "sh:minCount"),
        ("sh:targetclass ex:C", "sh:targetClass"),
        ("a sh:NodeShpe", "sh:NodeShape"),
    ],
)
def test_a_misspelt_term_is_named_with_the_nearest(shape, hint):
    (fault,) = misspelt(graph_of(f"{PREFIXES} ex:S {shape} ."))
    assert fault.problems[0].code == "VOC011"
    assert fault.problems[0].hint.startswith(f"did you mean `{hint}`?")


def test_the_sound_constraints_run_and_nothing_rests_on_unsound_shapes():
    shapes = """ex:A sh:targetNode ex:a ; sh:nodeKind sh:Literal , sh:Iri ; sh:class "C" , ex:C ; sh:not ex:B ;
        sh:property [ sh:path ex:p ; sh:minCount 1 ; sh:maxCount -1 ] , [ sh:path ex:p , ex:q ; sh:minCount 1 ] .
    ex:B sh:property [ sh:path ex:p ; sh:mincount 1 ] ."""
    faults = []
    compiled = compile_graph(graph_of(PREFIXES + shapes), faults)
    results = validate_graph(Graph(), compiled, faults)
    assert sorted(result.component for result in results) == ["ClassConstraintComponent", "MinCountConstraintComponent"]
    assert {result.focus.value for result in results} == {EX + "a"}
    assert len(faults) == 4


@pytest.mark.parametrize(
    ("written", "value"), [("true", True), ('"1"^^xsd:boolean', True), ("false", False), ('"0"^^xsd:boolean', False)]
)
def test_booleans_are_read_by_value(written, value):
    shape = "ex:A sh:targetNode ex:a ; sh:class ex:C ; sh:deactivated {} . ex:B sh:targetNode ex:a ; sh:closed {} ."
    compiled = compile_graph(graph_of(PREFIXES + shape.replace("{}", written)), [])
    found = {r.component for r in validate_graph(graph_of(PREFIXES + "ex:a ex:p 1 ."), compiled, [])}
    assert found == ({"ClosedConstraintComponent"} if value else {"ClassConstraintComponent"})


QUERY = 'sh:select "SELECT $this WHERE { $this ?p ?o }"'
SHAPE_WITH = "ex:S a sh:NodeShape ; sh:targetNode ex:a ; {} ."
COMPONENT = "ex:C a sh:ConstraintComponent ; {} . ex:S a sh:NodeShape ; sh:targetNode ex:a ."
DECLARED = {
    "a sh:declare has no sh:namespace": 'ex: sh:declare [ sh:prefix "p" ] .',
    "a sh:declare has no sh:prefix": 'ex: sh:declare [ sh:namespace "http://e/"^^xsd:anyURI ] .',
    "the value of sh:namespace must be an IRI": 'ex: sh:declare [ sh:prefix "p" ; sh:namespace "http://e/" ] .',
    "the value of sh:prefix must be a plain string": """ex: sh:declare
        [ sh:prefix "p"@en ; sh:namespace "http://e/"^^xsd:anyURI ] .""",
    "the value of sh:declare must be a node": 'ex: sh:declare "p" .',
    "the value of sh:prefixes must be a node": SHAPE_WITH.format(f'sh:sparql [ sh:prefixes "p" ; {QUERY} ]'),
    "the prefix `p:` stands for <http://f/> here, and for <http://e/> elsewhere": """ex: sh:declare
        [ sh:prefix "p" ; sh:namespace "http://e/"^^xsd:anyURI ] ,
        [ sh:prefix "p" ; sh:namespace "http://f/"^^xsd:anyURI ] . """
    + SHAPE_WITH.format(f"sh:sparql [ sh:prefixes ex: ; {QUERY} ]"),
    "a component has no sh:parameter": COMPONENT.format('sh:validator [ sh:ask "ASK {}" ]'),
    "a component has no IRI": "[] a sh:ConstraintComponent ; sh:parameter [ sh:path ex:q ] .",
    "a sh:parameter has no sh:path": COMPONENT.format("sh:parameter [ sh:optional true ]"),
    "the value of sh:path must be an IRI": COMPONENT.format("sh:parameter [ sh:path ( ex:p ex:q ) ]"),
    "the value of sh:optional must be true or false": COMPONENT.format(
        'sh:parameter [ sh:path ex:q ; sh:optional "true" ]'
    ),
    "sh:ask holds a query of the form SELECT, not ASK": COMPONENT.format(
        'sh:parameter [ sh:path ex:q ] ; sh:validator [ sh:ask "SELECT * {}" ]'
    ),
    "sh:select holds a query of the form ASK, not SELECT": COMPONENT.format(
        'sh:parameter [ sh:path ex:q ] ; sh:nodeValidator [ sh:select "ASK {}" ]'
    ),
    "the value of sh:ask must be a plain string": COMPONENT.format(
        "sh:parameter [ sh:path ex:q ] ; sh:validator [ sh:ask ex:query ]"
    ),
    "has neither sh:select nor sh:ask": "ex:f a sh:SPARQLFunction .",
    "has more than one query": 'ex:f a sh:SPARQLFunction ; sh:ask "ASK {}" ; sh:select "SELECT (1 AS ?x) {}" .',
    "the value of sh:returnType must be an IRI": 'ex:f a sh:SPARQLFunction ; sh:ask "ASK {}" ; sh:returnType "x" .',
    "the value of sh:target must be a node": SHAPE_WITH.format('sh:target "x"'),
    "the sh:target has no sh:select": SHAPE_WITH.format("sh:target [ a sh:SPARQLTarget ]"),
    "the query of a target cannot run": SHAPE_WITH.format('sh:target [ sh:select "SELECT ?this WHERE {" ]'),
    "the value of sh:rule must be a node": SHAPE_WITH.format('sh:rule "x"'),
    "a sh:JSRule is JavaScript": SHAPE_WITH.format("sh:rule [ a sh:JSRule ]"),
    "a sh:SPARQLRule has no sh:construct": SHAPE_WITH.format("sh:rule [ a sh:SPARQLRule ]"),
    "a sh:TripleRule has no sh:predicate": SHAPE_WITH.format("sh:rule [ sh:subject sh:this ; sh:object 1 ]"),
    "the value of sh:order must be a number": SHAPE_WITH.format(
        'sh:rule [ sh:subject sh:this ; sh:predicate ex:p ; sh:object 1 ; sh:order "first" ]'
    ),
    "sh:js is not run": SHAPE_WITH.format("sh:js [ ]"),
    "sh:singleLine is not run": "ex:S sh:targetNode ex:a ; sh:property [ sh:path ex:p ; sh:singleLine true ] .",
    "the entailment regime <http://www.w3.org/ns/entailment/RDFS> is not supported": (
        "ex: sh:entailment <http://www.w3.org/ns/entailment/RDFS> ."
    ),
}


@pytest.mark.parametrize("said", DECLARED)
def test_what_stands_beside_shapes_is_checked_too(said):
    sound, faults = faults_of(DECLARED[said])
    infer(Graph(), sound, faults)
    (fault,) = faults
    assert said in str(fault)
    assert fault.problems[0].code == "SHP002"


def test_sound_declarations_have_no_fault():
    text = f"""ex: sh:entailment sh:Rules ; sh:declare [ sh:prefix "p" ; sh:namespace "http://e/"^^xsd:anyURI ] .
    ex:C a sh:ConstraintComponent ; sh:parameter [ sh:path ex:par ] , [ sh:path ex:more ; sh:optional true ] ;
        sh:labelTemplate "{{$par}}" ; sh:validator [ a sh:SPARQLAskValidator ; sh:prefixes ex: ; sh:ask "ASK {{}}" ] .
    ex:f a sh:SPARQLFunction ; sh:parameter [ sh:path ex:x ; sh:order 1 ] ; sh:returnType xsd:integer ;
        sh:select "SELECT (1 AS ?x) {{}}" .
    ex:S a sh:NodeShape ; sh:target [ a sh:SPARQLTarget ; sh:select "SELECT ?this {{ ?this ?p ?o }}" ] ; ex:par 1 ;
        sh:sparql [ sh:prefixes ex: ; {QUERY} ] ; sh:rule [ a sh:TripleRule ; sh:subject sh:this ; sh:predicate ex:p ;
        sh:object 1 ; sh:order 1.5 ; sh:condition ex:O ] , [ a sh:SPARQLRule ; sh:construct "CONSTRUCT {{}} {{}}" ] ."""
    sound, faults = faults_of(text)
    infer(Graph(), sound, faults)
    assert faults == []
    assert misspelt(sound) == []


def test_a_target_that_is_none_leaves_the_others_and_the_constraints():
    faults = []
    shapes = "ex:A sh:target 'x' ; sh:targetNode ex:a ; sh:class ex:C ."
    results = validate_graph(Graph(), compile_graph(graph_of(PREFIXES + shapes), faults), faults)
    assert [result.focus.value for result in results] == [EX + "a"]
    assert len(faults) == 1
