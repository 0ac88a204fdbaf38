"""A TBox small enough to read, and the task files that it is tried on."""

from __future__ import annotations

import re
from importlib.util import find_spec
from pathlib import Path

import pytest

from onto_compiler.schema import Binding, JointThreshold, PredicateSignature, Schema

HERE = Path(__file__).parent
EX = "https://example.org/"
SUPERCLASSES = {
    "Thing": (),
    "Object": ("Thing",),
    "Bowl": ("Object", "Thing"),
    "Fixture": ("Thing",),
    "Table": ("Fixture", "Thing"),
    "Region": ("Thing",),
    "Area": ("Region", "Thing"),
    "Cooktop": ("Region", "Thing"),
    "Drawer": ("Region", "Thing"),
    "Threshold": (),
}
SUITES = {"libero_spatial": 10, "libero_object": 10, "libero_goal": 10, "libero_10": 10, "libero_90": 90}


def iri(name: str) -> str:
    return EX + name


def predicate(name: str, notation: str, *parameters: str, grounded_by: str | None = None) -> PredicateSignature:
    classes = tuple(map(iri, parameters))
    return PredicateSignature(iri(name), notation, iri("Spatial"), classes, None, grounded_by)


@pytest.fixture(scope="session")
def schema() -> Schema:
    predicates = (
        predicate("on", "Supported", "Object", "Region", grounded_by="on_site"),
        predicate("stacked", "Stacked", "Object", "Object"),
        predicate("leftOf", "LeftOf", "Object", "Thing"),
        predicate("jointState", "JointState", "Drawer", "Threshold"),
        predicate("touching", "Touching", "Object", "Object", grounded_by="contact"),
        predicate("clean", "Clean", "Object"),
    )

    def binding(order: int, native: str, arguments: str, lifts: str, by: str, **more: object) -> Binding:
        classes = tuple(map(iri, arguments.split()))
        return Binding(iri(f"b{order}"), native, classes, iri(lifts), by, order, **more)

    bindings = (
        binding(10, "On", "Object Object", "stacked", "on_object"),
        binding(20, "On", "Object Area", "leftOf", "on_area", landmark=re.compile(r"left_of_(?P<landmark>.+)")),
        binding(30, "On", "Object Region", "on", "on_site"),
        binding(40, "Open", "Drawer", "jointState", "joint", threshold=True),
        binding(45, "Close", "Drawer", "jointState", "joint", threshold=True),
        binding(50, "Turnon", "Drawer", "jointState", "joint", threshold=True),
    )
    opened = JointThreshold(iri("cabinetOpen"), "wooden_cabinet", "Open", False, -0.14, False, False, "M")
    closed = JointThreshold(iri("cabinetClosed"), "wooden_cabinet", "Close", True, -0.005, False, True, "M")
    return Schema(
        classes={iri(name): frozenset(map(iri, (name, *above))) for name, above in SUPERCLASSES.items()},
        predicates={each.iri: each for each in predicates},
        failures={},
        routes={},
        bindings=bindings,
        thresholds={("wooden_cabinet", "Open"): opened, ("wooden_cabinet", "Close"): closed},
        categories={"akita_black_bowl": iri("Bowl"), "table": iri("Table")},
        regions={
            ("flat_stove", "cook_region"): iri("Cooktop"),
            ("wooden_cabinet", "middle_region"): iri("Drawer"),
        },
        defaults={
            "object": iri("Object"),
            "fixture": iri("Fixture"),
            "region": iri("Region"),
            "workspace": iri("Table"),
            "workspace_region": iri("Area"),
        },
    )


@pytest.fixture(scope="session")
def task_file() -> Path:
    return HERE / "stove_and_drawer.bddl"


@pytest.fixture(scope="session")
def libero_files() -> tuple[Path, ...]:
    """The task files of LIBERO's five suites; skips where LIBERO is not installed, fails where some are missing."""
    spec = find_spec("libero")
    if spec is None or not spec.submodule_search_locations:
        pytest.skip("LIBERO is not installed")
    folder = Path(next(iter(spec.submodule_search_locations))) / "libero" / "bddl_files"
    found = {suite: sorted((folder / suite).glob("*.bddl")) for suite in SUITES}
    assert {suite: len(files) for suite, files in found.items()} == SUITES
    return tuple(file for files in found.values() for file in files)
