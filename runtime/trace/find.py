"""Finds an episode of a trace by number, name, part of its name, or IRI."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from urllib.parse import unquote

from onto_compiler.problems import OntoError, near
from runtime.trace.names import RUNS

__all__ = ["find_episode", "title", "titles"]

_FEW = 4


def title(iri: str) -> str:
    """``suite/task/state/seed/trial`` of an episode's IRI."""
    return unquote(iri.partition("/episode/")[2])


def titles(iris: Sequence[str]) -> dict[str, str]:
    """A name for each of ``iris``, no two equal: its title, with the run before it where several runs have the same."""
    often = Counter(map(title, iris))
    names = {iri: title(iri) if often[title(iri)] == 1 else unquote(iri.removeprefix(RUNS)) for iri in iris}
    often = Counter(names.values())
    return {iri: name if often[name] == 1 else iri for iri, name in names.items()}


def _spellings(name: str) -> tuple[str, str]:
    """A name as it is, and with the bare number of its state: ``suite/task/3``."""
    return name, name.replace("/state-", "/")


def find_episode(wanted: str, iris: Sequence[str]) -> str:
    """The one of ``iris`` that ``wanted`` names; numbers count from 1 in the order of ``onto trace list``.

    Raises:
        OntoError: TRC006 if none or several fit.
    """
    if not iris:
        raise OntoError.of("TRC006", "the trace holds no episode", "record some with `onto demo`")
    if wanted.isdecimal():
        if 1 <= int(wanted) <= len(iris):
            return iris[int(wanted) - 1]
        count = len(iris)
        raise OntoError.of(
            "TRC006", f"there is no episode {wanted}", f"the trace numbers its episodes from 1 to {count}"
        )
    names, part = titles(iris), wanted.replace(" ", "_").casefold()
    for fits in (
        [iri for iri, name in names.items() if wanted in {iri, name}],
        [iri for iri, name in names.items() if any(f"/{wanted}/" in f"/{each}/" for each in _spellings(name))],
        [iri for iri, name in names.items() if any(part in each.casefold() for each in _spellings(name))],
    ):
        if len(fits) == 1:
            return fits[0]
        if fits:
            shown = ", ".join(f"`{names[iri]}`" for iri in fits[:_FEW]) + (" ..." if len(fits) > _FEW else "")
            hint = f"name one of {shown}, or give its number of `onto trace list`"
            raise OntoError.of("TRC006", f"`{wanted}` fits {len(fits)} episodes", hint)
    tasks = {part for name in map(title, iris) for part in name.split("/")[1:2]}
    hint = near(wanted, tasks) or "`onto trace list` lists the episodes"
    raise OntoError.of("TRC006", f"no episode is called `{wanted}`", hint)
