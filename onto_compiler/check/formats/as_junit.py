"""For CI servers: JUnit XML, one test case for each file and code, and one that passes for each clean file.

Source: the schema of the Jenkins xUnit plug-in (junit-10.xsd), which JUnit's Ant task founded and CI servers read.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from onto_compiler.check.formats.checked import Checked
from onto_compiler.problems import Problem
from onto_compiler.problems import render as render_problem

__all__ = ["render"]

_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # XML 1.0, section 2.2: Char


def render(checked: Checked) -> str:
    """An XML document; what does not fail the check stands in the output of a case that passes."""
    suites = Element("testsuites", name="onto check")
    suite = SubElement(suites, "testsuite", name="onto check")
    failed = 0
    cases = list(_cases(checked))
    for file, code, problems in cases:
        case = SubElement(suite, "testcase", classname=_clean(file or "onto check"), name=code or "clean")
        if not problems:
            continue
        text = _clean("\n\n".join(render_problem(problem, checked.text(problem.file)) for problem in problems))
        if any(checked.fails(problem) for problem in problems):
            failed += 1
            worst = next(problem for problem in problems if checked.fails(problem))
            SubElement(case, "failure", type=worst.severity, message=_clean(worst.message)).text = text
        else:
            SubElement(case, "system-out").text = text
    for element in (suites, suite):
        for name, count in (("tests", len(cases)), ("failures", failed), ("errors", 0)):
            element.set(name, str(count))
    indent(suites)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(suites, encoding="unicode") + "\n"


def _cases(checked: Checked) -> Iterator[tuple[str, str, list[Problem]]]:
    groups: dict[tuple[str, str], list[Problem]] = {}
    for problem in checked.problems:
        groups.setdefault((problem.file, problem.code), []).append(problem)
    with_problems = {file for file, _ in groups}
    for file in sorted({*checked.files, *with_problems}):
        if file in with_problems:
            yield from ((file, code, found) for (other, code), found in groups.items() if other == file)
        else:
            yield file, "", []


def _clean(text: str) -> str:
    return _NOT_XML.sub("\N{REPLACEMENT CHARACTER}", text)
