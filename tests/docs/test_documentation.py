"""What the documentation shows is what the programs do."""

import ast
import re
import shlex
from functools import cache
from pathlib import Path

import pytest
from rdflib import Graph
from rdflib.compare import isomorphic

from benchmarks.protocol import load_protocols
from benchmarks.results import RESULTS, read_result
from benchmarks.tables import PAGES, TABLES, fill
from onto_compiler.command import CLEAN, FINDINGS
from runtime.cli import main

ROOT = Path(__file__).resolve().parents[2]
UNMEASURED: set[str] = set()  # protocols whose result is not published yet; their tables say so
PAGES_WITH_COMMANDS = sorted([ROOT / "README.md", *(ROOT / "docs").glob("*.md")])
ORDER = ["ontology", "onto_compiler", "grounding", "runtime", "benchmarks"]
HEAVY = {"mujoco", "torch", "robosuite", "libero"}


def blocks(page, language):
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)


def test_the_predicate_of_the_readme_is_the_one_in_the_example_file():
    (block,) = blocks(ROOT / "README.md", "turtle")
    example = (ROOT / "docs/examples/served.ttl").read_text()
    prefixes = "\n".join(line for line in example.splitlines() if line.startswith("@prefix"))
    subject = Graph().parse(data=f"{prefixes}\n{block}", format="turtle")
    whole = Graph().parse(data=example, format="turtle")
    (term,) = set(subject.subjects())
    mine = Graph()
    mine += whole.triples((term, None, None))
    assert len(subject) == 10
    assert isomorphic(subject, mine)


def test_the_example_ontology_is_clean(capsys):
    assert main(["check", str(ROOT / "docs/examples/served.ttl"), "--fail-on", "warning"]) == CLEAN
    assert capsys.readouterr().out == ""


@pytest.mark.sim
def test_the_readme_shows_what_its_commands_print(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    (session,) = (b for b in blocks(ROOT / "README.md", "console") if "onto diagnose" in b)
    commands = [line.removeprefix("$ ") for line in session.splitlines() if line.startswith("$ ")]
    expected = "\n".join(line for line in session.splitlines() if not line.startswith("$ "))
    assert [main(shlex.split(command)[1:]) for command in commands] == [CLEAN, FINDINGS, CLEAN]
    assert capsys.readouterr().out.strip() == expected.strip()
    assert max(map(len, expected.splitlines())) <= 80


def test_every_command_that_the_documentation_names_exists(capsys):
    named = {
        name
        for page in PAGES_WITH_COMMANDS
        for name in re.findall(r"(?:^\$ |`)onto ([a-z]+)", page.read_text(), re.MULTILINE)
    }
    assert {"check", "compile", "demo", "diagnose", "trace", "bench"} <= named
    main(["--help"])
    overview = capsys.readouterr().out
    for name in sorted(named):
        assert re.search(rf"^  {name}\s", overview, re.MULTILINE), name


def test_every_make_target_that_the_documentation_names_exists():
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    pages = [*PAGES_WITH_COMMANDS, ROOT / "CONTRIBUTING.md"]
    named = {n for page in pages for n in re.findall(r"(?:^|`)make ([a-z-]+)", page.read_text(), re.MULTILINE)}
    assert {"demo", "test", "check", "docs"} <= named <= targets


def test_links_lead_somewhere():
    pages = [*PAGES_WITH_COMMANDS, ROOT / "CONTRIBUTING.md"]
    links = [(page, link) for page in pages for link in re.findall(r"\]\((?!https?:|#)([^)#]+)", page.read_text())]
    assert len(links) >= 5
    assert [(page.name, link) for page, link in links if not (page.parent / link).exists()] == []


@pytest.mark.parametrize("page", PAGES)
def test_tables_are_those_of_the_results(page):
    text = (ROOT / page).read_text()
    assert text.count("<!-- table: ") >= 1
    assert fill(text) == text, "run `make docs`"


def test_results_are_published_clean_and_their_metrics_follow_from_their_rows():
    protocols = {protocol.file.removesuffix(".json"): protocol for protocol in load_protocols().values()}
    files = sorted(RESULTS.glob("*.json"))
    assert set(TABLES) == set(protocols)
    assert {path.stem for path in files} == set(TABLES) - UNMEASURED
    for path in files:
        record = read_result(path)
        assert record["dirty"] is False
        assert re.fullmatch(r"[0-9a-f]{40}", record["commit"])
        assert re.fullmatch(rf"onto bench {protocols[path.stem].name} --full( --part \w+)*", record["command"])
        assert not any(part["dirty"] for part in record.get("parts", {}).values())
        assert all(row.get("crashed") or {"mode", "sees"} <= set(row) for row in record["rows"])
        assert record["metrics"] == pytest.approx(dict(protocols[path.stem].metrics(record["rows"])))


def modules():
    for package in ORDER:
        yield from ((package, path) for path in sorted((ROOT / package).rglob("*.py")))


@cache
def imported(path):
    names = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.append(node.module)
    return names


def test_imports_run_one_way():
    found = list(modules())
    assert len(found) > 60
    backwards = [
        (str(path.relative_to(ROOT)), name)
        for package, path in found
        for name in imported(path)
        if name.split(".")[0] in ORDER[ORDER.index(package) + 1 :]
    ]
    assert backwards == []


def test_the_compiler_imports_nothing_heavy():
    heavy = [
        (str(path.relative_to(ROOT)), name)
        for package, path in modules()
        if package in {"ontology", "onto_compiler"}
        for name in imported(path)
        if name.split(".")[0] in HEAVY
    ]
    assert heavy == []


def test_torch_is_imported_where_a_model_is_trained_or_used_and_nowhere_else():
    allowed = (
        "benchmarks/pointmaze",
        "benchmarks/world_model_libero",
        "grounding/world_model/",
        "runtime/planning/",
        "runtime/training/",
        "runtime/worlds/libero/training/",
        "runtime/worlds/pointmaze/",
    )
    users = {
        str(path.relative_to(ROOT)) for _, path in modules() if "torch" in {n.split(".")[0] for n in imported(path)}
    }
    assert len(users) >= 6
    assert [user for user in users if not user.startswith(allowed)] == []


def test_every_code_has_a_page_and_every_page_a_code():
    sources = [ROOT / "onto_evwm.py", *(path for _, path in modules())]
    sources += [path for ending in ("*.rq", "*.ttl") for path in sorted((ROOT / "ontology").rglob(ending))]
    families = (
        "ABX|BDDL|BEN|BND|CFG|CLI|DEM|DOC|FIX|FMT|IMP|NEW|OWL|PMZ|QRY|RTE|RUL|RUN|SCH|SCR|SHP|SIG|SIM|TRC|TTL|VOC|WM"
    )
    # Ruff has families of the same names.
    texts = [re.sub(r"# noqa.*", "", path.read_text()) for path in sources]
    raised = {code for text in texts for code in re.findall(rf"\b(?:{families})\d{{3}}\b", text)}
    pages = {path.stem for path in (ROOT / "docs/errors").glob("*.md")} - {"README"}
    assert len(pages) > 120
    assert raised == pages
