"""What ``onto check`` and ``onto explain`` print, and how they exit."""

import argparse
import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import ontology
from onto_compiler.check.command import CHECK, EXPLAIN
from onto_compiler.command import CLEAN, FINDINGS, MISUSE
from onto_compiler.problems import OntoError

HERE = Path(__file__).parent
BROKEN, GOOD = HERE / "broken", HERE / "good"
HEAVY = ("rdflib", "pyshacl", "owlready2", "numpy", "mujoco", "torch", "lark")


def run(command, *words):
    parser = argparse.ArgumentParser()
    command.configure(parser)
    return command.run(parser.parse_args([str(word) for word in words]))


def test_the_shipped_ontology_is_clean(capsys):
    assert run(CHECK) == CLEAN
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(f"no problem found in {len(ontology.turtle_files())} files (")


def test_an_error_is_shown_with_its_line_and_a_caret(capsys):
    assert run(CHECK, BROKEN / "voc001_undeclared_class.ttl") == FINDINGS
    out, err = capsys.readouterr()
    lines = out.splitlines()
    assert lines[0] == "error[VOC001]: `man:Objekt` is not declared"
    assert lines[1].endswith("voc001_undeclared_class.ttl:18:21")
    assert lines[2] == "   |     rdfs:subClassOf man:Objekt ;"
    assert lines[3].index("^") == lines[2].index("man:Objekt")
    assert "did you mean `man:Object`?" in lines[4]
    assert err == "1 problem (1 error) in 1 file\n"


def test_json_holds_the_same_problem(capsys):
    assert run(CHECK, BROKEN / "voc001_undeclared_class.ttl", "--format", "json") == FINDINGS
    (problem,) = json.loads(capsys.readouterr().out)["problems"]
    assert list(problem) == ["code", "severity", "file", "line", "column", "message", "hint"]
    assert (problem["code"], problem["line"], problem["column"]) == ("VOC001", 18, 21)


def test_a_clean_run_prints_empty_json(capsys):
    assert run(CHECK, GOOD, "--json") == CLEAN
    assert json.loads(capsys.readouterr().out) == {"problems": []}


@pytest.mark.parametrize(("fail_on", "code"), [("error", CLEAN), ("warning", FINDINGS)])
def test_warnings_fail_only_where_asked(fail_on, code, capsys):
    assert run(CHECK, BROKEN / "ttl007_unused_prefix.ttl", "--fail-on", fail_on) == code
    out, err = capsys.readouterr()
    assert out.startswith("warning[TTL007]")
    assert err == "1 problem (1 warning) in 1 file\n"


def test_a_missing_path_is_misuse(tmp_path):
    with pytest.raises(OntoError, match=r"nowhere\.ttl` does not exist"):
        run(CHECK, tmp_path / "nowhere.ttl")


@pytest.mark.parametrize("kind", ["missing", "link", "glob"])
def test_a_missing_path_hides_no_other_problem(kind, tmp_path, capsys):
    name, said = {
        "missing": ("no.ttl", "does not exist"),
        "link": ("link.ttl", "is a link to `gone.ttl`, which does not exist"),
        "glob": ("no_*.ttl", "matches no file"),
    }[kind]
    if kind == "link":
        (tmp_path / name).symlink_to("gone.ttl")
    assert run(CHECK, tmp_path / name, BROKEN / "voc001_undeclared_class.ttl", "--json") == MISUSE
    found = {problem["code"]: problem["message"] for problem in json.loads(capsys.readouterr().out)["problems"]}
    assert set(found) == {"TTL002", "VOC001"}
    assert found["TTL002"].endswith(said)


def test_a_folder_without_turtle_is_a_problem(tmp_path):
    assert run(CHECK, tmp_path) == FINDINGS


def test_an_empty_file_is_clean(tmp_path):
    (tmp_path / "empty.ttl").write_text("")
    assert run(CHECK, tmp_path) == CLEAN


def test_a_byte_order_mark_does_not_matter(tmp_path, capsys):
    text = (BROKEN / "voc001_undeclared_class.ttl").read_text(encoding="utf-8")
    (tmp_path / "marked.ttl").write_text(text, encoding="utf-8-sig")
    assert run(CHECK, tmp_path, "--json") == FINDINGS
    assert [p["line"] for p in json.loads(capsys.readouterr().out)["problems"]] == [18]


def test_windows_line_ends_do_not_move_the_place(tmp_path, capsys):
    data = (BROKEN / "rul005_undeclared_in_rule.ttl").read_bytes()
    (tmp_path / "unix.ttl").write_bytes(data)
    run(CHECK, tmp_path, "--json")
    unix = json.loads(capsys.readouterr().out)["problems"]
    (tmp_path / "unix.ttl").write_bytes(data.replace(b"\n", b"\r\n"))
    run(CHECK, tmp_path, "--json")
    assert json.loads(capsys.readouterr().out)["problems"] == unix


def test_all_syntax_errors_are_reported_together(capsys):
    assert run(CHECK, BROKEN / "ttl003_unknown_prefix.ttl", BROKEN / "ttl004_open_string.ttl", "--json") == FINDINGS
    assert [p["code"] for p in json.loads(capsys.readouterr().out)["problems"]] == ["TTL003", "TTL004"]


def test_a_copy_of_a_shipped_file_takes_its_place(tmp_path, capsys):
    copy = tmp_path / "manipulation.ttl"
    text = (ontology.ROOT / "manipulation.ttl").read_text(encoding="utf-8")
    copy.write_text(text, encoding="utf-8")
    assert run(CHECK, copy) == CLEAN
    copy.write_text(text.replace('"A movable rigid body."', '"A movable rigid body"'), encoding="utf-8")
    capsys.readouterr()
    assert run(CHECK, copy, "--json") == FINDINGS
    assert [p["code"] for p in json.loads(capsys.readouterr().out)["problems"]] == ["DOC004"]


def test_a_copy_of_the_whole_ontology_is_clean(tmp_path):
    shutil.copytree(ontology.ROOT, tmp_path / "copy")
    assert run(CHECK, tmp_path / "copy") == CLEAN


def test_problems_of_the_background_are_left_out(tmp_path, capsys):
    """A route that makes a shipped route ambiguous is reported where it is written, not in the shipped file."""
    run(CHECK, BROKEN / "rte010_two_routes.ttl", "--json")
    assert [p["code"] for p in json.loads(capsys.readouterr().out)["problems"]] == ["RTE015", "RTE010"]


def test_a_clean_run_imports_nothing_heavy():
    program = (
        "import argparse, sys; from onto_compiler.check.command import CHECK; parser = argparse.ArgumentParser();"
        "CHECK.configure(parser); code = CHECK.run(parser.parse_args([]));"
        f"print(code, *[name for name in {HEAVY!r} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["0"]


@pytest.mark.parametrize(
    ("namespace", "codes"),
    [("https://w3id.org/onto-evwm/trace/", ["TTL008"]), ("https://example.com/library/of-traces#", [])],
)
def test_a_prefix_may_stand_for_another_vocabulary_but_not_for_a_misspelt_one(namespace, codes, tmp_path, capsys):
    (tmp_path / "x.ttl").write_text(f"@prefix trace: <{namespace}> .\n<https://example.com/a> trace:b 1 .\n")
    run(CHECK, tmp_path, "--json")
    assert [p["code"] for p in json.loads(capsys.readouterr().out)["problems"]] == codes


def test_a_prefix_that_only_sparql_uses_is_used(tmp_path):
    text = "PREFIX trace: <https://w3id.org/onto-evwm/trace#>\n<https://example.com/a> <https://example.com/b> "
    (tmp_path / "x.ttl").write_text(text + '"SELECT ?x WHERE { ?x a trace:Run }" .\n')
    assert run(CHECK, tmp_path, "--fail-on", "warning") == CLEAN


def test_explain_prints_the_page(capsys):
    assert run(EXPLAIN, "voc001") == CLEAN
    assert capsys.readouterr().out.startswith("# VOC001: undeclared term\n")


def test_explain_of_an_unknown_code_is_misuse(capsys):
    assert run(EXPLAIN, "VOC999") == MISUSE
    assert "did you mean `VOC00" in capsys.readouterr().err


def test_statistics_count_codes_and_print_no_problem(capsys):
    assert run(CHECK, BROKEN / "voc001_undeclared_class.ttl", "--statistics") == FINDINGS
    out, _ = capsys.readouterr()
    assert [line.split()[:3] for line in out.splitlines()] == [["1", "VOC001", "error"]]


def test_exit_zero_reports_and_fails_not(capsys):
    assert run(CHECK, BROKEN / "voc001_undeclared_class.ttl", "--exit-zero") == CLEAN
    assert "VOC001" in capsys.readouterr().out


def test_codes_are_selected_and_ignored(capsys):
    path = BROKEN / "voc001_undeclared_class.ttl"
    assert run(CHECK, path, "--select", "DOC,SIG") == CLEAN
    assert run(CHECK, path, "--ignore", "VOC001") == CLEAN
    assert run(CHECK, path, "--select", "VOC") == FINDINGS
    assert "VOC001" in capsys.readouterr().out


def test_settings_count_for_data_and_shapes_too(tmp_path, capsys):
    (tmp_path / "s.ttl").write_text(
        "@prefix x: <https://example.org/x#> . @prefix sh: <http://www.w3.org/ns/shacl#> .\n"
        "x:S a sh:NodeShape ; sh:targetNode x:i ; sh:property [ sh:path x:p ; sh:minCount 1 ] .\n"
    )
    (tmp_path / "d.ttl").write_text("@prefix x: <https://example.org/x#> . x:i x:q 1 .\n")
    arguments = (tmp_path / "d.ttl", "--shapes", tmp_path / "s.ttl")
    assert run(CHECK, *arguments) == FINDINGS
    assert run(CHECK, *arguments, "--ignore", "SHP001") == CLEAN
    capsys.readouterr()
