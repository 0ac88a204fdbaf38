"""``owl:imports``: by ``--import`` or the settings, an XML catalog or a relative IRI; nothing is fetched."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pyoxigraph import NamedNode

from onto_compiler.check.catalog import NAME, Catalog, file_of, read_catalog
from onto_compiler.check.documents import Document, read_document
from onto_compiler.folders import actual
from onto_compiler.problems import OntoError, Problem, Span, near
from onto_compiler.rdf import OWL, RDF, SH

__all__ = ["HINT", "UNKNOWN", "Imports"]

UNKNOWN = "no file is known for it, and nothing is fetched"

_IMPORTS, _VERSION = NamedNode(OWL + "imports"), NamedNode(OWL + "versionIRI")
_TYPE, _ONTOLOGY = NamedNode(RDF + "type"), NamedNode(OWL + "Ontology")
_BUILT_IN = {SH, SH.rstrip("#")}  # the validator knows SHACL itself
HINT = f"give its file with --import IRI=FILE, or map the IRI to it in a {NAME} beside the importing file"


class _NotFoundError(Exception):
    """An import leads to no file; the argument says why."""


@dataclass
class Imports:
    """Finds the files of imports; what is wrong with catalogs is appended to ``problems``, each fault once.

    ``mapped`` are files that the command line or the settings give for IRIs. They go before the ontologies that given
    files declare, and these before catalogs, of which the nearest decides. ``missed`` says why an import leads to no
    file, and ``consulted`` holds every file that was looked for, whether it is there or not.
    """

    mapped: Mapping[str, Path] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    unreadable: list[Problem] = field(default_factory=list)
    followed: dict[str, Path] = field(default_factory=dict)
    missed: dict[str, str] = field(default_factory=dict)
    consulted: set[Path] = field(default_factory=set)
    _missing: list[tuple[Document, str]] = field(default_factory=list)
    _imported: dict[Path, list[str]] = field(default_factory=dict)
    _declared: dict[str, Path] = field(default_factory=dict)
    _catalogs: dict[Path, Catalog | None] = field(default_factory=dict)
    _wanted: set[str] = field(default_factory=set)

    def declare(self, documents: Iterable[Document]) -> None:
        """Let imports find the ontologies that ``documents`` declare, or are a version of."""
        for document in documents:
            imported, declared = _header(document)
            self._imported[document.path] = imported
            for iri in declared:
                self._declared.setdefault(iri, document.path)

    def closed(self, documents: Sequence[Document]) -> list[Document]:
        """``documents``, which are declared, and all that they import, directly or through others.

        Each file is read once, so that circles end.
        """
        found = {document.path: document for document in documents}
        tried = set(found)
        todo = list(documents)
        while todo:
            document = todo.pop(0)
            for iri in self._imported[document.path]:
                path = self._followed(iri, document)
                if path is None or path in tried:
                    continue
                tried.add(path)
                try:
                    found[path] = read_document(path)
                except OntoError as error:
                    self.unreadable += error.problems
                    continue
                self.declare([found[path]])
                todo.append(found[path])
        return list(found.values())

    def missing(self) -> Iterator[Problem]:
        """A problem for each import that leads to no file, at its place."""
        for document, iri in self._missing:
            message = f"the import `{_short(iri, document.path)}` is not followed: {self.missed[iri]}"
            yield Problem.at(_place(document, iri), "IMP001", message, HINT, "warning")

    def unused(self, mapped: Mapping[str, Path]) -> Iterator[Problem]:
        """A problem for each IRI of ``mapped``, which the command line gives, that no file imports."""
        for iri, path in mapped.items():
            if iri not in self._wanted:
                message = f"--import gives a file for `{iri}`, which no file imports"
                hint = near(iri, self._wanted) or "leave it out, or correct the IRI"
                yield Problem(str(path), 0, 0, "IMP001", "warning", message, hint)

    def _followed(self, iri: str, document: Document) -> Path | None:
        names = dict.fromkeys((iri, iri.rstrip("#")))  # a `#` at the end names a part of the same document
        self._wanted |= names.keys()
        if iri in _BUILT_IN:
            return None
        try:
            found = next(filter(None, (self._known(name, document.path) for name in names)), None) or self._named(iri)
        except _NotFoundError as error:
            self.missed.setdefault(iri, str(error))
            self._missing.append((document, iri))
            return None
        self.consulted.add(found)
        self.followed[iri] = found
        return found

    def _known(self, iri: str, importing: Path) -> Path | None:
        if iri in self.mapped:
            return actual(self.mapped[iri])
        if iri in self._declared:
            return self._declared[iri]
        for folder in importing.parents:
            found = self._by_catalog(iri, folder / NAME, set())
            if found is not None:
                return found
        return None

    def _by_catalog(self, iri: str, path: Path, seen: set[Path]) -> Path | None:
        catalog = None if path in seen else self._catalog(path)
        seen.add(path)
        missed = ""
        for url, further in () if catalog is None else catalog.candidates(iri):
            target = file_of(url)
            if further:
                found = None if target is None else self._by_catalog(iri, target, seen)
                if found is not None:
                    return found
            elif target is None:
                missed = missed or f"`{path.name}` maps it to <{url}>, and nothing is fetched"
            elif not self._is_file(target):
                missed = missed or f"`{path.name}` maps it to `{target}`, which is no file"
            else:
                return actual(target)
        if missed:
            raise _NotFoundError(missed)
        return None

    def _catalog(self, path: Path) -> Catalog | None:
        if path not in self._catalogs:
            self._catalogs[path] = None
            try:
                self._catalogs[path] = read_catalog(path) if self._is_file(path) else None
            except OntoError as error:
                self.problems += error.problems
        return self._catalogs[path]

    def _named(self, iri: str) -> Path:
        """The file that an IRI itself names."""
        path = file_of(iri)
        if path is None:
            raise _NotFoundError(UNKNOWN)
        if not self._is_file(path):
            raise _NotFoundError(f"there is no file `{path.name}`")
        return actual(path)

    def _is_file(self, path: Path) -> bool:
        self.consulted.add(path)
        try:
            return path.is_file()
        except OSError:  # such a name is too long for any file
            return False


def _header(document: Document) -> tuple[list[str], list[str]]:
    """The IRIs that a document imports, and those that it can be imported by."""
    imported, declared = set[str](), set[str]()
    for one in document.statements:
        predicate = one.predicate
        if predicate == _IMPORTS and isinstance(one.object, NamedNode):
            imported.add(one.object.value)
        elif predicate == _VERSION and isinstance(one.object, NamedNode):
            declared.add(one.object.value)
        elif predicate == _TYPE and one.object == _ONTOLOGY and isinstance(one.subject, NamedNode):
            declared.add(one.subject.value)
    return sorted(imported), sorted(declared)


def _short(iri: str, importing: Path) -> str:
    """A relative import as it was written."""
    return iri.removeprefix(importing.parent.as_uri() + "/")


def _place(document: Document, iri: str) -> Span:
    if document.has_places:
        source_map = document.source_map()
        for located in source_map.find(None, _IMPORTS, NamedNode(iri)):
            return source_map.span(located.at_object)
    return Span(str(document.path))
