"""Played trials as one page: plans over the maze by row, margins along each trial, and reliability of the scores."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from importlib.resources import files
from pathlib import Path

import numpy as np

from onto_compiler.html import Html, code, element, page
from onto_compiler.problems import OntoError
from onto_compiler.schema import Schema
from runtime.report.horizon import margin_chart
from runtime.report.reliability import reliability, reliability_diagram
from runtime.wording import atom, unit_of
from runtime.worlds.pointmaze.drawing import Way, maze_drawing
from runtime.worlds.pointmaze.grounded import MazeFacts
from runtime.worlds.pointmaze.maze import MACRO_STEPS
from runtime.worlds.pointmaze.planning.mpc import TrialResult

__all__ = ["plans_html", "write_plans"]

_DRAWN = 8
"""Trials that are drawn; all of them count for the reliability."""
_TITLE = "Plans in PointMaze"
_LEAD = (
    "Solid: the way that the ball took, and the simulator's margin. Dashed: what the members of the world model"
    " imagined, and the margin that was predicted. Shaded: the target's radius, and the satisfied side of"
    " a margin. Arrows are velocities."
)
Rows = Mapping[str, Sequence[TrialResult]]


def write_plans(path: Path, rows: Rows, facts: MazeFacts, schema: Schema) -> None:
    """Write :func:`plans_html` to ``path``; raises ``TRC001`` if it cannot be written."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(plans_html(rows, facts, schema), encoding="utf-8")
    except OSError as error:
        hint = "name a file that you may write, with space left"
        raise OntoError.of("TRC001", f"cannot write `{path}`: {error.strerror}", hint, str(path)) from error


def plans_html(rows: Rows, facts: MazeFacts, schema: Schema) -> str:
    """The page as text; every row has played the same trials."""
    style = files("runtime.report").joinpath("plans.css").read_text(encoding="utf-8")
    main: list[object] = []
    for number, several in enumerate(zip(*rows.values(), strict=True)):
        if number == _DRAWN:
            break
        main.append(element("h2", f"Trial {several[0].trial.number}"))
        drawn = [_plans(name, played, facts) for name, played in zip(rows, several, strict=True)]
        main.append(element("div", *drawn, class_="panels"))
        for name, played in zip(rows, several, strict=True):
            charts = list(_margins(played, facts, schema))
            if charts:
                main += [element("h3", f"Margins: {name}"), element("div", *charts, class_="panels")]
    for name, some in rows.items():
        diagrams = list(_reliability(some, facts, schema))
        if diagrams:
            main += [element("h2", f"Reliability: {name}"), element("div", *diagrams, class_="panels")]
    head = element("header", element("h1", _TITLE), element("p", _LEAD, class_="quiet"))
    return page(_TITLE, style, head, element("main", *main))


def _plans(name: str, played: TrialResult, facts: MazeFacts) -> Html:
    nobody = np.empty((0, 1, 4))
    ways = [Way(s.states, nobody if s.made.foreseen is None else s.made.foreseen.paths) for s in played.steps]
    last = played.steps[-1].verdict
    caption = f"{'reached' if played.success else 'not reached'} after {len(ways)} plan{'s' * (len(ways) != 1)}"
    caption += f", {float(last.position):.2f} m and {float(last.velocity):.2f} m/s off"
    drawing = maze_drawing(facts.maze, played.trial.start, played.trial.goal, ways, f"{name}: {caption}")
    return element("figure", element("figcaption", element("b", name), f": {caption}"), drawing)


def _margins(played: TrialResult, facts: MazeFacts, schema: Schema) -> Iterator[Html]:
    """A chart for each required fact that was predicted."""
    if all(step.made.foreseen is None for step in played.steps):
        return
    states = np.concatenate([step.states[bool(number) :] for number, step in enumerate(played.steps)])
    true = facts.label(states, played.trial.goal).margin
    predicted, begun = [], 0
    for step in played.steps:
        if step.made.foreseen is not None:
            margins = step.made.foreseen.margin
            predicted.append((begun + MACRO_STEPS * np.arange(1, len(margins) + 1), margins))
        begun += len(step.made.actions)
    for index, fact in enumerate(facts.required.facts):
        along = [(steps, margins[:, index]) for steps, margins in predicted if np.isfinite(margins[:, index]).all()]
        unit, name = unit_of(fact, schema), atom(fact, schema)
        errors = [np.abs(margins - true[steps, index]) for steps, margins in along]
        caption = f"{np.concatenate(errors).mean():.2f} {unit} off on average" if errors else "not observed"
        chart = margin_chart(true[:, index], along, unit, f"{name}, predicted margins: {caption}", fact.threshold)
        yield element("figure", element("figcaption", code(name), f": {caption}"), chart)


def _reliability(played: Sequence[TrialResult], facts: MazeFacts, schema: Schema) -> Iterator[Html]:
    """A diagram for each required fact, over the ends of all macro steps that were imagined and then executed."""
    score, held = [], []
    for each in played:
        for step in each.steps:
            if step.made.foreseen is not None:
                score.append(step.made.foreseen.score)
                ends = step.states[MACRO_STEPS::MACRO_STEPS]
                held.append(facts.label(ends, each.trial.goal).truth)
    if not score:
        return
    scores, truths = np.concatenate(score), np.concatenate(held)
    for index, fact in enumerate(facts.required.facts):
        if np.isnan(scores[:, index]).all():
            continue
        found = reliability(scores[:, index], truths[:, index])
        name = atom(fact, schema)
        caption = f"calibration error {found.error:.3f} over {len(scores)} predictions"
        diagram = reliability_diagram(found, f"{name}: {caption}")
        yield element("figure", element("figcaption", code(name), f": {caption}"), diagram)
