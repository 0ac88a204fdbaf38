"""Shapes and data in one store, as ``onto check`` and the traces hold them, validated by :mod:`onto_compiler.shacl`.

Source: SHACL (W3C, 2017). All graphs of the store count together, for the shapes as for the data.
"""

from __future__ import annotations

from pyoxigraph import Store

from onto_compiler.placed import placed
from onto_compiler.shacl.compile import compile_graph
from onto_compiler.shacl.graph import Graph
from onto_compiler.shacl.model import ShapeFault, ShapeResult, Shapes
from onto_compiler.shacl.validate import validate_graph

__all__ = ["ShapeFault", "ShapeResult", "Shapes", "compile_shapes", "validate"]


def compile_shapes(store: Store, faults: list[ShapeFault] | None = None) -> Shapes:
    """Every shape of ``store`` that has a target. Shapes that cannot run are left out and appended to ``faults``.

    Raises:
        OntoError: the first of them, where no list is given.

    """
    try:
        return compile_graph(Graph.of_store(store), faults)
    except ShapeFault as fault:
        raise placed(store, fault) from fault


def validate(store: Store, shapes: Shapes, faults: list[ShapeFault] | None = None) -> tuple[ShapeResult, ...]:
    """Validate all graphs of ``store`` together; each result is there once. As for ``faults``, see above.

    Raises:
        ShapeFault: the query of a shape cannot run, and no list is given.

    """
    return tuple(dict.fromkeys(validate_graph(Graph.of_store(store), shapes, faults)))
