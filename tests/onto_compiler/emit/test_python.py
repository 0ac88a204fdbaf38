"""The generated module is strictly typed: what the ontology excludes does not type-check, and what it allows runs."""

import importlib.util
import subprocess
import sys

import pytest

from onto_compiler.emit.python import emit
from onto_compiler.emit.tbox import read_tbox

USE = """
from predicates import Drawer, FailureName, InRegion, Inside, JointState, JointThreshold, Object, On, Region

bowl, plate, front = Object("akita_black_bowl_1"), Object("plate_1"), Region("main_table_stove_front_region")
top = Drawer("wooden_cabinet_1_top_region")
good = [On(bowl, plate), Inside(bowl, top), InRegion(plate, front), JointState(top, JointThreshold("o"))]
named: FailureName = "relation_missing"
bad_support = On(bowl, front)  # line 8
bad_object = On(front, plate)  # line 9
bad_count = On(bowl)  # line 10
bad_name: FailureName = "relation_mising"  # line 11
"""
OWN = """
@prefix core: <https://w3id.org/onto-evwm/core#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix skos: <http://www.w3.org/2004/02/skos/core#> .
@prefix man: <https://w3id.org/onto-evwm/manipulation#> . @prefix ex: <https://example.org/e#> .
"""


def load(text, folder, name="predicates"):
    file = folder / f"{name}.py"
    file.write_text(text)
    spec = importlib.util.spec_from_file_location(name, file)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    finally:
        del sys.modules[name]
    return module


def own(folder, turtle):
    (folder / "own.ttl").write_text(OWN + turtle)
    return emit(read_tbox([folder / "own.ttl"]))


def mypy(folder, *files):
    command = [sys.executable, "-m", "mypy", "--strict", "--no-incremental", "--config-file=", *files]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def test_mypy_refuses_what_the_ontology_excludes(tmp_path):
    pytest.importorskip("mypy")
    (tmp_path / "predicates.py").write_text(emit(read_tbox()))
    (tmp_path / "use.py").write_text(USE)
    result = mypy(tmp_path, "predicates.py", "use.py")
    lines = {line.split(":")[1] for line in result.stdout.splitlines() if ": error:" in line}
    assert lines == {"8", "9", "10", "11"}, result.stdout


def test_facts_are_values_that_read_as_reports_write_them(tmp_path):
    module = load(emit(read_tbox()), tmp_path)
    fact = module.On(module.Object("akita_black_bowl_1"), module.Object("plate_1"))
    assert str(fact) == "on(akita_black_bowl_1, plate_1)"
    assert fact == module.On(module.Object("akita_black_bowl_1"), module.Object("plate_1"))
    assert str(module.On(*fact.arguments, polarity=False)) == "not on(akita_black_bowl_1, plate_1)"
    assert (fact.unit, module.JointState.unit) == ("m", None)
    assert fact.iri == "https://w3id.org/onto-evwm/manipulation#on"


def test_classes_are_subclasses_as_the_ontology_says(tmp_path):
    tbox = read_tbox()
    module = load(emit(tbox), tmp_path)
    classes = {
        cls.iri: cls for cls in vars(module).values() if isinstance(cls, type) and issubclass(cls, module.Entity)
    }
    assert len(classes) > 15
    pairs = [(a, b) for a in classes for b in classes]
    assert all(issubclass(classes[a], classes[b]) == tbox.schema.is_a(a, b) for a, b in pairs)


def test_any_lattice_of_classes_can_be_linearised(tmp_path):
    """Bases in the order of the file, say (A, B) here and (B, A) there, would not be."""
    kinds = "".join(f"ex:{n} a owl:Class ; rdfs:subClassOf {above} ." for n, above in (
        ("A", "core:Entity"), ("B", "core:Entity"), ("X", "ex:A, ex:B"), ("Y", "ex:B, ex:A"), ("Z", "ex:Y, ex:X, ex:A"),
    ))  # fmt: skip
    module = load(own(tmp_path, kinds), tmp_path)
    assert issubclass(module.Z, module.A)
    assert module.Z("z").name == "z"


def test_names_that_python_keeps_or_that_are_taken_get_another(tmp_path):
    text = own(
        tmp_path,
        """
        ex:None a owl:Class ; rdfs:subClassOf core:Entity . ex:Fact a owl:Class ; rdfs:subClassOf core:Entity .
        ex:object a man:ObjectRelation ; skos:notation "object" ; core:domain ex:None ; core:range ex:Fact .
        ex:2nd-hand a man:ObjectRelation ; skos:notation "2nd hand" ; core:domain man:Object .
        """,
    )
    module = load(text, tmp_path)
    assert {"None1", "Fact1", "ObjectFact", "_2ndHand"} <= set(module.__all__)
    second = vars(module)["_2ndHand"]
    assert str(second(module.Object("cup"))) == "2nd hand(cup)"
    assert module.ObjectFact(module.None1("n"), module.Fact1("f")).arguments[1].name == "f"


def test_a_text_cannot_break_out_of_its_docstring(tmp_path):
    definition = 'It says \\"\\"\\" and a backslash \\\\ and\\nmore.'
    text = own(tmp_path, f'ex:A a owl:Class ; rdfs:subClassOf core:Entity ; skos:definition "{definition}"@en .')
    assert load(text, tmp_path).A.__doc__ == "It says ''' and a backslash / and more."
