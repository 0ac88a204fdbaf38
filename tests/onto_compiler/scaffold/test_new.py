"""What ``onto new`` writes passes ``onto check``, alone and together."""

import argparse
import json
import math
import runpy
from pathlib import Path

import mujoco
import pytest

from grounding.scenes import Scene
from onto_compiler.bddl import lift, parse_file
from onto_compiler.check.tasks import check_all
from onto_compiler.format_command import FMT
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError
from onto_compiler.required import Entity, Fact, NativeAtom
from onto_compiler.scaffold.command import KINDS, NEW
from onto_compiler.scaffold.names import read_name
from tests.plugins import environment_with, run_with

ONE_FILE = ("ontology", "predicate", "failure", "route", "binding", "task")


def new(*words):
    parser = argparse.ArgumentParser()
    NEW.configure(parser)
    return NEW.run(parser.parse_args([str(word) for word in words]))


def fmt_of(*words):
    parser = argparse.ArgumentParser()
    FMT.configure(parser)
    return parser.parse_args([str(word) for word in words])


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def codes(*words):
    with pytest.raises(OntoError) as caught:
        new(*words)
    return [problem.code for problem in caught.value.problems]


def test_the_kinds_are_those_of_one_file_and_those_of_modules():
    assert {*KINDS} == {*ONE_FILE, "grounding", "proposer", "package"}


@pytest.mark.parametrize("kind", ONE_FILE)
def test_each_scaffold_passes_alone(kind, folder, capsys):
    needed = ["--lifts", "man:on", "--grounded-by", "on_object"] if kind == "binding" else []
    assert new(kind, "folded_on", *needed) == 0
    (file,) = folder.iterdir()
    assert capsys.readouterr().out == f"{file.name}\n"
    assert file.stem == "folded_on"
    report = check_all([file])
    expected = {"RTE015"} if kind in {"failure", "route"} else set()  # whose proposer is still to be written
    assert {problem.code for problem in report.problems} == expected
    assert report.files == (file.resolve(),)
    assert FMT.run(fmt_of("--check", file)) == 0


def test_all_scaffolds_pass_together(folder):
    new("ontology", "kitchen", "--iri", "https://example.com/2026/kitchen#")
    into = ("--into", "kitchen.ttl")
    for number in range(6):  # more than there are free tens for the order of a rule
        new("failure", f"creased{number}", *into)
        new("predicate", f"ironed{number}", "--of", f"kitchen:Creased{number}Relation", *into)
    new("predicate", "folded_on", *into)
    new("predicate", "upright", "--arity", "1", "--unit", "RAD", "--domain", "man:Landmark", *into)
    new("grounding", "leaning", "--arity", "1", *into)
    new("predicate", "tilted", "--arity", "1", "--grounded-by", "leaning", *into)
    new("binding", "folded_atom", "--lifts", "kitchen:folded_on", "--native", "FoldedOn", *into)
    new("route", "press", "--admits", "kitchen:Creased0", "man:TargetMargin", *into)
    new("task", "iron_the_shirt")
    report = check_all([folder])
    assert sorted(problem.code for problem in report.problems) == ["BND011"] + ["RTE015"] * 7
    assert len(report.files) == 2
    assert FMT.run(fmt_of("--check", folder)) == 0
    text = Path("kitchen.ttl").read_text(encoding="utf-8")
    prefixes = [line for line in text.splitlines() if line.startswith("@prefix")]
    assert len(prefixes) == len(set(prefixes))


def test_a_new_failure_is_diagnosed_and_routed(folder):
    new("failure", "creased", "--into", "k.ttl")
    new("predicate", "ironed", "--of", "creased:CreasedRelation", "--into", "k.ttl")
    tables = load_knowledge(folder / "k.ttl").tables
    mine = {key: entry for key, entry in tables.diagnosis.items() if key[0].endswith("#ironed")}
    assert len(mine) == 6, "two polarities, three ways to be unmet"
    assert {entry.failure.rpartition("#")[2] for entry in mine.values()} == {"Creased"}
    routed = {entry.route.rpartition("#")[2] for key, entry in tables.routing.items() if key[0].endswith("#ironed")}
    assert routed == {"creased_route"}


def test_a_new_task_lifts(folder):
    new("task", "put_the_bowl_on_the_plate")
    schema = load_knowledge().schema
    abox, warnings = lift(parse_file("put_the_bowl_on_the_plate.bddl"), schema, "x")
    assert warnings == ()
    assert abox.language == "Put the bowl on the plate"
    assert len(abox.facts) == 1


def test_what_the_file_held_stays(folder):
    mine = "# mine\r\n@prefix owl: <http://www.w3.org/2002/07/owl#> .\r\n"
    mine += "@prefix dcterms: <http://purl.org/dc/terms/> .\r\n"
    mine += '<https://example.org/a> a owl:Ontology ; dcterms:title "A"@en ; owl:versionInfo "1" ;\r\n'
    mine += "    dcterms:license <https://spdx.org/licenses/MIT> ."  # no line end
    path = folder / "a.ttl"
    path.write_bytes(mine.encode())
    new("predicate", "served on", "--into", path)
    after = path.read_bytes().decode()
    assert [line for line in mine.splitlines() if line not in after.splitlines()] == []
    assert "\n" not in after.replace("\r\n", "")
    assert "owl:imports <https://w3id.org/onto-evwm/manipulation>" in after
    assert check_all([path]).problems == ()


@pytest.mark.parametrize(
    ("given", "snake", "camel"),
    [
        ("served_on", "served_on", "ServedOn"),
        ("ServedOn", "served_on", "ServedOn"),
        ("served on", "served_on", "ServedOn"),
        ("served-on2", "served_on2", "ServedOn2"),
        ("ABCServed", "abc_served", "AbcServed"),
    ],
)
def test_a_name_is_written_as_its_kind_of_term_is(given, snake, camel):
    name = read_name(given)
    assert (name.snake, name.camel) == (snake, camel)


@pytest.mark.parametrize("given", ["", "1st", "on top!", "größer", "a/b", "../x", "a.b"])
def test_a_name_of_other_characters_is_refused(given, folder):
    assert codes("predicate", given) == ["NEW001"]
    assert list(folder.iterdir()) == []


def test_mistakes_are_named_and_change_nothing(folder):
    new("ontology", "kitchen")
    new("predicate", "served", "--into", "kitchen.ttl")
    before = Path("kitchen.ttl").read_bytes()
    assert codes("predicate", "served", "--into", "kitchen.ttl") == ["NEW002"]
    assert codes("ontology", "kitchen") == ["NEW004"]
    assert codes("predicate", "x", "--of", "man:ObjektRelation", "--into", "kitchen.ttl") == ["NEW005"]
    assert codes("ontology", "y", "--iri", "no iri") == ["NEW005"]
    assert codes("predicate", "x", "--into", "no/such/folder.ttl") == ["NEW004"]
    Path("two.ttl").write_text("<urn:x:a> a <http://www.w3.org/2002/07/owl#Class> .\n")
    assert codes("predicate", "x", "--into", "two.ttl") == ["NEW003"]
    Path("bad.ttl").write_text("no turtle")
    assert codes("predicate", "x", "--into", "bad.ttl")[0].startswith("TTL")
    Path("latin.ttl").write_bytes(b"# gr\xf6\xdfer\n")
    assert codes("predicate", "x", "--into", "latin.ttl") == ["NEW004"]
    assert Path("kitchen.ttl").read_bytes() == before
    assert sorted(path.name for path in folder.iterdir()) == ["bad.ttl", "kitchen.ttl", "latin.ttl", "two.ttl"]


@pytest.mark.parametrize(
    ("name", "arity", "definition"),
    [
        ("served_on", 2, "Holds when the first argument is served on the second."),
        ("close_to", 2, "Holds when the first argument is close to the second."),
        ("lies_on", 2, "Holds when the first argument lies on the second."),
        ("touches", 2, "Holds when the first argument touches the second."),
        ("facing", 2, "Holds when the first argument is facing the second."),
        ("glass_on", 2, "Holds when the first argument is glass on the second."),
        ("aligned", 2, "Holds when `aligned` is true of the first argument and the second."),
        ("same_color", 2, "Holds when `same color` is true of the first argument and the second."),
        ("opened", 1, "Holds when the argument is opened."),
        ("standing", 1, "Holds when the argument is standing."),
        ("rotates", 1, "Holds when the argument rotates."),
        ("is_open", 1, "Holds when the argument is open."),
        ("upright", 1, "Holds when `upright` is true of the argument."),
        ("served_on", 1, "Holds when `served on` is true of the argument."),
        ("red", 1, "Holds when `red` is true of the argument."),
    ],
)
def test_a_definition_is_english_for_one_argument_and_for_two(name, arity, definition, folder):
    new("predicate", name, "--arity", str(arity), "--into", "p.ttl")
    assert f'skos:definition "{definition}"@en' in Path("p.ttl").read_text()
    assert check_all([folder / "p.ttl"]).problems == ()


def test_what_is_chosen_of_a_predicate_is_what_it_says(folder):
    chosen = ["--domain", "man:Landmark", "--range", "man:Region", "--unit", "unit:RAD", "--grounded-by", "on_site"]
    new("predicate", "turned_to", *chosen)
    text = Path("turned_to.ttl").read_text()
    for line in (
        "core:domain man:Landmark",
        "core:range man:Region",
        "core:marginUnit unit:RAD",
        'core:groundedBy "on_site"',
    ):
        assert f"    {line} ;\n" in text
    new("predicate", "upright", "--arity", "1")
    assert "core:range" not in Path("upright.ttl").read_text()


def test_a_binding_is_of_the_classes_of_its_predicate(folder):
    new("binding", "lies", "--lifts", "man:on", "--native", "LiesOn", "--grounded-by", "on_object")
    text = Path("lies.ttl").read_text()
    assert "core:nativeArgument1 man:Object ;\n    core:nativeArgument2 man:Support ;" in text
    assert 'core:native "LiesOn"' in text
    assert check_all([folder / "lies.ttl"]).problems == ()


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("predicate", "x", "--unit", "unit:MM-PER-SEC"), "NEW005", "did you mean `unit:M-PER-SEC`?"),
        (("predicate", "x", "--unit", "parsec"), "NEW005", "give one of unit:M, unit:M-PER-SEC, unit:N, unit:RAD"),
        (("predicate", "x", "--domain", "man:Objct"), "NEW005", "did you mean `man:Object`?"),
        (("predicate", "x", "--range", "man:on"), "NEW005", "did you mean `man:Region`?"),
        (("predicate", "x", "--range", "no prefix"), "NEW005", "class"),
        (("predicate", "x", "--grounded-by", "on_objects"), "NEW005", "did you mean `on_object`?"),
        (("predicate", "x", "--grounded-by", "quux"), "NEW005", "`onto new grounding quux` begins one"),
        (("predicate", "x", "--arity", "1", "--grounded-by", "on_object"), "NEW006", "joint_threshold"),
        (("predicate", "x", "--arity", "3"), "NEW006", "--arity 1 or 2"),
        (("predicate", "x", "--arity", "0"), "NEW006", "--arity 1 or 2"),
        (("grounding", "x", "--arity", "3"), "NEW006", "--arity 1 or 2"),
        (("predicate", "x", "--arity", "1", "--range", "man:Object"), "NEW006", "--range"),
        (("failure", "x", "--unit", "unit:M"), "NEW006", "predicate"),
        (("task", "x", "--iri", "https://example.org/x"), "NEW006", "package"),
        (("binding", "x"), "NEW006", "--lifts"),
        (("binding", "x", "--lifts", "man:on"), "NEW006", "--grounded-by"),
        (("binding", "x", "--lifts", "man:onn"), "NEW005", "did you mean `man:on`?"),
        (("binding", "x", "--lifts", "man:Object"), "NEW005", "predicate"),
        (("predicate", "On"), "NEW002", "another name"),
        (("route", "pick_and_place"), "NEW002", "another name"),
        (("failure", "relation_missing"), "NEW002", "another name"),
        (("grounding", "on_object", "--into", "f.ttl"), "NEW002", "another name"),
        (("grounding", "on_object"), "NEW002", "another name"),
        (("package", "on_object"), "NEW002", "another name"),
        (("package", "class"), "NEW001", "another name"),
        (("package", "numpy"), "NEW002", "another name"),
        (("proposer", "json"), "NEW002", "another name"),
        (("grounding", "9x"), "NEW001", "letter"),
    ],
)
def test_options_that_cannot_be_used_are_refused_with_what_to_do(words, code, said, folder):
    with pytest.raises(OntoError) as caught:
        new(*words)
    (problem,) = caught.value.problems
    assert problem.code == code
    assert said in problem.hint
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize("kind", ["ontology", "task", "grounding", "proposer", "package"])
def test_nothing_is_written_over(kind, folder):
    new(kind, "folded_by")
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    assert codes(kind, "folded_by") == ["NEW004"]
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


@pytest.mark.sim
@pytest.mark.parametrize("arity", [1, 2])
def test_a_new_grounding_function_measures(arity, folder, capsys):
    new("grounding", "settled_by", "--arity", str(arity))
    assert 'settled_by = "settled_by:settled_by"' in capsys.readouterr().err
    body = '<body name="{0}_main" pos="0 {1} 0" euler="{2} 0 0"><freejoint/><geom size="0.03"/></body>'
    things = body.format("a", 0.004, 3) + body.format("b", 0, 0)
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{things}</worldbody></mujoco>")
    names = ("a", "b")[:arity]
    fact = Fact("p", tuple(Entity(name, "C") for name in names), NativeAtom("P", names), "settled_by")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    module = runpy.run_path("settled_by.py")
    evidence = module["settled_by"](Scene(model), fact, None)(data)
    assert evidence.truth
    assert evidence.margin == pytest.approx({1: 0.1 - math.radians(3), 2: 0.01 - 0.004}[arity])


def test_a_new_proposer_serves_the_route_of_its_name(folder, capsys):
    new("proposer", "press_flat")
    assert 'press_flat = "press_flat:PressFlatProposer"' in capsys.readouterr().err
    assert 'Proposal("press_flat", ' in Path("press_flat.py").read_text()


@pytest.mark.sim
@pytest.mark.parametrize("name", ["begin_line", "X2"])
def test_a_new_package_passes_its_tests_and_onto_check(name, folder):
    (folder / "made here").mkdir()  # an empty folder holds nothing that could be lost
    new("package", name, "--into", "made here", "--iri", "https://example.com/lab#")
    package = folder / "made here"
    environment = environment_with(package, folder / "installed")
    tests = run_with(environment, "-m", "pytest", "-q", "-p", "no:cacheprovider", cwd=package)
    assert "3 passed" in tests.stdout, tests.stdout + tests.stderr
    checked = run_with(environment, "-m", "onto_evwm", "check", ".", "--json", cwd=package)
    assert (checked.returncode, json.loads(checked.stdout)["problems"]) == (0, []), checked.stderr
    assert run_with(environment, "-m", "onto_evwm", "fmt", "--check", ".", cwd=package).returncode == 0


def test_a_misspelt_kind_is_told_from_a_declared_one():
    with pytest.raises(OntoError) as caught:
        new("predicate", "x", "--of", "man:ObjektRelation")
    assert caught.value.problems[0].hint == "did you mean `man:ObjectRelation`?"
