"""A played episode as a strip of pictures: for each attempt the scene before it, grasp, release, and after it."""

from __future__ import annotations

import io
from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from importlib.resources import files
from itertools import groupby, pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from onto_compiler.html import Html, element, page, prose
from onto_compiler.problems import OntoError
from onto_compiler.schema import Schema
from runtime.loop.records import Episode
from runtime.report.sections import episode_name
from runtime.trace.narrate import chain, outcome_sentence

__all__ = ["Frame", "Shot", "film_html", "film_picture", "shots", "write_film"]

Array = NDArray[np.float64]

CLOSING = 10  # control steps from the first command to close until the fingers hold
_BAR, _TEXT = 24, 14  # pixels: the strip's captions, and their letters
_PICTURES: Mapping[str, tuple[str, dict[str, int]]] = {
    ".jpg": ("JPEG", {"quality": 82}),
    ".png": ("PNG", {"optimize": 1}),
}
_INK, _PAPER = (25, 25, 25), (250, 250, 248)


@dataclass(frozen=True, slots=True)
class Shot:
    """A picture of an attempt to take: ``step`` is an index into the states of the episode."""

    attempt: int
    name: str
    step: int


@dataclass(frozen=True, slots=True)
class Frame:
    """A shot and its JPEG."""

    shot: Shot
    picture: bytes


def shots(actions: Array, bounds: Sequence[int]) -> tuple[Shot, ...]:
    """The shots of ``actions`` (n, 7), of which attempt k took those from ``bounds[k]`` to ``bounds[k + 1]``.

    The grasp is the first closing of the gripper in the attempt, some steps later, when the fingers hold; the release
    is the last state before it opens again. An attempt that never closes it is shown at half its way,
    and an episode without attempts where it starts.
    """
    found = []
    for attempt, (first, last) in enumerate(pairwise(bounds)):
        if first == last:
            found.append(Shot(attempt, "as it stood", first))
            continue
        closed = np.flatnonzero(actions[first:last, 6] > 0.0) + first
        between = [("on the way", (first + last) // 2)]
        if len(closed):
            between = [("grasp", min(int(closed[0]) + CLOSING, int(closed[-1]))), ("release", int(closed[-1]) + 1)]
        for name, step in (("before", first), *between, ("after", last)):
            found.append(Shot(attempt, name, step))
    return tuple(found) or (Shot(0, "start", bounds[0]),)


def film_html(episode: Episode, schema: Schema, frames: Sequence[Frame]) -> str:
    """The strip as one self-contained page: a row of pictures for each attempt over its story."""
    style = files("runtime.report").joinpath("style.css").read_text(encoding="utf-8")
    title = episode_name(episode)
    instruction = element("p", episode.required.language, class_="quiet") if episode.required.language else Html("")
    rows: list[object] = []
    if not episode.attempts:
        rows.append(element("div", *map(_figure, frames), class_="strip"))
    for attempt in episode.attempts:
        shown = [_figure(frame) for frame in frames if frame.shot.attempt == attempt.index]
        sentences = [element("p", prose(sentence)) for sentence in chain(attempt, schema)]
        rows.append(element("h2", f"Attempt {attempt.index + 1}"))
        rows += [element("div", *shown, class_="strip"), *sentences]
    rows.append(element("p", element("b", "Outcome: "), outcome_sentence(episode)))
    return page(title, style, element("header", element("h1", title), instruction), element("main", *rows))


def _figure(frame: Frame) -> Html:
    source = f"data:image/jpeg;base64,{b64encode(frame.picture).decode('ascii')}"
    caption = _caption(frame.shot)
    image = Html(f'<img src="{source}" alt="{escape(f"attempt {frame.shot.attempt + 1}, {caption}", quote=True)}"/>')
    return element("figure", image, element("figcaption", caption))


def _shot_caption(episode: Episode, shot: Shot) -> str:
    if not episode.attempts:
        return _caption(shot)
    text = f"attempt {shot.attempt + 1}, {_caption(shot)}"
    if shot.name != "after":
        return text
    verdict = episode.attempts[shot.attempt].verification
    return f"{text}: {'broken off' if verdict is None else 'accepted' if verdict.outcome else 'rejected'}"


def _caption(shot: Shot) -> str:
    return f"{shot.name}, step {shot.step}"


def film_picture(episode: Episode, frames: Sequence[Frame], suffix: str) -> bytes:
    """The strip, of at least one frame, as a ``.png`` or ``.jpg``: a row for each attempt with its verdict below."""
    from PIL import Image, ImageDraw, ImageFont  # noqa: PLC0415 - comes with the simulator

    rows = [tuple(row) for _, row in groupby(frames, lambda frame: frame.shot.attempt)]
    width, height = Image.open(io.BytesIO(frames[0].picture)).size
    sheet = Image.new("RGB", (width * max(map(len, rows)), (height + _BAR) * len(rows)), _PAPER)
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(_TEXT)
    for number, row in enumerate(rows):
        for column, frame in enumerate(row):
            left, top = column * width, number * (height + _BAR)
            sheet.paste(Image.open(io.BytesIO(frame.picture)), (left, top))
            draw.text((left + 6, top + height + 4), _shot_caption(episode, frame.shot), fill=_INK, font=font)
    buffer = io.BytesIO()
    kind, how = _PICTURES[suffix]
    sheet.save(buffer, kind, **how)
    return buffer.getvalue()


def write_film(
    path: Path, episode: Episode, schema: Schema, shown: Sequence[Shot], shoot: Callable[[int], bytes]
) -> None:
    """Draw ``shown`` with ``shoot``, which gives a JPEG of the state at a step, into an HTML page or a picture.

    Raises:
        OntoError: TRC001 if ``path`` cannot be written.
    """
    frames = [Frame(shot, shoot(shot.step)) for shot in shown]
    suffix = path.suffix.lower()
    drawn = suffix in _PICTURES
    content = film_picture(episode, frames, suffix) if drawn else film_html(episode, schema, frames).encode("utf-8")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    except OSError as error:
        hint = "name a file that you may write, with space left"
        raise OntoError.of("TRC001", f"cannot write `{path}`: {error}", hint, str(path)) from error
