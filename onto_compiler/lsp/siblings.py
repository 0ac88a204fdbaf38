"""The other files of an ontology: which files of the workspace belong to a document, as ``onto check FOLDER`` has it.

Those that it imports, whose namespace it has a prefix for, or that import it, and what these import in turn. Not every
file of the workspace: two drafts of one ontology, or a folder of examples, would contradict each other.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final

from pyoxigraph import NamedNode, RdfFormat, parse

import ontology
from onto_compiler.rdf import OWL, RDF
from onto_compiler.terms import text_of
from onto_compiler.turtle.source_map import map_text

__all__ = ["MOST", "Header", "files_below", "header", "ontologies_above", "siblings", "turtle_below"]

MOST: Final = 2000
"""How many Turtle files of a workspace are looked at."""
_TYPE, _ONTOLOGY, _IMPORTS = NamedNode(RDF + "type"), NamedNode(OWL + "Ontology"), NamedNode(OWL + "imports")


@dataclass(frozen=True, slots=True)
class Header:
    """What a file says of itself: ontologies that it declares or imports, and the namespaces of its prefixes."""

    declares: frozenset[str] = frozenset()
    imports: frozenset[str] = frozenset()
    namespaces: frozenset[str] = frozenset()


def turtle_below(folders: Sequence[Path]) -> tuple[Path, ...]:
    """The Turtle files in the folders and below; what is hidden, and what packages brought along, is passed over."""
    return files_below(folders, (".ttl",))


def files_below(folders: Sequence[Path], endings: tuple[str, ...]) -> tuple[Path, ...]:
    """As :func:`turtle_below`, of files whose names end so."""
    return tuple(path for _, path in zip(range(MOST), _walk(folders, endings), strict=False))


def _walk(folders: Sequence[Path], endings: tuple[str, ...]) -> Iterator[Path]:
    for folder in folders:
        for place, inner, names in os.walk(folder):
            inner[:] = sorted(name for name in inner if name[0] != "." and name != "node_modules")
            yield from (Path(place, name) for name in sorted(names) if name.endswith(endings) and name[0] != ".")


def header(text: str, path: Path) -> Header:
    """The header of a text, which may be broken."""
    read = map_text(text, str(path), path.as_uri())
    return Header(
        declares=frozenset(t.subject.value for t in read.find(None, _TYPE, _ONTOLOGY)),
        imports=frozenset(text_of(t.object) for t in read.find(None, _IMPORTS)),
        namespaces=frozenset(prefix.namespace.rstrip("#/") for prefix in read.declared),
    )


def siblings(path: Path, own: Header, files: Sequence[Path]) -> tuple[Path, ...]:
    """Those of ``files`` that belong to the document ``path`` with the header ``own``, in a fixed order.

    Where several declare the same ontology, the one nearest to the document counts; what declares a shipped ontology,
    or the document's own, never does.
    """
    headers = _headers(path, files)
    nearest = _nearest(path, headers)
    for iri in own.declares:
        nearest.pop(iri, None)
    counted = set(nearest.values())
    begin = [nearest[iri] for iri in own.imports if iri in nearest]
    begin += [file for iri, file in nearest.items() if iri.rstrip("#/") in own.namespaces]
    begin += [file for file in counted if headers[file].imports & (own.declares - _shipped())]
    return _closure(begin, headers, nearest)


def ontologies_above(task: Path, folder: Path) -> tuple[Path, ...]:
    """The ontologies that a task file of ``folder`` is lifted by, on top of the shipped ones.

    They lie beside the task, or beside a folder above it or in a folder there; the nearest place that has any counts.
    """
    for above in (task.parent, *task.parent.parents):
        if not above.is_relative_to(folder):
            break
        beside = sorted(above.glob("*.ttl")) if above == task.parent else sorted(above.glob("[!.]*/*.ttl"))
        beside += sorted(above.glob("*.ttl")) if above != task.parent else ()
        headers = _headers(task, beside[:MOST])
        nearest = _nearest(task, headers)
        begin = [file for file in {*nearest.values()} if _builds_on_ours(headers[file], headers, nearest)]
        if begin:
            return _closure(begin, headers, nearest)
    return ()


def _builds_on_ours(own: Header, headers: Mapping[Path, Header], nearest: Mapping[str, Path]) -> bool:
    """Whether an ontology imports a shipped one, by way of others too."""
    begin = [nearest[iri] for iri in own.imports if iri in nearest]
    wider = (headers[file].imports for file in _closure(begin, headers, nearest))
    return any(imports & _shipped() for imports in (own.imports, *wider))


def _headers(path: Path, files: Sequence[Path]) -> dict[Path, Header]:
    return {file: found for file in files if file != path and (found := _header_on_disk(file)) is not None}


def _nearest(path: Path, headers: Mapping[Path, Header]) -> dict[str, Path]:
    """The file that declares each ontology, the nearest to ``path`` of several; none that declares a shipped one."""
    found: dict[str, Path] = {}
    for file in sorted(headers, key=lambda file: (-_shared(file, path), file)):
        for iri in headers[file].declares - _shipped():
            found.setdefault(iri, file)
    return found


def _closure(begin: Sequence[Path], headers: Mapping[Path, Header], nearest: Mapping[str, Path]) -> tuple[Path, ...]:
    found: set[Path] = set()
    waiting = list(begin)
    while waiting:
        file = waiting.pop()
        if file not in found:
            found.add(file)
            waiting += [nearest[iri] for iri in headers[file].imports if iri in nearest]
    return tuple(sorted(found))


def _shared(one: Path, other: Path) -> int:
    """How many leading folders two paths have in common."""
    return len(Path(os.path.commonpath((one.parent, other.parent))).parts)


def _header_on_disk(path: Path) -> Header | None:
    """The header of a file; None if it declares no ontology or cannot be read."""
    try:
        state = path.stat()
    except OSError:
        return None
    return _parsed(path, state.st_mtime_ns, state.st_size)


@lru_cache(maxsize=2 * MOST)
def _parsed(path: Path, _modified: int, _size: int) -> Header | None:
    """As :func:`_header_on_disk`; the time and the size are part of the question, so that a change is noticed."""
    try:
        data = path.read_bytes().removeprefix(b"\xef\xbb\xbf")
        if b"Ontology" not in data:
            return None
        declares, imports = set(), set()
        for one in parse(data, format=RdfFormat.TURTLE, base_iri=path.as_uri()):
            if one.predicate == _TYPE and one.object == _ONTOLOGY and isinstance(one.subject, NamedNode):
                declares.add(one.subject.value)
            elif one.predicate == _IMPORTS and isinstance(one.object, NamedNode):
                imports.add(one.object.value)
    except (OSError, SyntaxError, ValueError):
        return None
    return Header(frozenset(declares), frozenset(imports)) if declares else None


@lru_cache(maxsize=1)
def _shipped() -> frozenset[str]:
    headers = (_header_on_disk(path) for path in ontology.turtle_files())
    return frozenset(iri for found in headers if found is not None for iri in found.declares)
