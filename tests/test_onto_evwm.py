"""The module that notebooks import: its names, what importing it costs, and what hides a package of ours."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

import onto_evwm

ROOT = Path(__file__).resolve().parents[1]


def python(program, folder, **environment):
    own = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    command = [sys.executable, "-c", program]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder, env=own)


def test_type_checkers_see_the_names_that_are_imported_at_run_time():
    stub = ast.parse((ROOT / "onto_evwm-stubs/__init__.pyi").read_text())
    imports = [node for node in stub.body if isinstance(node, ast.ImportFrom)]
    seen = {alias.asname: node.module for node in imports for alias in node.names}
    assert seen == onto_evwm._HOMES
    assert {*seen, "main"} == set(onto_evwm.__all__)


@pytest.mark.parametrize("name", onto_evwm.__all__)
def test_every_name_is_what_its_own_package_calls_so(name):
    value = getattr(onto_evwm, name)
    assert value.__name__ == name
    assert value.__doc__
    assert name in dir(onto_evwm)


def test_a_name_that_it_does_not_have_is_an_attribute_error():
    with pytest.raises(AttributeError, match="has no attribute 'grund'"):
        _ = onto_evwm.grund


def test_importing_it_imports_nothing_heavy(tmp_path):
    heavy = ("numpy", "rdflib", "pyoxigraph", "lark", "mujoco", "torch", "gymnasium", "rich", "argparse")
    done = python(f"import sys, onto_evwm; print([m for m in {heavy} if m in sys.modules])", tmp_path)
    assert done.stdout == "[]\n", done.stderr


REGISTERED = "['onto/Libero-v0', 'onto/PointMaze-v0', 'onto/Robosuite-v0']\n"
LIST = "print(sorted(i for i in gymnasium.registry if i[:5] == 'onto/'))"
MAKE = "print(gymnasium.make('onto_evwm:onto/PointMaze-v0').spec.id)"


@pytest.mark.sim
@pytest.mark.parametrize("first", ["import onto_evwm, gymnasium", "import gymnasium, onto_evwm"])
def test_gymnasium_knows_the_worlds_whichever_is_imported_first_and_makes_them(first, tmp_path):
    done = python(f"{first}; {LIST}; {MAKE}", tmp_path)
    assert done.stdout == f"{REGISTERED}onto/PointMaze-v0\n", done.stderr


@pytest.mark.sim
def test_gymnasium_imports_what_the_name_of_a_world_says(tmp_path):
    done = python(f"import gymnasium; {MAKE}; {LIST}", tmp_path)
    assert done.stdout == f"onto/PointMaze-v0\n{REGISTERED}", done.stderr


@pytest.mark.parametrize("name", ["runtime", "ontology", "benchmarks"])
@pytest.mark.parametrize("file", ["{}.py", "{}/__init__.py"])
def test_what_hides_a_package_of_ours_is_named_in_one_sentence(file, name, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    path = tmp_path / file.format(name)
    path.parent.mkdir(exist_ok=True)
    path.write_text("raise SystemExit('somebody else ran')")
    sentence = (
        f"`{path.parent if path.stem == '__init__' else path}` hides the package `{name}` of onto-evwm: rename it"
    )
    # As a notebook: the folder that it is started in is searched first.
    done = python("import onto_evwm; onto_evwm.check", tmp_path)
    assert done.stderr.splitlines()[-1].startswith(f"ImportError: CLI008: {sentence}")
    program = "import sys, onto_evwm; sys.exit(onto_evwm.main())"
    done = python(program, tmp_path / "elsewhere", PYTHONPATH=f"{tmp_path}{os.pathsep}{ROOT}")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert done.stderr.startswith(f"error[CLI008]: {sentence}")


def test_a_folder_without_a_module_in_it_hides_nothing_of_a_package_that_is_found_by_its_path(tmp_path):
    (tmp_path / "runtime").mkdir()
    done = python("import onto_evwm; print(onto_evwm.Knowledge.__name__)", tmp_path)
    assert done.stdout == "Knowledge\n", done.stderr
