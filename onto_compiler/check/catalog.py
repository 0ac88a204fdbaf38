"""OASIS XML catalogs (``catalog-v001.xml``, as Protégé writes them): from the IRI of an ontology to a file.

Source: XML Catalogs 1.1 (OASIS, 2005), sections 6.4 and 7.2.2, of which the entries for URIs are read.
Nothing is fetched, and entities are refused.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urljoin, urlsplit

from onto_compiler.problems import OntoError, Problem

__all__ = ["NAME", "Catalog", "file_of", "read_catalog"]

NAME = "catalog-v001.xml"
_SPACE = "urn:oasis:names:tc:entity:xmlns:xml:catalog "
_XML_BASE = "http://www.w3.org/XML/1998/namespace base"
_HINT = f'write it as <catalog xmlns="{_SPACE.strip()}"><uri name="IRI" uri="FILE"/></catalog>'


@dataclass(frozen=True, slots=True)
class Entry:
    """``kind`` is the element's name; ``given`` is the IRI, or what it begins or ends with; ``target`` is a URL."""

    kind: str
    given: str
    target: str


@dataclass(frozen=True, slots=True)
class Catalog:
    """The entries of one catalog file, in their order."""

    path: Path
    entries: tuple[Entry, ...] = ()

    def candidates(self, iri: str) -> Iterator[tuple[str, bool]]:
        """What ``iri`` may stand for, the best first: a URL, and whether it is that of a further catalog."""
        yield from ((one.target, False) for one in self.entries if one.kind == "uri" and one.given == iri)
        rewrites = [one for one in self.entries if one.kind == "rewriteURI" and iri.startswith(one.given)]
        for one in sorted(rewrites, key=lambda one: -len(one.given)):
            yield one.target + iri.removeprefix(one.given), False
        suffixes = [one for one in self.entries if one.kind == "uriSuffix" and iri.endswith(one.given)]
        yield from ((one.target, False) for one in sorted(suffixes, key=lambda one: -len(one.given)))
        delegates = [one for one in self.entries if one.kind == "delegateURI" and iri.startswith(one.given)]
        yield from ((one.target, True) for one in sorted(delegates, key=lambda one: -len(one.given)))
        yield from ((one.target, True) for one in self.entries if one.kind == "nextCatalog")


_ATTRIBUTES = {  # of each kind of entry: what it is for, and where it leads
    "uri": ("name", "uri"),
    "rewriteURI": ("uriStartString", "rewritePrefix"),
    "uriSuffix": ("uriSuffix", "uri"),
    "delegateURI": ("uriStartString", "catalog"),
    "nextCatalog": ("", "catalog"),
}


def file_of(url: str) -> Path | None:
    """The file that a URL names; None where it names something elsewhere."""
    try:
        parts = urlsplit(url)
    except ValueError:  # no URL at all
        return None
    from urllib.request import url2pathname  # noqa: PLC0415 - slow to import, and most checks need no file of a URL

    local = parts.scheme == "file" and parts.netloc in {"", "localhost"}
    return Path(url2pathname(parts.path)) if local else None


def read_catalog(path: Path) -> Catalog:
    """Read one catalog; those that it names are not read.

    Raises:
        OntoError: IMP002, where it cannot be read, is no XML or no catalog, or has no entry.

    """
    from xml.parsers import expat  # noqa: PLC0415 - few checks read a catalog

    reader = _Reader(path.absolute().as_uri())
    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler, parser.EndElementHandler = reader.start, reader.end
    parser.EntityDeclHandler = _refuse
    try:
        parser.Parse(path.read_bytes(), True)
    except expat.ExpatError as error:
        said = f"`{path.name}` is no XML: {expat.ErrorString(error.code)}"
        raise OntoError(_problem(path, said, error.lineno, error.offset + 1)) from error
    except _EntityError as error:
        said = f"`{path.name}` declares an XML entity, and none is expanded"
        raise OntoError(_problem(path, said, parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)) from error
    except (OSError, ValueError) as error:
        raise OntoError(_problem(path, f"`{path.name}` cannot be read: {error}")) from error
    if reader.root != f"{_SPACE}catalog":
        raise OntoError(
            _problem(path, f"`{path.name}` is no XML catalog: its element is `{reader.root.split(' ')[-1]}`")
        )
    if not reader.entries:
        raise OntoError(_problem(path, f"`{path.name}` maps no IRI to a file"))
    return Catalog(path, tuple(reader.entries))


class _EntityError(Exception):
    """The document declares an entity."""


def _refuse(*_: object) -> None:
    raise _EntityError


def _problem(path: Path, message: str, line: int = 0, column: int = 0) -> Problem:
    return Problem(str(path), line, column, "IMP002", "error", message, _HINT)


@dataclass(slots=True)
class _Reader:
    base: str
    root: str = ""
    entries: list[Entry] = field(default_factory=list)
    bases: list[str] = field(default_factory=list)

    def start(self, name: str, attributes: dict[str, str]) -> None:
        self.root = self.root or name
        base = urljoin(self.bases[-1] if self.bases else self.base, attributes.get(_XML_BASE, ""))
        self.bases.append(base)
        kind = name.removeprefix(_SPACE)
        given, target = _ATTRIBUTES.get(kind, ("", ""))
        if target in attributes and (not given or given in attributes):
            self.entries.append(Entry(kind, attributes.get(given, ""), urljoin(base, attributes[target])))

    def end(self, _: str) -> None:
        self.bases.pop()
