"""What is generated from an ontology for other programs: one module per output, from the loaded TBox to text."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:  # `onto --help` reads this module, and stays without Oxigraph
    from onto_compiler.emit.tbox import TBox

__all__ = ["OUTPUTS", "emit"]

OUTPUTS = ("shacl", "jsonschema", "jsonld", "python", "mermaid", "dense", "record_shapes")


def emit(output: str, tbox: TBox) -> str:
    """The text of one of :data:`OUTPUTS`; the same TBox always gives the same text.

    Raises:
        OntoError: RUN002, from ``dense``, where two rules conclude different things of one combination.
    """
    module = import_module(f"onto_compiler.emit.{output}")
    return cast("Callable[[TBox], str]", module.emit)(tbox)
