"""The sections of a report, each from records alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from onto_compiler.html import Html, badge, code, element, joined, prose, table, text
from onto_compiler.schema import Schema
from onto_compiler.wording import counted
from runtime.loop.diagnosis import satisfied, unmet
from runtime.loop.records import Diagnosis, Episode, state_name
from runtime.report.bars import margin_bar
from runtime.trace.narrate import chain, outcome_sentence, premise_sentence
from runtime.trace.sparql import Answer, plain, words
from runtime.trace.summary import first_diagnoses, margin_after, routes_of, verdict
from runtime.wording import amount, atom, short_name, unit_of

__all__ = ["answers_section", "details_section", "episode_name", "episodes_table", "header", "modes_note", "tiles"]

SHOWN_WAYS = 3  # how many alternatives of a goal are written out

_GOOD = frozenset(("accepted", "verified"))
_OPEN = frozenset(("unresolved", "retained"))
_MODES = {
    "state": "`state` (the simulator's state was written, so this is no robot's execution)",
    "controller": "`controller` (actions were executed under dynamics)",
    "none": "`none` (a plan was only retained)",
}


def header(title: str, episodes: Sequence[Episode]) -> Html:
    """The title, what was run, and the versions that every episode shares."""
    shared = set.intersection(*({(k, str(v)) for k, v in e.provenance} for e in episodes)) if episodes else set()
    order = dict.fromkeys(key for episode in episodes for key, _ in episode.provenance)
    versions = [(key, value) for key in order for k, value in sorted(shared) if k == key]
    suites = ", ".join(sorted({episode.suite for episode in episodes})) or "no suite"
    seeds = ", ".join(map(str, sorted({episode.seed for episode in episodes})))
    facts = [("suite", suites), ("seed", seeds), *versions]
    items = [element("li", f"{key} ", element("b", value)) for key, value in facts if value]
    lead = "What each task lacked, which declared route repaired it, and what the native predicate said."
    return element(
        "header",
        element("h1", title),
        element("p", lead, class_="quiet"),
        element("ul", *items, class_="versions"),
    )


def tiles(episodes: Sequence[Episode]) -> Html:
    """The numbers that summarise a run."""
    count = len(episodes)
    accepted = [episode for episode in episodes if episode.accepted]
    asked = [e for e in accepted if e.verification is not None and e.verification.settled is not None]
    settled = sum(e.verification.settled is True for e in asked if e.verification is not None)
    disagreements = sum(episode.outcome == "grounding_verifier_disagreement" for episode in episodes)
    values = [
        ("accepted", _ratio(len(accepted), count)),
        ("still true after settling", _ratio(settled, len(asked))),
        ("facts diagnosed", text(sum(len(first_diagnoses(episode)) for episode in episodes))),
        ("attempts", text(sum(len(episode.attempts) for episode in episodes))),
        ("premises that hold", _ratio(sum(e.premise_holds for e in episodes), count)),
        ("grounding and verifier disagree", text(disagreements)),
    ]
    items = [element("div", element("dt", name), element("dd", value)) for name, value in values]
    return element("dl", *items, class_="tiles")


def _ratio(part: int, whole: int) -> Html:
    return Html(f"{part} <small>of {whole}</small>")


def modes_note(episodes: Sequence[Episode]) -> Html:
    """The modes of application that the numbers refer to."""
    used = {a.application.mode for e in episodes for a in e.attempts if a.application is not None}
    sources = {o.source for e in episodes for o in (e.initial, *(a.observation for a in e.attempts))}
    seen = {"sim": "privileged simulator state", "pred": "predictions"}
    modes = [_MODES[mode] for mode in sorted(used)] or ["none, as nothing was applied"]
    sees = " and ".join(seen[source] for source in sorted(sources)) or "nothing"
    sentence = f"Mode of application: {', '.join(modes)}. Facts were grounded from {sees}."
    return element("p", prose(sentence), class_="quiet")


def episodes_table(episodes: Sequence[Episode], schema: Schema) -> Html:
    """One row per unmet fact; an episode without one has a row that says so."""
    columns = ("task", "unmet fact", "margin", "failure", "route", "attempts", "verdict", "settled")
    rows = [row for number, episode in enumerate(episodes, 1) for row in _rows(number, episode, schema)]
    return table("Every episode and the facts that were unmet when it started", columns, rows, numeric={5})


def _rows(number: int, episode: Episode, schema: Schema) -> Iterator[tuple[object, ...]]:
    name = element("a", episode_name(episode), href=f"#episode-{number}")
    end = (len(episode.attempts), _verdict(episode), _settled(episode))
    found = first_diagnoses(episode)
    if not found:
        yield (name, "none", "", "", "", *end)
    for diagnosis in found:
        routes = dict.fromkeys(routes_of(episode, diagnosis.index))
        yield (
            name,
            code(atom(diagnosis.fact, schema)),
            element("span", amount(diagnosis.margin, unit_of(diagnosis.fact, schema)), class_="margin"),
            code(short_name(diagnosis.failure, schema)),
            joined(element("p", code(short_name(route, schema))) for route in routes) if routes else "not tried",
            *end,
        )


def episode_name(episode: Episode) -> str:
    """A task's name in words, and its initial state."""
    return f"{episode.task.replace('_', ' ')}, {state_name(episode.state_index)}"


def _verdict(episode: Episode) -> Html:
    tone = "good" if episode.outcome in _GOOD else "" if episode.outcome in _OPEN else "bad"
    return badge(verdict(episode), tone)


def _settled(episode: Episode) -> Html:
    settled = None if episode.verification is None else episode.verification.settled
    if settled is None:
        return text("not asked")
    return badge("yes", "good") if settled else badge("no", "bad")


def details_section(episodes: Sequence[Episode], schema: Schema) -> Html:
    """Every episode's chain, collapsed by default."""
    return joined(_details(number, episode, schema) for number, episode in enumerate(episodes, 1))


def _details(number: int, episode: Episode, schema: Schema) -> Html:
    figures = [_figure(diagnosis, episode, schema) for diagnosis in first_diagnoses(episode)]
    facts, ways = episode.required.facts, episode.required.ways
    required = " or ".join(", ".join(atom(facts[i], schema) for i in way) for way in ways[:SHOWN_WAYS])
    required += f" or {len(ways) - SHOWN_WAYS} more" if len(ways) > SHOWN_WAYS else ""
    parts: list[object] = [
        element("p", "Instruction: ", episode.required.language, class_="quiet") if episode.required.language else "",
        element("p", "Required: ", code(required)),
    ]
    premise = premise_sentence(episode, schema)
    parts.append(element("p", premise) if premise else "")
    parts.append(element("div", *figures, class_="bars") if figures else "")
    turns = [
        element("li", element("h3", f"Attempt {attempt.index + 1}"), *map(_step, chain(attempt, schema)))
        for attempt in episode.attempts
    ]
    parts.append(element("ol", *turns, class_="chain") if turns else "")
    parts.append(element("p", element("b", "Outcome: "), outcome_sentence(episode)))
    parts += [element("p", _end(episode, schema))]
    head = element("summary", episode_name(episode), _verdict(episode))
    return element("details", head, element("div", *parts), id=f"episode-{number}")


def _step(sentence: str) -> Html:
    kind, _, rest = sentence.partition(": ")
    return element("p", element("b", kind), element("span", prose(rest)), class_="step")


def _end(episode: Episode, schema: Schema) -> str:
    still = [atom(episode.required.facts[i], schema) for i in unmet(episode.required, episode.final)]
    return (
        f"At the end, still unmet: {', '.join(still)}."
        if still
        else "At the end, every required fact is grounded as satisfied."
    )


def _figure(diagnosis: Diagnosis, episode: Episode, schema: Schema) -> Html:
    fact, unit = diagnosis.fact, unit_of(diagnosis.fact, schema)
    before, after = diagnosis.margin, margin_after(episode, diagnosis.index)
    met = bool(satisfied(episode.required.facts, episode.final)[diagnosis.index])
    bar = margin_bar(before, after, fact.threshold, unit, polarity=fact.polarity, met=met)
    margins = f"{amount(before, unit)} before, {amount(after, unit)} after"
    caption = element("figcaption", code(atom(fact, schema)), element("span", margins))
    return element("figure", caption, bar)


def answers_section(answers: Sequence[Answer]) -> Html:
    """SPARQL results on the trace, each with its query."""
    blocks = []
    for answer in answers:
        title = answer.question or answer.name or "A query"
        columns = list(zip(*answer.rows, strict=True))
        numeric = [i for i, cells in enumerate(columns) if all(type(plain(c)) in {int, float} for c in cells if c)]
        caption = counted(len(answer.rows), "row")
        if answer.name:
            caption += f" of {answer.name}"
        rows = [tuple(map(words, row)) for row in answer.rows]
        query = element("details", element("summary", "The query"), element("div", element("pre", answer.query)))
        blocks += [element("h3", title), table(caption, answer.columns, rows, numeric), query]
    return joined(blocks)
