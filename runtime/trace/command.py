"""``onto trace``: query, list, show, explain and export recorded episodes."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from onto_compiler.command import Command, add_ontology

if TYPE_CHECKING:
    from runtime.trace.store import Trace

__all__ = ["TRACE"]

_WHERE = "a trace file or the folder of a store; left out: the newest below out/"
_EXAMPLE = """\
onto trace query --named repairs
onto trace query my_question.rq out/demo/trace.trig --format csv
onto trace list
onto trace show put_the_bowl_on_the_plate
onto trace explain put_the_bowl_on_the_plate
onto trace export --format nquads > trace.nq"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the five subcommands; every one can name the trace and the user's own ontology."""
    actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
    query = actions.add_parser("query", help="ask a trace with SPARQL", description=_query.__doc__)
    query.add_argument("words", nargs="*", metavar="FILE.rq [TRACE]", help=f"the query, then {_WHERE}")
    query.add_argument("--named", metavar="NAME", help="a competency query that ships with the ontology")
    query.add_argument("--list", action="store_true", help="list the named queries and their questions")
    _add_format(query, "table", "json", "csv")
    listing = actions.add_parser("list", help="list the recorded episodes", description=_list.__doc__)
    listing.add_argument("trace", nargs="?", metavar="TRACE", help=_WHERE)
    _add_format(listing, "table", "json", "csv")
    show = actions.add_parser("show", help="print one episode in sentences", description=_show.__doc__)
    show.add_argument("episode", metavar="EPISODE", help="a number of `onto trace list`, a task name or a part of one")
    show.add_argument("trace", nargs="?", metavar="TRACE", help=_WHERE)
    _add_format(show, "text", "json")
    explain = actions.add_parser("explain", help="print the reasons of each decision", description=_explain.__doc__)
    explain.add_argument("episode", metavar="EPISODE", help="as of `onto trace show`")
    explain.add_argument("trace", nargs="?", metavar="TRACE", help=_WHERE)
    _add_format(explain, "text", "json")
    export = actions.add_parser("export", help="write a trace in another RDF format", description=_export.__doc__)
    export.add_argument("trace", nargs="?", metavar="TRACE", help=_WHERE)
    export.add_argument("--format", choices=("trig", "nquads", "jsonld"), default="trig", help="what to write")
    export.add_argument("--output", metavar="FILE", help="where to write it; left out: standard output")
    for action in (query, listing, show, explain, export):
        add_ontology(action)


def _add_format(parser: argparse.ArgumentParser, *choices: str) -> None:
    parser.add_argument("--format", choices=choices, default=choices[0], help="what to print on standard output")
    parser.add_argument("--json", dest="format", action="store_const", const="json", help="short for --format json")


def run(options: argparse.Namespace) -> int:
    """Carry out the chosen subcommand."""
    actions = {"query": _query, "list": _list, "show": _show, "explain": _explain, "export": _export}
    action = actions[options.action]
    return action(options)


def _open(given: str | None, ontology: list[str]) -> Trace:
    from runtime.trace.store import newest_trace, open_trace  # noqa: PLC0415 - keeps `onto --help` quick

    return open_trace(given or newest_trace(), ontology=ontology)


def _query(options: argparse.Namespace) -> int:
    """Query a trace with SPARQL over all graphs together; the project's prefixes need no declaration."""
    from runtime.trace.output import query  # noqa: PLC0415 - keeps `onto --help` quick

    return query(options, lambda given: _open(given, options.ontology))


def _list(options: argparse.Namespace) -> int:
    """List the recorded episodes with their outcomes, numbered for `onto trace show`."""
    from runtime.trace.output import listing  # noqa: PLC0415 - keeps `onto --help` quick

    return listing(_open(options.trace, options.ontology), options.format)


def _show(options: argparse.Namespace) -> int:
    """Print one episode in sentences: fact, diagnosis, route, application, verification."""
    from runtime.trace.output import show  # noqa: PLC0415 - keeps `onto --help` quick

    return show(_open(options.trace, options.ontology), options.episode, options.format, options.ontology)


def _explain(options: argparse.Namespace) -> int:
    """Print one episode with reasons: each rule with its location, and the other eligible routes."""
    from runtime.trace.output import explain  # noqa: PLC0415 - keeps `onto --help` quick

    return explain(_open(options.trace, options.ontology), options.episode, options.format, options.ontology)


def _export(options: argparse.Namespace) -> int:
    """Write a trace as TriG, N-Quads or JSON-LD, sorted: equal traces give equal bytes."""
    from runtime.trace.output import export  # noqa: PLC0415 - keeps `onto --help` quick

    return export(_open(options.trace, options.ontology), options.format, options.output)


TRACE = Command(
    name="trace",
    help="Ask recorded episodes what failed, on which arguments, by how much, and what repaired it.",
    example=_EXAMPLE,
    configure=configure,
    run=run,
)
