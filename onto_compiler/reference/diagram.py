"""Which kind of predicate fails how and where the failure is sent, as an SVG without a script."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape

from onto_compiler.html import Html, element
from onto_compiler.reference.layers import layers, ordered
from onto_compiler.reference.model import Reference
from onto_compiler.schema import local_name
from onto_compiler.tables import FIRST, RouteEntry, RouteKey

__all__ = ["route_diagram", "route_edges"]

_BOX, _HIGH, _GAP, _BETWEEN, _EDGE = 184, 34, 16, 72, 8  # px
_HEADS = ("kind of predicate", "failure", "first route", "after a rejection")
_ROW = 26  # px of the headings


def route_edges(reference: Reference) -> dict[tuple[str, str], str]:
    """``(from, to)`` and a sentence on it: kind to failure, failure to first route, route to its successor."""
    schema, edges = reference.schema, {}
    for (predicate, _, _), found in sorted(reference.tables.diagnosis.items()):
        kind = schema.predicates[predicate].kind
        edges[kind, found.failure] = f"{local_name(kind)} can fail as {local_name(found.failure)}"
    for (_, failure, status, _, _), chosen in sorted(reference.tables.routing.items(), key=_case):
        if status == FIRST:
            edges[failure, chosen.route] = f"{local_name(failure)} is first sent to {local_name(chosen.route)}"
    for iri, route in sorted(schema.routes.items()):
        if route.on_rejection is not None:
            edges[iri, route.on_rejection] = (
                f"{route.name}, once rejected, gives way to {local_name(route.on_rejection)}"
            )
    return edges


def _case(item: tuple[RouteKey, RouteEntry]) -> tuple[str, ...]:
    (predicate, failure, status, _, level), _ = item
    return predicate, failure, status, level


def route_diagram(reference: Reference) -> Html:
    """The drawing; each box leads to the entry of its term, and the tables beside it say the same in words."""
    edges = route_edges(reference)
    nodes = sorted({name for edge in edges for name in edge} | set(reference.schema.routes))
    if not nodes:
        return Html("")
    depth = _columns(reference, nodes, tuple(edges))
    columns = ordered([[n for n in nodes if depth[n] == i] for i in range(max(depth.values()) + 1)], tuple(edges))
    tall = max(len(column) for column in columns)
    height = _ROW + tall * (_HIGH + _GAP) + _EDGE
    width = 2 * _EDGE + len(columns) * _BOX + (len(columns) - 1) * _BETWEEN
    at: dict[str, tuple[float, float]] = {}
    for index, column in enumerate(columns):
        slack = (tall - len(column)) * (_HIGH + _GAP) / 2
        for rank, name in enumerate(column):
            at[name] = (_EDGE + index * (_BOX + _BETWEEN), _ROW + slack + rank * (_HIGH + _GAP) + _GAP / 2)
    parts = [_head(index, text) for index, text in enumerate(_HEADS[: len(columns)])]
    parts += [_line(at[start], at[end], label) for (start, end), label in edges.items()]
    parts += [_box(reference, name, at[name], depth[name]) for name in nodes]
    label = f"{len(nodes)} terms and {len(edges)} arrows; the tables below say the same"
    drawing = element(
        "svg",
        Html("".join(parts)),
        viewBox=f"0 0 {width} {height}",
        width=str(width),
        height=str(height),
        role="group",
        aria_label=f"From kinds of predicate through failures to routes: {label}",
    )
    return element(
        "div",
        drawing,
        class_="scroll drawing",
        tabindex="0",
        role="region",
        aria_label="Failure and route diagram",
    )


def _columns(reference: Reference, nodes: Sequence[str], edges: Sequence[tuple[str, str]]) -> Mapping[str, int]:
    """The layers, with routes never left of the third column, where a route that nothing reaches would else stand."""
    depth = layers(nodes, edges)
    return {name: max(depth[name], 2) if name in reference.schema.routes else depth[name] for name in nodes}


def _head(index: int, text: str) -> str:
    x = _EDGE + index * (_BOX + _BETWEEN) + _BOX / 2
    return f'<text class="column" x="{x:g}" y="14" text-anchor="middle">{escape(text)}</text>'


def _line(start: tuple[float, float], end: tuple[float, float], label: str) -> str:
    x, y = start[0] + _BOX, start[1] + _HIGH / 2
    to_x, to_y = end[0], end[1] + _HIGH / 2
    bend = max((to_x - x) / 2, _BETWEEN / 2)
    path = f"M{x:g} {y:g}C{x + bend:g} {y:g} {to_x - bend:g} {to_y:g} {to_x - 5:g} {to_y:g}"
    head = f"M{to_x:g} {to_y:g}l-8 -4v8z"
    return f'<g class="edge"><title>{escape(label)}</title><path d="{path}"/><path class="tip" d="{head}"/></g>'


def _box(reference: Reference, name: str, at: tuple[float, float], column: int) -> str:
    x, y = at
    tone = ("kind", "failure")[column] if column < 2 else "route"
    shown = escape(local_name(name))
    squeeze = f' textLength="{_BOX - 16}" lengthAdjust="spacingAndGlyphs"' if len(shown) > 23 else ""
    box = (
        f'<rect class="{tone}" x="{x:g}" y="{y:g}" width="{_BOX}" height="{_HIGH}" rx="6"/>'
        f'<text x="{x + _BOX / 2:g}" y="{y + _HIGH / 2 + 4:g}" text-anchor="middle"{squeeze}>{shown}</text>'
    )
    definition = f"<title>{escape(reference.definition(name))}</title>"
    anchor = reference.anchors.get(name)
    return f'<a href="#{anchor}">{definition}{box}</a>' if anchor else f"<g>{definition}{box}</g>"
