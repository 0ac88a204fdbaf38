"""What the core installation holds and does without any extra: a wheel in an environment of its own."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from benchmarks.house_env import core_environment

ROOT = Path(__file__).resolve().parents[2]
EXTRAS = ("mujoco", "robosuite", "libero", "torch", "gymnasium", "h5py", "owlready2", "PIL", "numba")


@pytest.fixture(scope="module")
def core(tmp_path_factory):
    return core_environment(tmp_path_factory.mktemp("core"))


@pytest.fixture
def onto(core, tmp_path):
    def run(*words, **environment):
        for name in ("served.ttl", "serve_the_cheese.bddl", "task76.trig"):
            shutil.copy(ROOT / "docs/examples" / name, tmp_path / name)
        program = [core.parent / "onto", *words]
        # The cache of the user who runs the tests stays out of it, and so does the checkout.
        own = {"PATH": os.environ["PATH"], "HOME": str(tmp_path), **environment}
        return subprocess.run(program, capture_output=True, text=True, check=False, cwd=tmp_path, env=own)

    return run


def test_no_package_of_an_extra_is_installed(core):
    program = f"import importlib.util as u; print([m for m in {EXTRAS} if u.find_spec(m)])"
    assert subprocess.run([core, "-c", program], capture_output=True, text=True, check=True).stdout == "[]\n"


@pytest.mark.parametrize(
    "command",
    [
        "--help",
        "check",
        "check served.ttl",
        "explain SIM018",
        "compile serve_the_cheese.bddl --ontology served.ttl",
        "compile serve_the_cheese.bddl --ontology served.ttl --jobs 2",
        "fmt --check served.ttl",
        "schema --emit jsonld",
        "bench list",
        "trace query --list",
        "trace list task76.trig",
        "trace show 1 task76.trig",
        "trace explain 1 task76.trig",
        "trace query --named repairs task76.trig",
        "trace export task76.trig --format nquads",
        "plan --help",
        "play --help",
        "repair --help",
        "demo --help",
        "demos --help",
        "train --help",
        "audit --help",
    ],
)
def test_what_simulates_nothing_needs_no_simulator(onto, command):
    done = onto(*command.split())
    assert (done.returncode, done.stderr.count("Traceback")) == (0, 0), done.stderr
    assert "internal error" not in done.stderr


@pytest.mark.parametrize(
    ("command", "extra"),
    [
        ("check --reasoner hermit", "hermit"),
        ("ground libero_goal/8", "sim"),
        ("repair libero_goal/8", "sim"),
        ("play libero_goal/8", "sim"),
        ("demo", "sim"),
        ("audit libero_goal", "sim"),
        ("lsp", "lsp"),
    ],
)
def test_what_an_extra_is_needed_for_names_it(onto, command, extra):
    done = onto(*command.split())
    assert done.returncode == 2
    assert f"pip install 'onto-evwm[{extra}]'" in done.stderr
    assert "Traceback" not in done.stderr


def test_every_data_file_of_the_packages_is_in_the_wheel(core):
    (installed,) = core.parent.parent.glob("lib/python*/site-packages")
    packages = ("ontology", "onto_compiler", "grounding", "runtime")
    files = [path for name in packages for path in (ROOT / name).rglob("*") if path.is_file()]
    data = [path.relative_to(ROOT) for path in files if "__pycache__" not in path.parts]
    assert {path.suffix for path in data} >= {".py", ".ttl", ".rq", ".lark", ".css", ".bddl", ".safetensors"}
    assert [str(path) for path in data if not (installed / path).is_file()] == []


def test_the_door_opens_without_extras(core, tmp_path):
    program = "import onto_evwm as o; print(o.check().problems, o.open_trace, o.compile_task)"
    done = subprocess.run([core, "-c", program], capture_output=True, text=True, check=True, cwd=tmp_path)
    assert done.stdout.startswith("() ")


def test_a_package_that_hides_one_of_ours_is_named(core, onto, tmp_path):
    (tmp_path / "runtime").mkdir()
    (tmp_path / "runtime" / "__init__.py").touch()
    done = onto("check", PYTHONPATH=str(tmp_path))
    assert done.returncode == 2
    assert done.stderr.startswith(f"error[CLI008]: `{tmp_path / 'runtime'}` hides the package `runtime` of onto-evwm")
    assert done.stderr.count("\n") == 1
