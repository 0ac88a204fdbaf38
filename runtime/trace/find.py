"""Which episode of a trace a person means: by number, by name, by a part of its name, or by IRI."""

from __future__ import annotations

from collections.abc import Sequence
from urllib.parse import unquote

from onto_compiler.problems import OntoError, near

__all__ = ["find_episode", "title"]

_FEW = 4


def title(iri: str) -> str:
    """``suite/task/state`` of an episode's IRI."""
    return unquote(iri.partition("/episode/")[2])


def find_episode(wanted: str, iris: Sequence[str]) -> str:
    """The one of ``iris`` that ``wanted`` names; numbers count from 1 in the order of ``onto trace list``.

    Raises:
        OntoError: TRC006, where none or several fit.
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
    names = {iri: title(iri) for iri in iris}
    for fits in (
        [iri for iri, name in names.items() if wanted in {iri, name}],
        [iri for iri, name in names.items() if wanted in name.split("/")],
        [iri for iri, name in names.items() if wanted.replace(" ", "_").casefold() in name.casefold()],
    ):
        if len(fits) == 1:
            return fits[0]
        if fits:
            shown = ", ".join(f"`{names[iri]}`" for iri in fits[:_FEW]) + (" ..." if len(fits) > _FEW else "")
            raise OntoError.of("TRC006", f"`{wanted}` fits {len(fits)} episodes", f"name one of {shown}")
    tasks = {name.split("/")[-2] for name in names.values() if "/" in name}
    hint = near(wanted, tasks) or "`onto trace list` lists the episodes"
    raise OntoError.of("TRC006", f"no episode is called `{wanted}`", hint)
