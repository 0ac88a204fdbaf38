"""What the camera saw of each episode, before the first attempt and at the end."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from html import escape

from onto_compiler.html import Html, element, joined
from runtime.loop.records import Episode
from runtime.report.sections import episode_name

__all__ = ["Pictures", "gallery"]

Pictures = tuple[bytes, bytes]  # JPEGs, before and after


def gallery(episodes: Sequence[Episode], pictures: Sequence[Pictures]) -> Html:
    """One figure per episode: two pictures side by side over its name."""
    figures = [_figure(episode, pair) for episode, pair in zip(episodes, pictures, strict=True)]
    return element("div", joined(figures), class_="gallery")


def _figure(episode: Episode, pair: Pictures) -> Html:
    name = episode_name(episode)
    shots = [_picture(data, f"{name}: {when}") for data, when in zip(pair, ("before", "after"), strict=True)]
    return element("figure", element("div", *shots), element("figcaption", name))


def _picture(data: bytes, description: str) -> Html:
    source = f"data:image/jpeg;base64,{b64encode(data).decode('ascii')}"
    return Html(f'<img src="{source}" alt="{escape(description, quote=True)}"/>')
