"""Renaming changes a term everywhere and nothing else; what cannot be renamed is refused in a sentence."""

import re
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import CanonicalizationAlgorithm as Algorithm
from pyoxigraph import Dataset, NamedNode, Quad, RdfFormat, parse

import ontology
from onto_compiler.bddl import parse as parse_task
from onto_compiler.bddl.ast import atoms
from onto_compiler.lsp import task_names, turtle_names
from onto_compiler.lsp.answers import RefusedError
from onto_compiler.lsp.task_tree import uses

ROOT = Path(__file__).resolve().parents[3]
TASK = ROOT / "docs/examples/serve_the_cheese.bddl"
TASKS = sorted((ROOT / "tests").rglob("*.bddl"))
MANIPULATION = ontology.ROOT / "manipulation.ttl"
DIAGNOSIS = ontology.ROOT / "rules/diagnosis.ttl"
HEAD = "@prefix ex: <http://e/> .\n@prefix owl: <http://www.w3.org/2002/07/owl#> .\n"


def applied(texts, changes):
    after = dict(texts)
    for change in sorted(changes, reverse=True):
        text = after[change.file]
        after[change.file] = text[: change.start] + change.text + text[change.end :]
    return after


def renamed(texts, path, offset, new, vocabulary=None):
    name, local, _ = turtle_names.renamable(texts[path], path, offset)
    return applied(texts, turtle_names.rename(name, local, new, texts, vocabulary or {}))


def graph(text, path, old="", new=""):
    def swapped(term):
        return NamedNode(new) if isinstance(term, NamedNode) and term.value == old else term

    read = parse(text, format=RdfFormat.TURTLE, base_iri=path.as_uri())
    dataset = Dataset(Quad(swapped(q.subject), swapped(q.predicate), swapped(q.object)) for q in read)
    dataset.canonicalize(Algorithm.UNSTABLE)
    return dataset


LOCALS = sorted(
    {block.subject.iri for block in turtle_names.read_outline(MANIPULATION, MANIPULATION.read_text()).blocks[1:]}
)


@settings(max_examples=15, deadline=None)
@given(st.sampled_from(LOCALS), st.from_regex(r"[A-Za-z_ä][a-z0-9_é-]{0,8}Zz", fullmatch=True))
def test_the_graph_after_renaming_is_the_graph_with_the_other_name(iri, new):
    texts = {MANIPULATION: MANIPULATION.read_text()}
    block = next(
        one for one in turtle_names.read_outline(MANIPULATION, texts[MANIPULATION]).blocks if one.subject.iri == iri
    )
    after = renamed(texts, MANIPULATION, block.start + 1, new)
    wanted = iri[: iri.rindex("#") + 1] + new
    assert graph(after[MANIPULATION], MANIPULATION) == graph(texts[MANIPULATION], MANIPULATION, iri, wanted)
    assert len(after[MANIPULATION].splitlines()) == len(texts[MANIPULATION].splitlines())


def test_every_file_changes_and_queries_with_it():
    texts = {path: path.read_text() for path in (*ontology.ROOT.rglob("*.ttl"), *ontology.ROOT.rglob("*.rq"))}
    core = ontology.ROOT / "core.ttl"
    offset = texts[core].index("\ncore:failureClass a") + 3
    after = renamed(texts, core, offset, "kindOfFailure")
    changed = {path for path in texts if texts[path] != after[path]}
    assert {core, DIAGNOSIS} <= changed
    assert any(path.suffix == ".rq" for path in changed)
    for path, text in after.items():
        assert not re.search(r"\bcore:failureClass(?![\w-])", re.sub(r"#[^\n]*|sh:message [^;]*;", "", text)), path


def test_each_way_to_write_a_term_gets_the_new_name():
    path = Path("/w/a.ttl")
    text = (
        "@base <http://e/> .\n@prefix : <http://e/> .\n@prefix e: <http://> .\n" + HEAD + "ex:Old a owl:Class .\n"
        '<Old> ex:p :Old , <http://e/Old> , ex:Older , "ex:Old" . # ex:Old\n'
    )
    after = renamed({path: text}, path, text.index("ex:Old") + 3, "New")[path]
    assert after.endswith('ex:New a owl:Class .\n<New> ex:p :New , <http://e/New> , ex:Older , "ex:Old" . # ex:Old\n')


@pytest.mark.parametrize(
    ("at", "new", "said"),
    [
        ("owl:Class", "x", "standard vocabulary"),
        (" a ", "x", "standard vocabulary"),
        ("ex:A a", "B", "already (a.ttl:4): the two would become one"),
        ("ex:A a", "b c", "no local name"),
        ("ex:A a", "b.", "no local name"),
        ("ex:A a", "", "no local name"),
        ("ex:A a", "a/b", "no local name"),
        ("ex:Missing", "x", "No file of this folder declares"),
        ("<http://e/>", "x", "a namespace"),
        (" .\nex:A", "x", "no term here"),
    ],
)
def test_what_cannot_be_renamed_is_refused_in_a_sentence(at, new, said):
    path = Path("/w/a.ttl")
    text = HEAD + "ex:A a owl:Class .\nex:B a owl:Class ; ex:p ex:Missing , <http://e/> .\n"
    offset = text.rindex(at) + (1 if at[0] in " <" else 3)
    with pytest.raises(RefusedError, match=re.escape(said)) as caught:
        renamed({path: text}, path, offset, new)
    assert str(caught.value).endswith((".", ":", "one."))


def test_references_leave_out_the_declaration_where_it_is_not_asked_for():
    path = Path("/w/a.ttl")
    text = HEAD + "ex:A a owl:Class .\nex:B a ex:A ; ex:p ex:A .\n"
    found = list(turtle_names.references("http://e/A", {path: text}))
    assert [text[one.start : one.end] for one in found] == ["ex:A"] * 3
    assert len(list(turtle_names.references("http://e/A", {path: text}, declarations=False))) == 2


def test_every_name_of_a_task_that_parses_is_found():
    assert len(TASKS) > 3
    read = 0
    for path in (TASK, *TASKS):
        text = path.read_text(encoding="utf-8", errors="replace")
        try:
            spec = parse_task(text, str(path))
        except Exception:  # noqa: BLE001, S112 - this corpus holds broken files on purpose
            continue
        read += 1
        found = uses(text)
        declared = {use.name for use in found if use.declares}
        sites = {region.site for region in spec.regions}
        assert {each.name for each in spec.declarations} | sites <= declared, path
        predicates = [use.name for use in found if use.kind == "predicate"]
        wanted = [atom.predicate.casefold() for atom in (*spec.init, *spec.absent, *atoms(spec.goal))]
        assert sorted(predicates) == sorted(wanted), path
    assert read > 3


def test_renaming_an_object_takes_its_regions_along():
    text = TASK.read_text()
    use, written = task_names.renamable(text, text.index("wooden_cabinet_1 - ") + 2)
    assert (use.kind, written) == ("fixture", "wooden_cabinet_1")
    after = applied({TASK: text}, task_names.rename(use, "chest_7", TASK, text))[TASK]
    assert after == text.replace("wooden_cabinet_1", "chest_7")
    assert parse_task(after, "").regions != parse_task(text, "").regions


def test_renaming_a_region_changes_its_own_part_of_the_site_alone():
    text = TASK.read_text()
    offset = text.index("main_table_plate_region") + len("main_table_pl")
    use, written = task_names.renamable(text, offset)
    assert (use.kind, use.name, written) == ("region", "main_table_plate_region", "plate_region")
    after = applied({TASK: text}, task_names.rename(use, "spot", TASK, text))[TASK]
    assert after == text.replace("(plate_region", "(spot").replace("main_table_plate_region", "main_table_spot")
    top = text.replace("(On plate_1 main_table_plate_region)", "(On plate_1 wine_rack_1_top_region)")
    use, _ = task_names.renamable(top, top.index("wine_rack_1_top_region") + 15)
    after = applied({TASK: top}, task_names.rename(use, "roof", TASK, top))[TASK]
    assert after.count("(top_region") == 1, "the region of that name of the cabinet stays"


def test_a_variable_is_renamed_within_its_quantifier():
    text = "(define (:objects a - cup) (:goal (And (forall (?x - cup) (Up ?x)) (exists (?x - cup) (On ?x a)))))"
    use, _ = task_names.renamable(text, text.index("?x)") + 1)
    after = applied({TASK: text}, task_names.rename(use, "?y", TASK, text))[TASK]
    assert after == text.replace("(?x - cup) (Up ?x)", "(?y - cup) (Up ?y)", 1)


@pytest.mark.parametrize(
    ("at", "new", "said"),
    [
        ("(On wine", "x", "The predicate `On` has its name from the ontology"),
        ("- flat_stove", "x", "The category `flat_stove` has its name from the ontology"),
        ("plate_1 - plate", "wine_bottle_1", "declared already"),
        ("plate_1 - plate", "a b", "is no name"),
        ("(:domain", "x", "no name here"),
        ("plate_1 - plate", "main_table_plate_region", "declared already"),
    ],
)
def test_what_a_task_does_not_name_is_refused(at, new, said):
    text = TASK.read_text()
    offset = text.index(at) + (2 if at[0] in "-(" else 0)
    with pytest.raises(RefusedError, match=re.escape(said)):
        task_names.rename(task_names.renamable(text, offset)[0], new, TASK, text)


def test_a_broken_task_still_has_its_names_and_symbols():
    text = TASK.read_text().replace("(On plate_1", "(On plate_1 (").replace("\n  )\n)\n", "\n")
    assert [symbol.name for symbol in task_names.symbols(text)][:3] == ["Regions", "Fixtures", "Objects"]
    assert any(use.name == "cream_cheese_1" for use in uses(text))


def test_colours_cover_the_text_in_order_and_never_overlap():
    for path in (TASK, MANIPULATION, DIAGNOSIS, ROOT / "docs/examples/served.ttl"):
        text = path.read_text()
        found = list(task_names.colours(text) if path.suffix == ".bddl" else turtle_names.colours(text, path, {}))
        assert all(one.end <= other.start for one, other in pairwise(found)), path
        assert not any("\n" in text[one.start : one.end] for one in found), path
        assert len({one.kind for one in found}) > 4, path


BROKEN = st.tuples(
    st.integers(0, 4000), st.text(st.sampled_from("<>()[]{}|~^.;,:\"'\\@#?a- \n😀"), max_size=8), st.integers(0, 40)
)


@settings(max_examples=60, deadline=None)
@given(st.sampled_from([TASK, DIAGNOSIS, ROOT / "docs/examples/served.ttl"]), st.lists(BROKEN, min_size=1, max_size=3))
def test_nothing_fails_on_a_broken_text(path, slips):
    text = path.read_text()
    for at, typed, erased in slips:
        text = text[:at] + typed + text[at + erased :]
    if path == TASK:
        found, coloured = task_names.symbols(text), list(task_names.colours(text))
        flat = [inner for symbol in found for inner in (symbol, *symbol.children)]
    else:
        flat, coloured = turtle_names.symbols(text, path), list(turtle_names.colours(text, path, {}))
    for symbol in flat:
        assert symbol.start <= symbol.name_start <= symbol.name_end <= symbol.end <= len(text)
        assert symbol.name, "an editor refuses a list that holds a symbol without a name"
    assert all(one.end <= other.start for one, other in pairwise(coloured))
    assert all(one.start < one.end for one in coloured)
