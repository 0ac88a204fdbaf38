"""What a baseline holds is not reported again; one problem more of the same kind is."""

import argparse

import pytest

from onto_compiler.check.command import CHECK
from onto_compiler.command import CLEAN, FINDINGS
from onto_compiler.problems import OntoError

TEXT = """@prefix x: <https://example.org/x#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
x:A a owl:Klass .
"""


def run(*words):
    parser = argparse.ArgumentParser()
    CHECK.configure(parser)
    return CHECK.run(parser.parse_args([str(word) for word in words]))


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "x.ttl"
    path.write_text(TEXT)
    assert run(path, "--write-baseline", tmp_path / "base.json") == CLEAN
    return path


def test_old_problems_are_left_out_wherever_they_move(file, tmp_path, capsys):
    file.write_text(TEXT.replace("x:A", "\n\nx:A"))
    capsys.readouterr()
    assert run(file, "--baseline", tmp_path / "base.json") == CLEAN
    assert capsys.readouterr().out == ""
    assert run(file) == FINDINGS


def test_one_more_of_a_kind_is_new(file, tmp_path, capsys):
    file.write_text(TEXT + "x:B a owl:Klass .\n")
    capsys.readouterr()
    assert run(file, "--baseline", tmp_path / "base.json") == FINDINGS
    assert capsys.readouterr().out.count("VOC011]") == 1


def test_a_checkout_may_move(file, tmp_path):
    other = tmp_path / "moved"
    other.mkdir()
    for name in ("x.ttl", "base.json"):
        (tmp_path / name).rename(other / name)
    assert run(other / "x.ttl", "--baseline", other / "base.json") == CLEAN


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (None, "cannot read the baseline `base.json`"),
        ("{", "`base.json` is no baseline"),
        ("[]", "`base.json` is no baseline"),
        ('{"version": 1, "problems": [1]}', "`base.json` is no baseline"),
        ('{"version": 2, "problems": []}', "`base.json` is a baseline of version 2, and this program reads version 1"),
    ],
)
def test_what_is_no_baseline_is_told(text, said, file, tmp_path):
    path = tmp_path / "base.json"
    path.unlink()
    if text is not None:
        path.write_text(text)
    with pytest.raises(OntoError) as raised:
        run(file, "--baseline", path)
    (problem,) = raised.value.problems
    assert (problem.code, problem.message.startswith(said)) == ("CFG003", True)
