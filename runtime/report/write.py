"""Writes episodes as one self-contained HTML file, without scripts or external fonts and pictures."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path

from onto_compiler.html import element, page
from onto_compiler.problems import OntoError
from onto_compiler.schema import Schema
from runtime.loop.records import Episode
from runtime.report.gallery import Pictures, gallery
from runtime.report.sections import answers_section, details_section, episodes_table, header, modes_note, tiles
from runtime.trace.sparql import Answer

__all__ = ["report_html", "write_report"]

_TITLE = "Onto-EV-WM: diagnosis and repair"
_FOOT = (
    "A margin is the signed distance to a predicate's threshold, positive when the predicate holds; the shaded side of"
    " a drawing is the satisfied one, the hollow dot is before, the filled one after. Accepted means that the native"
    " predicate of the benchmark said yes; nothing else decides it."
)


def write_report(
    path: Path | str,
    episodes: Sequence[Episode],
    schema: Schema,
    answers: Sequence[Answer],
    pictures: Sequence[Pictures] = (),
) -> None:
    """Write the report of ``episodes`` to ``path``; ``answers`` are shown with their queries.

    ``pictures`` is empty or holds one pair of JPEGs per episode, before and after.

    Raises:
        OntoError: TRC001 if ``path`` cannot be written.
    """
    target = Path(path)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(report_html(episodes, schema, answers, pictures), encoding="utf-8")
    except OSError as error:
        hint = "name a file that you may write, with space left"
        raise OntoError.of("TRC001", f"cannot write `{path}`: {error}", hint, str(path)) from error


def report_html(
    episodes: Sequence[Episode], schema: Schema, answers: Sequence[Answer], pictures: Sequence[Pictures] = ()
) -> str:
    """The report as text: the same records give the same bytes."""
    style = files("runtime.report").joinpath("style.css").read_text(encoding="utf-8")
    main = [tiles(episodes), element("h2", "Episodes"), modes_note(episodes), episodes_table(episodes, schema)]
    if pictures:
        main += [element("h2", "Before and after"), gallery(episodes, pictures)]
    main += [element("h2", "Chains"), details_section(episodes, schema)]
    if answers:
        main += [element("h2", "Questions to the trace"), answers_section(answers)]
    return page(_TITLE, style, header(_TITLE, episodes), element("main", *main), element("footer", element("p", _FOOT)))
