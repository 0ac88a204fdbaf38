"""One side of a comparison: Turtle files, folders, or what a git revision held, as descriptions of terms."""

from __future__ import annotations

import io
import re
import subprocess
import tarfile
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pyoxigraph import Literal, NamedNode, Quad, Store

from onto_compiler.problems import OntoError, Problem
from onto_compiler.rdf import OWL, RDF, RDFS
from onto_compiler.sources import collect, read_into
from onto_compiler.terms import Term

__all__ = ["Side", "Version", "read_side"]

_TYPE, _ONTOLOGY = RDF + "type", OWL + "Ontology"
_PLACE = "file:///"
_RELATIVE = re.compile(r"<(?![A-Za-z][A-Za-z0-9+.-]*:)")
_PREFIX = re.compile(r"(?im)^[ \t]*@?prefix[ \t]+([\w.-]*):[ \t]*<([^<>\s]*)>")


@dataclass(frozen=True, slots=True)
class Version:
    """What a header says of its version: ``owl:versionInfo`` and ``owl:versionIRI``, each empty where it does not."""

    info: str = ""
    iri: str = ""


@dataclass(frozen=True, slots=True)
class Side:
    """Statements as they are written, each in the graph of its file.

    ``terms``: IRI -> predicate IRI -> values; ``ontology``: the IRI of the ontology whose file holds a term;
    ``headers``: the same of a file's graph; ``versions``: of each ontology; ``prefixes``: as (name, namespace).
    """

    quads: tuple[Quad, ...]
    terms: Mapping[str, Mapping[str, frozenset[Term]]]
    ontology: Mapping[str, str]
    headers: Mapping[str, str]
    versions: Mapping[str, Version]
    prefixes: tuple[tuple[str, str], ...]


def read_side(given: str) -> Side:
    """Read a file, a folder, or ``REVISION:PATH`` of the git repository around the working directory.

    Raises:
        OntoError: TTL0nn, for what is missing or is not Turtle; SCH005, where git cannot give it.
    """
    revision, colon, path = given.partition(":")
    if Path(given).exists() or not colon or not revision:
        return _side([Path(given)])
    with tempfile.TemporaryDirectory() as folder:
        _extract(revision, path or ".", folder)
        root = Path(folder).resolve()
        try:
            return _side([root / path])
        except OntoError as error:
            raise OntoError(*(_placed(problem, f"{root}/", f"{revision}:") for problem in error.problems)) from None


def _placed(problem: Problem, root: str, revision: str) -> Problem:
    """Name the file as the person did, not where it was unpacked."""
    return replace(problem, file=problem.file.replace(root, revision), message=problem.message.replace(root, revision))


def _extract(revision: str, path: str, folder: str) -> None:
    # A revision that begins with a dash would be an option.
    command = ["git", "archive", "--format=tar", "--end-of-options", revision, path]
    try:
        done = subprocess.run(command, capture_output=True, check=False)  # noqa: S603 - no shell reads it
    except OSError as error:
        raise OntoError.of("SCH005", f"git cannot be run: {error.strerror}", "give files or folders") from error
    if done.returncode:
        reason = done.stderr.decode(errors="replace").strip().partition("\n")[0].removeprefix("fatal: ")
        hint = "give REVISION:PATH, the path as seen from the working directory, or files"
        raise OntoError.of("SCH005", f"git has no `{path}` of `{revision}`: {reason}", hint)
    with tarfile.open(fileobj=io.BytesIO(done.stdout)) as archive:
        for member in archive:
            if (content := archive.extractfile(member)) is not None:
                file = Path(folder, member.name)
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(content.read())


def _side(paths: list[Path]) -> Side:
    found: list[Quad] = []
    problems: list[Problem] = []
    prefixes: dict[tuple[str, str], None] = {}
    (root,) = paths
    for path in collect(paths):
        written: list[Quad] = []
        problems += read_into(Store(), path, None, written)
        if problems:
            continue
        text = path.read_text("utf-8-sig")
        prefixes |= dict.fromkeys(_PREFIX.findall(text))
        found += _moved(written, root.resolve().as_uri()) if _RELATIVE.search(text) else written
    if problems:
        raise OntoError(*problems)
    headers = {
        str(quad.graph_name): quad.subject.value
        for quad in found
        if quad.predicate.value == _TYPE and quad.object == NamedNode(_ONTOLOGY) and isinstance(quad.subject, NamedNode)
    }
    terms: dict[str, dict[str, set[Term]]] = {}
    ontology: dict[str, str] = {}
    for quad in found:
        if isinstance(quad.subject, NamedNode):
            terms.setdefault(quad.subject.value, {}).setdefault(quad.predicate.value, set()).add(quad.object)
            ontology.setdefault(quad.subject.value, headers.get(str(quad.graph_name), ""))
    for iri, about in terms.items():
        for reason in about.get(RDFS + "isDefinedBy", ()):
            if isinstance(reason, NamedNode):
                ontology[iri] = reason.value
    versions = {
        iri: Version(_least(terms[iri].get(OWL + "versionInfo", ())), _least(terms[iri].get(OWL + "versionIRI", ())))
        for iri in headers.values()
    }
    frozen = {iri: {name: frozenset(values) for name, values in about.items()} for iri, about in terms.items()}
    return Side(tuple(found), frozen, ontology, headers, versions, tuple(prefixes))


def _least(terms: Iterable[Term]) -> str:
    return min((term.value for term in terms if isinstance(term, NamedNode | Literal)), default="")


def _moved(quads: Sequence[Quad], root: str) -> Iterator[Quad]:
    """The statements with relative IRIs resolved as if both sides were in one place: ``<#A>`` is the same in each."""

    def moved(term: Term) -> Term:
        if isinstance(term, NamedNode) and term.value.startswith(root):
            return NamedNode(_PLACE + term.value.removeprefix(root))
        return term

    for quad in quads:
        subject, predicate, value = moved(quad.subject), moved(quad.predicate), moved(quad.object)
        yield Quad(subject, predicate, value, quad.graph_name)  # type: ignore[arg-type]
