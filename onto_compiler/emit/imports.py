"""``owl:imports`` from local files alone: the catalogue is what lies in the folders of the given files, by IRI.

Nothing is fetched. An import names an ontology or one version of it: OWL 2 Structural Specification (W3C, 2012), 3.4.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import cast
from urllib.parse import urlparse
from urllib.request import url2pathname

from pyoxigraph import NamedNode, RdfFormat, Store, parse

from onto_compiler.problems import Problem
from onto_compiler.rdf import OWL, RDF
from onto_compiler.sources import collect

__all__ = ["unresolved", "with_imports"]

_TYPE, _ONTOLOGY = NamedNode(RDF + "type"), NamedNode(OWL + "Ontology")
_IMPORTS, _VERSION = NamedNode(OWL + "imports"), NamedNode(OWL + "versionIRI")


def with_imports(paths: Sequence[Path | str]) -> tuple[Path, ...]:
    """The given files, and those of their folders that they import, directly or through others.

    Other files that are not Turtle are ignored.

    Raises:
        OntoError: TTL002, as ``collect``.
    """
    files = list(collect(paths))
    beside = sorted({other for path in files for other in path.parent.glob("*.ttl")} - {*files})
    headers = {path: _header(path) for path in (*files, *beside)}
    catalogue = {name: path for path in reversed(beside) for name in headers[path][0]}
    known = {name for path in files for name in headers[path][0]}
    for path in files:  # grows while it is read
        for wanted in headers[path][1]:
            if wanted not in known and wanted in catalogue:
                found = catalogue[wanted]
                files.append(found)
                known |= {*headers[found][0]}
    return tuple(files)


def unresolved(store: Store) -> Iterator[Problem]:
    """An OWL003 problem for each import of ``store``, one named graph per file, that no file of it declares."""
    declared = {quad.subject for quad in store.quads_for_pattern(None, _TYPE, _ONTOLOGY, None)}
    declared |= {cast("NamedNode", quad.object) for quad in store.quads_for_pattern(None, _VERSION, None, None)}
    for quad in store.quads_for_pattern(None, _IMPORTS, None, None):
        if quad.object not in declared:
            graph = cast("NamedNode", quad.graph_name).value
            yield Problem(
                url2pathname(urlparse(graph).path),
                0,
                0,
                "OWL003",
                "error",
                f"the import `{cast('NamedNode', quad.object).value}` is in none of the files",
                "keep its file in the same folder or give it with --ontology, or correct the IRI",
            )


def _header(path: Path) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The IRIs under which a file can be imported, and those that it imports; none of a file that cannot be read."""
    try:
        triples = list(parse(path=str(path), format=RdfFormat.TURTLE, base_iri=path.as_uri()))
    except (OSError, SyntaxError, ValueError):
        return (), ()
    names = [triple.subject for triple in triples if triple.predicate == _TYPE and triple.object == _ONTOLOGY]
    names += [triple.object for triple in triples if triple.predicate == _VERSION]
    imports = [triple.object for triple in triples if triple.predicate == _IMPORTS]
    return _iris(names), _iris(imports)


def _iris(terms: Iterable[object]) -> tuple[str, ...]:
    return tuple(sorted({term.value for term in terms if isinstance(term, NamedNode)}))
