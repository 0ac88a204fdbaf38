"""Every syntax rule of SHACL: what breaks it is reported with its parameter, and what keeps it is not."""

import pytest

from onto_compiler.check.vocabularies import TERMS
from onto_compiler.rdf import SH
from onto_compiler.shacl.compile import compile_graph
from onto_compiler.shacl.graph import Graph
from onto_compiler.shacl.reader import local
from onto_compiler.shacl.validate import validate_graph
from onto_compiler.shacl.wellformed import PARAMETERS, misspelt, sound_part
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
LIST, SHAPE = ["ex:a", '"a"', "[ rdf:first 1 ]"], ["ex:NoSuch", '"ex:O"']
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
        "nodeKind": ["sh:Iri", '"sh:IRI"', "ex:IRI"],
        "path": ['"ex:p"', "()", "[ sh:inversePath 1 ]", "[ sh:alternativePath () ]", "[]"],
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
    form = PROPERTY if name != "path" else "ex:S sh:property [ {} ] ."
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
    assert len(faults) == 5


@pytest.mark.parametrize(
    ("written", "value"), [("true", True), ('"1"^^xsd:boolean', True), ("false", False), ('"0"^^xsd:boolean', False)]
)
def test_booleans_are_read_by_value(written, value):
    shape = "ex:A sh:targetNode ex:a ; sh:class ex:C ; sh:deactivated {} . ex:B sh:targetNode ex:a ; sh:closed {} ."
    compiled = compile_graph(graph_of(PREFIXES + shape.replace("{}", written)), [])
    found = {r.component for r in validate_graph(graph_of(PREFIXES + "ex:a ex:p 1 ."), compiled, [])}
    assert found == ({"ClosedConstraintComponent"} if value else {"ClassConstraintComponent"})
