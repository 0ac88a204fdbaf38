"""Conformance of the shape and rule engines: the W3C's SHACL suite, Core and SPARQL, and the DASH rule cases, whole.

A report is compared as the suite asks: isomorphic in focus node, path, value, component, source shape and severity; a
rule case, by the set of new triples. What does not pass is listed here by IRI, with the reason.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from benchmarks.protocol import Protocol, Row, Trial

__all__ = ["CONFORMANCE", "EXCEPTIONS", "RULES", "SHACL"]

SHACL, RULES = 121, 7
"""How many cases the archive holds; fewer found is an error of ours."""
EXCEPTIONS: Mapping[str, str] = {}
"""Cases that are not passed, by IRI, with the reason."""


def trials(full: bool) -> list[Trial]:  # noqa: ARG001, FBT001 - the protocol's signature; there is one size
    """Every case of both suites.

    Raises:
        RuntimeError: where the archive does not hold as many as it should.
    """
    from benchmarks.shacl_cases import corpus, rule_cases, shacl_cases  # noqa: PLC0415 - only where it is run

    root = corpus()
    found: list[Trial] = [
        {"key": f"shacl/{case.iri}", "suite": "shacl", "case": case.iri} for case in shacl_cases(root)
    ]
    found += [{"key": f"rules/{case.iri}", "suite": "rules", "case": case.iri} for case in rule_cases(root)]
    if len(found) != SHACL + RULES:
        raise RuntimeError(f"{len(found)} cases found, {SHACL + RULES} expected")
    return found


def run(trial: Trial) -> list[Row]:
    """One case; ``said`` is what is wrong with our answer."""
    from benchmarks.shacl_cases import corpus, rule_cases, run_rule_case, run_shacl_case, shacl_cases  # noqa: PLC0415

    root = corpus()
    if trial["suite"] == "shacl":
        difference = next(run_shacl_case(case) for case in shacl_cases(root) if case.iri == trial["case"])
    else:
        difference = next(run_rule_case(case) for case in rule_cases(root) if case.iri == trial["case"])
    return [{"mode": "none", "sees": "none", "passed": not difference, "said": difference}]


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Counts by suite; a case that crashed has failed."""
    shacl = [row for row in rows if row["suite"] == "shacl"]
    rules = [row for row in rows if row["suite"] == "rules"]
    failed = [row for row in shacl if not row.get("passed")]
    return {
        "shacl_cases": len(shacl),
        "shacl_core_cases": sum(row["case"].startswith("core/") for row in shacl),
        "shacl_sparql_cases": sum(row["case"].startswith("sparql/") for row in shacl),
        "shacl_failed": sum(row["case"] not in EXCEPTIONS for row in failed),
        "shacl_excepted": sum(row["case"] in EXCEPTIONS for row in failed),
        "rule_cases": len(rules),
        "rule_failed": sum(not row.get("passed") for row in rules),
        "crashed": sum("crashed" in row for row in rows),
    }


CONFORMANCE = Protocol(
    name="conformance",
    help="the W3C's SHACL suite and the DASH rule cases",
    seeds=(0,),
    trials=trials,
    run=run,
    metrics=metrics,
)
