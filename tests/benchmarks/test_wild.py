"""Generated shapes give what pySHACL gives, but for what is listed; the protocol's numbers follow from its rows."""

import re

import pytest
from pyoxigraph import RdfFormat, parse

from benchmarks import corpora
from benchmarks.wild import FOUR, WILD
from benchmarks.wild_corrections import CORRECTIONS
from benchmarks.wild_damage import damaged, run_quietly
from benchmarks.wild_made import brick_shapes, building, ontology_text
from benchmarks.wild_pairs import by_pyshacl, compare, ours, write
from benchmarks.wild_shapes import KINDS, PREFIXES, Pair, pair
from onto_compiler.command import MISUSE
from onto_compiler.shacl.syntax import PARAMETERS
from runtime.cli import main

EACH = 2  # pairs of each kind
SHAPE = "ex:S a sh:NodeShape ; sh:targetNode ex:a ; "
ALL_VALUES = "sh:sparql [ sh:select 'SELECT $this ?value WHERE { $this $PATH ?value }' ]"
NO_Q = "sh:property [ sh:path ex:q ; sh:maxCount 0 ]"
RULE = "sh:rule [ a sh:TripleRule ; sh:subject sh:this ; sh:predicate ex:q ; sh:object ex:b ]"
FUNCTION = (
    "ex:f a sh:SPARQLFunction ; sh:parameter [ sh:path ex:op ] ; sh:select 'SELECT (?op * 2 AS ?result) WHERE { }' ."
)


def component(ask):
    """A component with the parameter ``ex:c``, whose validator asks ``ask``."""
    validator = f"[ a sh:SPARQLAskValidator ; sh:ask 'ASK {ask}' ]"
    return f"ex:C a sh:ConstraintComponent ; sh:parameter [ sh:path ex:c ] ; sh:validator {validator} ."


DIFFERENCES = {
    "order of literals": (
        SHAPE + "sh:property [ sh:path ex:p ; sh:minInclusive 1 ] .",
        'ex:a ex:p "x"^^ex:t .',
    ),
    "order of nodes": (SHAPE + "sh:property [ sh:path ex:p ; sh:lessThan ex:q ] .", "ex:a ex:p ex:b ; ex:q ex:c ."),
    "length of a blank node": (SHAPE + "sh:property [ sh:path ex:p ; sh:minLength 0 ] .", "ex:a ex:p [] ."),
    "value of an ASK": (
        f"{component('{ $value ?any $c }')} {SHAPE} sh:property [ sh:path ex:p ; ex:c 1 ] .",
        "ex:a ex:p ex:b .",
    ),
    "brackets in paths": (
        f"{SHAPE} sh:property [ sh:path [ sh:zeroOrMorePath [ sh:zeroOrOnePath ex:p ] ] ; {ALL_VALUES} ] .",
        "ex:a ex:p ex:b .",
    ),
    "inverse of a sequence": (
        f"{SHAPE} sh:property [ sh:path [ sh:inversePath ( ex:p ex:q ) ] ; sh:maxCount 0 ] .",
        "ex:b ex:p ex:c . ex:c ex:q ex:a .",
    ),
    "IN": (
        f"{SHAPE} sh:sparql [ sh:select 'SELECT $this ?v {{ $this ?p ?v FILTER (?v IN (1, 2)) }}' ] .",
        "ex:a ex:p 1.0 .",
    ),
    "false values": (
        f"{component('{ ?any $c $value }')} ex:S a sh:NodeShape ; sh:targetNode 0 ; ex:c ex:p .",
        "ex:a ex:p 1 .",
    ),
    "recursion": (
        f"{SHAPE} sh:nodeKind sh:IRI ; sh:property [ sh:path ex:p ; sh:node ex:S ] .",
        "ex:a ex:p ex:b . ex:b ex:p ex:c . ex:c ex:p ex:d . ex:d ex:p ex:e . ex:e ex:p ex:f . ex:f ex:p 1 .",
    ),
    "literals as subjects": (
        f"ex:S a sh:NodeShape ; sh:targetObjectsOf ex:p ; {RULE} ; sh:property [ sh:path ex:q ; sh:maxCount 0 ] .",
        "ex:a ex:p 1 .",
    ),
    "rules of deactivated shapes": (
        f"ex:R a sh:NodeShape ; sh:targetNode ex:a ; sh:deactivated true ; {RULE} . {SHAPE} {NO_Q} .",
        "ex:a ex:p 1 .",
    ),
    "function without an answer": (
        f"{FUNCTION} {SHAPE} sh:expression [ ex:f ( [ sh:path ex:p ] ) ] .",
        "ex:a ex:p ex:b .",
    ),
    "literals outside the data": (
        f"ex:S a sh:PropertyShape ; sh:targetNode 7 ; sh:path [ sh:zeroOrMorePath ex:p ] ; {ALL_VALUES} .",
        "ex:a ex:p ex:b .",
    ),
}


def of(shapes, data):
    return Pair(0, "", {"shapes.ttl": f"{PREFIXES}{shapes}\n", "data.ttl": f"{PREFIXES}{data}\n"})


@pytest.mark.parametrize("place", range(len(KINDS)), ids=list(KINDS))
def test_generated_shapes_give_what_pyshacl_gives(place, tmp_path):
    for number in range(place, EACH * len(KINDS), len(KINDS)):
        found = compare(pair(number), tmp_path / str(number))
        assert found.unexplained == ()
        assert not found.ours.refused


def test_every_parameter_of_core_is_drawn():
    pairs = [pair(number) for number in range(20 * len(KINDS))]
    assert {one.kind for one in pairs} == set(KINDS)
    used = set(re.findall(r"sh:(\w+)", "".join(text for one in pairs for text in one.files.values())))
    assert PARAMETERS.keys() - {"message"} <= used
    assert {"rule", "target", "expression", "sparql", "construct", "ask", "inversePath", "alternativePath"} <= used
    assert [one.files for one in pairs[:32]] == [pair(number).files for number in range(32)]


def test_each_listed_difference_is_tested():
    assert DIFFERENCES.keys() == CORRECTIONS.keys()


@pytest.mark.parametrize("name", CORRECTIONS)
def test_a_listed_difference_is_there_and_is_no_other(name, tmp_path):
    write(of(*DIFFERENCES[name]), tmp_path)
    mine = ours(tmp_path)
    assert not mine.refused
    assert not mine.agrees(by_pyshacl(tmp_path))
    assert mine.agrees(by_pyshacl(tmp_path, [name]))


def test_a_difference_that_is_not_listed_is_told(tmp_path, monkeypatch):
    monkeypatch.setattr("benchmarks.wild_pairs.CORRECTIONS", {})
    found = compare(of(*DIFFERENCES["IN"]), tmp_path)
    assert found.explained == ()
    assert [line.startswith("only we: <https://example.org/a>") for line in found.unexplained] == [True]


def test_a_building_breaks_the_same_shapes_in_both(tmp_path):
    found = compare(Pair(0, "", {"shapes.ttl": brick_shapes(), "data.ttl": building(200)}), tmp_path)
    assert (found.explained, found.unexplained) == ((), ())
    text = building(9_000)
    assert 8_000 < sum(1 for _ in parse(text.encode(), format=RdfFormat.TURTLE)) < 10_000
    assert ("900.0" in text, "none" in text) == (True, True)


def test_a_made_ontology_grows_with_its_terms():
    counts = [sum(1 for _ in parse(ontology_text(n).encode(), format=RdfFormat.TURTLE)) for n in (100, 400)]
    assert 3.9 < counts[1] / counts[0] < 4.1


@pytest.mark.parametrize("number", range(24))
def test_a_damaged_file_is_no_traceback(number, tmp_path):
    files, words = damaged(number)
    assert files == damaged(number)[0]
    code, said = run_quietly(files, words, tmp_path)
    assert code in {0, 1, 2}, said


def test_the_metrics_follow_from_the_rows():
    none = {"results": 9, "conform": 1, "refused": 0, "differ": 2, "runs": 4, "tracebacks": 0}
    rows = [
        {"part": "pairs", "pairs": 4, "explained": {"IN": 1}, "unexplained": [], **none},
        {"part": "pairs", "pairs": 4, "explained": {"IN": 1}, "unexplained": [{}], **none, "tracebacks": 1},
        {"part": "calls", "runs": 3, "connections": 2, "tracebacks": 0},
        {"part": "damaged", "runs": 5, "tracebacks": 1},
        {"part": "ontology", "times": 1, "triples": 100_000, "cpu_s": 2.0, "peak_mib": 100, "again_cpu_s": 0.5},
        {"part": "ontology", "times": FOUR, "triples": 400_000, "cpu_s": 9.0, "peak_mib": 400, "again_cpu_s": 0.9},
        {"part": "building", "differ": 1, "cpu_s": 2.0, "pyshacl_cpu_s": 50.0},
        {"crashed": "ValueError"},
    ]
    found = WILD.metrics(rows)
    expected = {"pairs": 8, "unexplained_differences": 1, "explained.IN": 2, "connections": 2, "runs": 16}
    assert {name: found[name] for name in expected} == expected
    assert (found["tracebacks"], found["crashed"], found["building_differ"]) == (2, 1, 1)
    ratios = (found["slope"], found["mib_per_100k_triples"], found["cached_ratio"], found["vs_pyshacl"])
    assert ratios == pytest.approx((4.5, 100, 0.1, 25))


def test_the_full_protocol_compares_enough():
    trials = WILD.trials(True)
    assert sum(len(trial["numbers"]) for trial in trials if trial["part"] == "pairs") >= 3_000
    numbers = [number for trial in trials if trial["part"] == "pairs" for number in trial["numbers"]]
    assert len(numbers) == len(set(numbers))
    assert len({trial["key"] for trial in trials}) == len(trials)


def test_a_folder_of_checkouts_is_checked(tmp_path, monkeypatch):
    (tmp_path / "gist" / "ontologies").mkdir(parents=True)
    (tmp_path / "gist/ontologies/one.ttl").write_text(f"{PREFIXES}ex:A a owl:Klass .\n")
    (trial,) = corpora.of_folder(tmp_path)
    monkeypatch.setattr(corpora, "spent", spent_within)
    (row,) = corpora.run(trial)
    assert (row["files"], row["triples"], row["folder"]) == (1, 1, "gist")
    assert "VOC011 error" in row["codes"]
    assert corpora.CORPORA_PROTOCOL.metrics([{**trial, **row}])["gist.problems"] == row["problems"]


def spent_within(command, _, output):
    """What ``spent`` does, without a process of its own."""
    from benchmarks.program import PROGRAM

    _, printed = run_quietly({}, tuple(command[command.index(PROGRAM) + 1 :]), output.parent)
    output.write_text(printed[: printed.rindex("}") + 1])
    return {"cpu_s": 1.0, "peak_mib": 1.0}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["corpora"], "needs a folder"),
        (["check", "."], "takes no folder"),
        (["corpora", "."], "holds no checkout"),
    ],
)
def test_a_folder_is_given_where_one_is_needed(words, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["bench", *words]) == MISUSE
    assert said in capsys.readouterr().err
