"""House style concerns a project's own terms; of other people's, only what RDF, OWL or SHACL call wrong is reported."""

import pytest

from onto_compiler.check.fix import fix
from onto_compiler.check.run import check
from onto_compiler.check.settings import Settings, parse_codes, read_settings
from onto_compiler.problems import OntoError

PREFIXES = """@prefix x: <https://example.org/x#> .
@prefix dcterms: <http://purl.org/dc/terms/> .
@prefix man: <https://w3id.org/onto-evwm/manipulation#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix skos: <http://www.w3.org/2004/02/skos/core#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
"""
HEADER = """<https://example.org/x> a owl:Ontology ;
    dcterms:title "x"@en ; dcterms:license <https://l.example/> ; owl:versionInfo "1" ; rdfs:comment "c"@en{} .
"""
IMPORT = " ; owl:imports <https://w3id.org/onto-evwm/manipulation>"
DEFINED = "rdfs:isDefinedBy <https://example.org/x>"
STYLES = ("DOC", "OWL00", "VOC")


def found(tmp_path, text, settings=Settings(), own=True):  # noqa: B008 - frozen
    path = tmp_path / "x.ttl"
    path.write_text(PREFIXES + HEADER.format(IMPORT if own else "") + text)
    problems = check([path], settings=settings).problems
    return sorted(p.code for p in problems if p.severity != "info" and p.code.startswith(STYLES))


@pytest.mark.parametrize(
    ("label", "codes"),
    [
        ('"cup"@en', []),
        ('"cup"@en , "Tasse"@de , "tasse"@fr', []),
        ('"cup"@en , "Tasse"@de , "mug"@en', ["DOC002"]),
        ('"cup"@en , "mug"@EN', ["DOC002"]),
        ('"cup" , "mug"', ["DOC002"]),
        ('"cup" , "Tasse"@de', []),
    ],
)
def test_one_label_for_each_language(label, codes, tmp_path):
    text = f'x:A a owl:Class ; rdfs:label {label} ; skos:definition "A cup."@en ; {DEFINED} .'
    assert found(tmp_path, text) == codes


@pytest.mark.parametrize(
    "end",
    [".", "?", "!", "。", "\uff1f", "…", "।", "؟", ".\n  ", '(See "x.")', ".”", ".»", "。」", ".)", "…)"],
)
def test_a_sentence_may_end_as_its_language_ends_it(end, tmp_path):
    text = f'x:A a owl:Class ; rdfs:label "a"@en ; skos:definition """It is{end}"""@en ; {DEFINED} .'
    text = text.replace('(See "x.")', "(See 'x.')")
    assert found(tmp_path, text) == []


@pytest.mark.parametrize("end", ["", ",", ":", "(of tea)", "1", " .a", "\n"])
def test_what_ends_no_sentence_is_found(end, tmp_path):
    text = f'x:A a owl:Class ; rdfs:label "a"@en ; skos:definition """A cup{end}"""@en ; {DEFINED} .'
    assert found(tmp_path, text) == ["DOC004"]


def test_one_definition_for_each_language(tmp_path):
    text = 'x:A a owl:Class ; rdfs:label "a"@en ; skos:definition "A cup."@en , "Eine Tasse."@de{} ; ' + DEFINED + " ."
    assert found(tmp_path, text.format("")) == []
    assert found(tmp_path, text.format(' , "A mug."@en')) == ["DOC007"]


UNSTYLED = """x:A a owl:Class ; rdfs:label "a" , "b" ; skos:definition "no stop" .
x:A rdfs:isDefinedBy <https://example.org/x> .
x:B a owl:Class . x:d a owl:DatatypeProperty ; rdfs:isDefinedBy <https://example.org/x> .
x:p a owl:ObjectProperty ; rdfs:domain x:A . x:b a x:B ; x:p x:b .
"""


def test_other_peoples_style_is_their_own(tmp_path):
    assert found(tmp_path, UNSTYLED, own=False) == []
    assert {"DOC002", "DOC004", "DOC005", "VOC005", "VOC010"} <= set(found(tmp_path, UNSTYLED))


def test_style_is_asked_for_by_namespace_or_by_code(tmp_path):
    own = Settings(namespaces=("https://example.org/x#",))
    assert {"DOC002", "DOC004", "DOC005"} <= set(found(tmp_path, UNSTYLED, own, own=False))
    assert set(found(tmp_path, UNSTYLED, Settings(select=("DOC004",)), own=False)) == {"DOC004"}
    assert "VOC005" in found(tmp_path, UNSTYLED, Settings(select=("",)), own=False)
    assert "DOC004" not in found(tmp_path, UNSTYLED, Settings(ignore=("DOC",)))


def test_an_import_of_an_own_ontology_is_own_too(tmp_path):
    (tmp_path / "base.ttl").write_text(PREFIXES + HEADER.format(IMPORT))
    text = HEADER.format(" ; owl:imports <https://example.org/x>").replace("org/x>", "org/y>", 1)
    (tmp_path / "y.ttl").write_text(PREFIXES + text + "<https://example.org/y#C> a owl:Class .\n")
    assert "DOC005" in {problem.code for problem in check([tmp_path]).problems}


def test_a_term_of_others_that_is_declared_again_needs_no_documentation(tmp_path):
    text = f'dcterms:contributor a owl:AnnotationProperty ; rdfs:label "Contributor"@en ; {DEFINED} .'
    assert found(tmp_path, text) == []
    assert found(tmp_path, text, own=False) == []


def test_an_aligned_term_keeps_the_label_that_its_own_file_gives(tmp_path):
    sosa = "<http://www.w3.org/ns/sosa/Sensor>"
    text = f'{sosa} a owl:Class ; rdfs:label "Sensor"@en ; skos:definition "S."@en ; {DEFINED} .'
    select = Settings(select=("DOC002",))
    assert found(tmp_path, text, select) == []


@pytest.mark.parametrize(
    ("use", "codes"),
    [
        ("x:C a owl:Class ; rdfs:subClassOf x:Old .", ["VOC006"]),
        ("x:C a owl:Class ; rdfs:subClassOf x:Old ; owl:deprecated true .", []),
        (
            'x:C a owl:Class ; rdfs:subClassOf x:Old ; owl:deprecated "1"^^xsd:boolean .',
            [],
        ),
        ("x:C a owl:Class ; rdfs:subClassOf [ owl:unionOf ( x:Old x:New ) ] .", ["VOC006"]),
        ("x:C a owl:Class ; owl:deprecated true ; rdfs:subClassOf [ owl:unionOf ( x:Old x:New ) ] .", []),
        ("x:New owl:disjointWith x:Old .", []),
        ("[] a owl:AllDisjointClasses ; owl:members ( x:New x:Old ) .", []),
    ],
)
def test_what_is_deprecated_may_use_what_is_deprecated(use, codes, tmp_path):
    text = "x:Old a owl:Class ; owl:deprecated true ; dcterms:isReplacedBy x:New . x:New a owl:Class .\n"
    assert [one for one in found(tmp_path, text + use) if one == "VOC006"] == codes


def test_only_others_uses_of_a_deprecated_term_are_told(tmp_path):
    (tmp_path / "vocabulary.ttl").write_text(PREFIXES + "x:Old a owl:Class ; owl:deprecated true .\nx:i a x:Old .\n")
    (tmp_path / "data.ttl").write_text(PREFIXES + "<https://example.org/y#i> a x:Old .\n")
    problems = [problem for problem in check([tmp_path]).problems if problem.code == "VOC006"]
    assert [(p.file.rpartition("/")[2], p.severity) for p in problems] == [("data.ttl", "warning")]


@pytest.mark.parametrize(("host", "severity"), [("elsewhere.org", "info"), ("other.org", "error")])
def test_a_class_that_a_missing_import_may_give_is_no_fault(host, severity, tmp_path):
    path = tmp_path / "x.ttl"
    path.write_text(
        PREFIXES
        + "<https://example.org/x> a owl:Ontology ; owl:imports <https://elsewhere.org/units> .\n"
        + "@prefix sh: <http://www.w3.org/ns/shacl#> .\n"
        + "x:S a sh:NodeShape ; sh:targetNode x:i ; sh:property [ sh:path x:p ; sh:class x:A ] .\n"
        + f"x:i x:p <https://{host}/unit/M> .\n"
    )
    assert [p.severity for p in check([path]).problems if p.code == "SHP001"] == [severity]


def test_an_undeclared_term_is_found_where_the_file_is_all_there_is_of_its_namespace(tmp_path):
    text = f"x:A a owl:Class ; {DEFINED} . x:B a owl:Class ; rdfs:subClassOf x:Missing .\n"
    assert found(tmp_path, text, own=False) == ["VOC001"]
    elsewhere = "<https://example.org/x> owl:imports <https://example.org/x#more> ."
    assert found(tmp_path, text + elsewhere, own=False) == []
    other = f"<https://z.example/i> a x:A ; {DEFINED} ; rdfs:seeAlso <https://z.example/j> ."
    assert found(tmp_path, f"x:A a owl:Class . {other}", own=False) == []


def test_repairs_leave_other_peoples_style_alone(tmp_path):
    path = tmp_path / "x.ttl"
    path.write_text(PREFIXES + HEADER.format("") + UNSTYLED)
    assert {edit.problem.code for edit in fix([path]).edits} <= {"TTL007"}


@pytest.mark.parametrize("name", ["onto.toml", "pyproject.toml"])
def test_the_nearest_settings_count(name, tmp_path):
    table = "[check]" if name == "onto.toml" else "[tool.onto.check]"
    (tmp_path / name).write_text(f'{table}\nnamespaces = ["https://example.org/x#"]\nignore = ["doc005", "OWL"]\n')
    (tmp_path / "inner").mkdir()
    found = read_settings([tmp_path / "inner" / "x.ttl"])
    assert found == Settings(namespaces=("https://example.org/x#",), ignore=("DOC005", "OWL"), root=tmp_path)
    (tmp_path / "inner" / "pyproject.toml").write_text("[project]\nname = 'no settings'\n")
    assert read_settings([tmp_path / "inner" / "x.ttl"]) == found


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('ignor = ["DOC"]', "did you mean `ignore`?"),
        ('ignore = ["DOC0004"]', "did you mean `DOC004`?"),
        ("select = 3", 'write `select = ["..."]`'),
        ("select = [", "see docs/checks.md"),
        ('severity = { VOC006 = "warn" }', "there are error, warning, info"),
        ('severity = { VOC0066 = "error" }', "did you mean `VOC006`?"),
        ('per-file-ignores = ["a.ttl"]', "see docs/checks.md"),
        ('exclude = "a.ttl"', 'write `exclude = ["..."]`'),
        ('exclud = ["a.ttl"]', "did you mean `exclude`?"),
        ('imports = ["a.ttl"]', "see docs/checks.md"),
        ("imports = { x = 3 }", 'write `"IRI" = "FILE"`'),
        ('imports = { x = "none.ttl" }', "correct the path"),
        ('per-file-ignores = { "a.ttl" = ["DOC0004"] }', "did you mean `DOC004`?"),
    ],
)
def test_a_wrong_setting_is_named(text, said, tmp_path):
    (tmp_path / "onto.toml").write_text(f"[check]\n{text}\n")
    with pytest.raises(OntoError) as raised:
        read_settings([tmp_path])
    (problem,) = raised.value.problems
    assert problem.code == "CFG001"
    assert problem.hint.startswith(said)


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("onto.toml", "[chek]\nignore = []", "did you mean `check`?"),
        ("onto.toml", "ignore = []", "write the settings below `[check]`"),
        ("onto.toml", "check = 3", "see docs/checks.md"),
        ("pyproject.toml", "[tool.onto.checks]\nignore = []", "did you mean `check`?"),
        ("pyproject.toml", "[tool.onto]\ncheck = 3", "see docs/checks.md"),
    ],
)
def test_a_table_that_nothing_reads_is_named(name, text, said, tmp_path):
    (tmp_path / name).write_text(text)
    with pytest.raises(OntoError) as raised:
        read_settings([tmp_path])
    (problem,) = raised.value.problems
    assert (problem.code, problem.hint.startswith(said)) == ("CFG001", True)


def test_tables_of_other_commands_and_tools_are_left_alone(tmp_path):
    (tmp_path / "pyproject.toml").write_text('[tool.onto]\nimports = ["m"]\n[tool.onto.schema]\n[tool.check]\n[chek]\n')
    assert read_settings([tmp_path]) == Settings()


def test_codes_may_be_given_by_how_they_begin():
    assert parse_codes(["doc", "VOC006", "all"]) == ("DOC", "VOC006", "")


def test_a_contradiction_is_found_where_style_is_not(tmp_path):
    text = """x:A a owl:Class ; owl:disjointWith x:B . x:B a owl:Class .
x:p a owl:ObjectProperty ; rdfs:range x:A . x:b a x:B ; x:p x:b .
"""
    assert found(tmp_path, text, own=False) == ["OWL009"]


def test_severities_and_ignored_files_are_set(tmp_path):
    (tmp_path / "onto.toml").write_text(
        '[check]\nseverity = { DOC = "warning", DOC004 = "info" }\nper-file-ignores = { "vendor/*.ttl" = ["DOC"] }\n'
    )
    (tmp_path / "vendor").mkdir()
    for place in (tmp_path, tmp_path / "vendor"):
        text = HEADER.format(IMPORT).replace("org/x>", f"org/{place.name}>")
        (place / "x.ttl").write_text(
            PREFIXES.replace("org/x#", f"org/{place.name}#")
            + text
            + f'x:A a owl:Class ; skos:definition "no stop" ; rdfs:isDefinedBy <https://example.org/{place.name}> .\n'
        )
    problems = check([tmp_path], settings=read_settings([tmp_path])).problems
    found = {(p.code, p.severity, p.file == str(tmp_path / "x.ttl")) for p in problems if p.code.startswith("DOC")}
    assert found == {("DOC001", "warning", True), ("DOC004", "info", True)}


def test_a_file_that_cannot_be_read_is_always_told():
    assert Settings(select=("DOC",), ignore=("TTL",)).reports("TTL003")
    assert not Settings(ignore=("TTL",)).reports("TTL007")


def test_after_very_many_comparisons_names_are_reported_without_a_guess(tmp_path, monkeypatch):
    text = (
        "x:Cup a owl:Class . x:A a owl:Class ; rdfs:subClassOf x:Cupp , x:Cub ; rdfs:isDefinedBy <https://e.example/> ."
    )
    path = tmp_path / "x.ttl"
    path.write_text(PREFIXES + HEADER.format(IMPORT) + text)

    def guesses():
        return [p.hint.startswith("did you mean `x:Cup`?") for p in check([path]).problems if p.code == "VOC001"]

    assert guesses() == [True, True]
    monkeypatch.setattr("onto_compiler.check.locate._COMPARISONS", 0)
    assert sorted(guesses()) == [False, True]
