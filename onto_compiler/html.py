"""The few pieces of HTML that every page needs, and the look that they share; text is escaped here and nowhere else."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from importlib.resources import files

__all__ = ["Html", "badge", "code", "element", "joined", "page", "prose", "table", "text"]


class Html(str):
    """Markup that is already escaped."""

    __slots__ = ()


def text(value: object) -> Html:
    """``value`` as HTML: escaped, unless it is markup already."""
    return value if isinstance(value, Html) else Html(escape(str(value)))


def element(name: str, *children: object, **attributes: str) -> Html:
    """``<name attribute="...">children</name>``; a trailing underscore frees an attribute from Python's keywords."""
    pairs = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{escape(value, quote=True)}"' for key, value in attributes.items()
    )
    return Html(f"<{name}{pairs}>{''.join(text(child) for child in children)}</{name}>")


def code(value: object) -> Html:
    """A name of the ontology or of a scene; a line may break after an underscore, and copying stays clean."""
    return element("code", Html(escape(str(value)).replace("_", "_<wbr>")))


def prose(sentence: str) -> Html:
    """A sentence in which `backticks` mark names."""
    parts = sentence.split("`")
    return joined(code(part) if odd % 2 else part for odd, part in enumerate(parts))


def joined(parts: Iterable[object]) -> Html:
    """``parts`` one after the other."""
    return Html("".join(text(part) for part in parts))


def badge(word: str, tone: str = "") -> Html:
    """A short verdict; ``tone`` is ``good``, ``bad`` or empty. The word says it too: colour alone never does."""
    return element("span", word, class_=f"badge {tone}".strip())


def table(caption: str, columns: Sequence[str], rows: Iterable[Sequence[object]], numeric: Iterable[int] = ()) -> Html:
    """A table in a box that scrolls sideways by itself; the first cell of a row is its heading."""
    right = frozenset(numeric)
    head = element("tr", *(element("th", column, scope="col") for column in columns))
    body = []
    for row in rows:
        cells = [element("th", row[0], scope="row")] if row else []
        cells += [element("td", c, class_="number") if i in right else element("td", c) for i, c in enumerate(row) if i]
        body.append(element("tr", *cells))
    inner = element("table", element("caption", caption), element("thead", head), element("tbody", *body))
    return element("div", inner, class_="scroll", tabindex="0", role="region", aria_label=caption)


def page(title: str, style: str, *body: object) -> str:
    """A whole document without script, font or picture from elsewhere; ``style`` is CSS on top of the shared look."""
    shared = files("onto_compiler").joinpath("html.css").read_text(encoding="utf-8")
    head = [
        Html('<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'),
        element("title", title),
        element("style", Html(shared + style)),
    ]
    return f"<!doctype html>\n{element('html', element('head', *head), element('body', *body), lang='en')}\n"
