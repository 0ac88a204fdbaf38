"""Checks on the prefix declarations of a file, which leave no trace in its triples."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache

from pyoxigraph import NamedNode

from onto_compiler.check.model import Model
from onto_compiler.problems import Problem, Span
from onto_compiler.rdf import PREFIXES

__all__ = ["check_prefixes"]

_DECLARATION = re.compile(r"(?im)^[ \t]*@?prefix[ \t]+([\w.-]*):[ \t]*<([^>]*)>")

_SIMILAR = 0.8  # below it, another vocabulary is meant, which may have the same prefix


def check_prefixes(model: Model) -> Iterator[tuple[Problem, NamedNode]]:
    """Prefixes that nothing uses (SPARQL inside strings counts), and usual ones whose namespace looks mistyped.

    Each comes with the graph of its file.
    """
    for graph, path in model.graphs.items():
        for problem in _of_text(str(path), model.text(path)):
            yield problem, graph


@lru_cache(maxsize=64)  # a keystroke changes one file of many
def _of_text(file: str, text: str) -> tuple[Problem, ...]:
    return tuple(_found(file, text))


def _found(file: str, text: str) -> Iterator[Problem]:
    for match in _DECLARATION.finditer(text):
        name, namespace = match[1], match[2]
        line = text.count("\n", 0, match.start(1)) + 1
        column = match.start(1) - text.rfind("\n", 0, match.start(1))
        span = Span(file, line, column, line, column + len(name) + 1)
        usual = PREFIXES.get(name, namespace)
        if usual != namespace and _similar(usual, namespace):
            yield Problem.at(
                span,
                "TTL008",
                f"the prefix `{name}:` stands for <{namespace}>, not for <{usual}>",
                f"write <{usual}>, or choose another prefix for another namespace",
            )
        elif not re.search(rf"(?<![\w.-]){re.escape(name)}:(?!\s*<)", text):
            yield Problem.at(
                span,
                "TTL007",
                f"the prefix `{name}:` is declared and never used",
                "remove the declaration",
                "warning",
            )


def _similar(usual: str, namespace: str) -> bool:
    from difflib import SequenceMatcher  # noqa: PLC0415 - few files need it

    return SequenceMatcher(None, usual, namespace).ratio() >= _SIMILAR
