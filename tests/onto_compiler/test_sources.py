"""Which files a folder stands for, and links that lead nowhere."""

import pytest

from onto_compiler.check.data import check_data
from onto_compiler.check.tasks import check_all
from onto_compiler.folders import below
from onto_compiler.sources import collect

TURTLE = "<urn:a> <urn:b> <urn:c> .\n"


@pytest.fixture
def project(tmp_path):
    for name in ("a.ttl", "sub/b.ttl", ".venv/lib/c.ttl", "sub/.git/d.ttl", ".hidden.ttl"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(TURTLE)
    (tmp_path / ".#a.ttl").symlink_to("somebody@somewhere.1234")  # an editor's lock
    return tmp_path


def test_hidden_files_and_folders_are_passed_over(project):
    assert [path.relative_to(project).as_posix() for path in below(project, "*.ttl")] == ["a.ttl", "sub/b.ttl"]
    assert len(collect([project])) == 2


def test_a_hidden_folder_that_is_given_is_read(project):
    assert [path.name for path in collect([project / ".venv"])] == ["c.ttl"]


@pytest.mark.parametrize("name", ["loop.ttl", "loop.bddl"])
def test_links_in_a_circle_are_a_problem_of_that_file(tmp_path, name):
    (tmp_path / name).symlink_to(name)
    (problem,) = check_all([tmp_path]).problems
    assert problem.code in {"TTL002", "BDDL004"}
    assert problem.file == str(tmp_path / name)
    assert "symbolic links" in problem.message


def test_data_behind_links_in_a_circle_are_a_problem_of_that_file(tmp_path):
    (tmp_path / "loop.nt").symlink_to("loop.nt")
    (tmp_path / "shapes.ttl").write_text(TURTLE)
    (problem,) = check_data([tmp_path / "loop.nt"], [tmp_path / "shapes.ttl"]).problems
    assert (problem.code, problem.file) == ("TTL002", str(tmp_path / "loop.nt"))
