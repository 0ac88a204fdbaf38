"""A file of data or shapes as it was read, and which formats there are."""

from __future__ import annotations

from codecs import BOM_UTF8
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from pyoxigraph import Quad, RdfFormat, Triple, parse

from onto_compiler.problems import OntoError, Problem
from onto_compiler.sources import MANY, parse_problem, size_problem

if TYPE_CHECKING:
    from onto_compiler.turtle.source_map import SourceMap

__all__ = ["ENDINGS", "HINT", "Document", "read_document"]

ENDINGS = {
    ".ttl": RdfFormat.TURTLE,
    ".nt": RdfFormat.N_TRIPLES,
    ".trig": RdfFormat.TRIG,
    ".nq": RdfFormat.N_QUADS,
    ".rdf": RdfFormat.RDF_XML,
    ".owl": RdfFormat.RDF_XML,
    ".xml": RdfFormat.RDF_XML,
    ".jsonld": RdfFormat.JSON_LD,
    ".json": RdfFormat.JSON_LD,
}
HINT = f"give a file whose name ends in {', '.join(ENDINGS)}, or a folder that holds some"
_NESTED = {RdfFormat.TURTLE, RdfFormat.TRIG}
WITH_PLACES = {RdfFormat.TURTLE, RdfFormat.N_TRIPLES, RdfFormat.TRIG, RdfFormat.N_QUADS}


@dataclass(frozen=True, slots=True)
class Document:
    """A file as Oxigraph read it. The graphs of a dataset count together."""

    path: Path
    format: RdfFormat
    statements: tuple[Quad | Triple, ...]
    text: str | None = None  # where it is not that of the file on disk

    @property
    def has_places(self) -> bool:
        """Whether lines and columns are known."""
        return self.format in WITH_PLACES

    def source_map(self) -> SourceMap:
        """Where each triple is written, in a format :attr:`has_places` is true of."""
        from onto_compiler.turtle.source_map import map_text, read_map  # noqa: PLC0415 - a clean run never needs it

        if self.text is None:
            return read_map(self.path)
        return map_text(self.text, str(self.path), self.path.as_uri())


def read_document(path: Path, text: str | None = None) -> Document:
    """Read one file by its ending; ``text`` takes the place of what is on disk, and is Turtle where no ending says so.

    Raises:
        OntoError: TTL001, TTL002 or TTL009, where it cannot be read.

    """
    kind = ENDINGS.get(path.suffix.lower(), None if text is None else RdfFormat.TURTLE)
    if kind is None:
        raise OntoError.of("TTL002", f"`{path.name}` has no ending that says what it holds", HINT, str(path))
    if text is None and (large := size_problem(path)) is not None:
        raise OntoError(large)
    try:
        data = path.read_bytes().removeprefix(BOM_UTF8) if text is None else text.encode()
        if kind in _NESTED and data.count(b"[") + data.count(b"(") > MANY:
            from onto_compiler.turtle.limits import nesting_problem  # noqa: PLC0415 - few files need it

            problem = nesting_problem(path, data.decode("utf-8", errors="replace"))
            if problem is not None:
                raise OntoError(problem)
        found = parse(data, format=kind, base_iri=path.as_uri(), rename_blank_nodes=True)
        return Document(path, kind, tuple(found), text)
    except SyntaxError as error:
        raise OntoError(_syntax(path, kind, error, text)) from error
    except OSError as error:
        message = f"cannot read `{path.name}`: {error.strerror or error}"
        raise OntoError.of("TTL002", message, HINT, str(path)) from error


def _syntax(path: Path, kind: RdfFormat, error: SyntaxError, text: str | None) -> Problem:
    if kind in _NESTED:
        return parse_problem(path, error, text)
    reason = " ".join(str(error.msg or error).partition(" (line ")[0].split()).rpartition(": ")[2]
    hint = "see `onto explain TTL001`"
    if "LoadDocumentCallback" in reason:
        reason, hint = "its context is at another place, and nothing is fetched", "write the context into the file"
    message = f"not {kind.name}: {reason[:1].lower()}{reason[1:]}"
    return Problem(str(path), error.lineno or 0, error.offset or 0, "TTL001", "error", message, hint)
