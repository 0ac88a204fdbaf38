"""A task file as nested lists of words, with their places; the text may be broken."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise

__all__ = ["CONNECTIVES", "QUANTIFIERS", "Group", "Use", "Word", "pairs", "read_tree", "sections", "uses"]

CONNECTIVES = frozenset(("and", "or", "not", "imply"))
QUANTIFIERS = frozenset(("forall", "exists", "forn", "forpairs", "fornpairs"))
_TOKEN = re.compile(r";[^\n\r]*|[()]|[^\s();]+")
_SECTIONS = frozenset((":fixtures", ":goal", ":init", ":language", ":obj_of_interest", ":objects", ":regions"))
_INSTANCES = {":objects": "object", ":fixtures": "fixture"}


@dataclass(frozen=True, slots=True)
class Word:
    """A word; ``key`` is how it is compared."""

    text: str
    start: int

    @property
    def end(self) -> int:
        """The offset behind it."""
        return self.start + len(self.text)

    @property
    def key(self) -> str:
        """The word without regard to case."""
        return self.text.casefold()


@dataclass(slots=True)
class Group:
    """What stands between two parentheses, these included; one without an end reaches to the end of the text."""

    start: int
    end: int
    parts: list[Group | Word] = field(default_factory=list)

    @property
    def head(self) -> str:
        """The first word, or nothing."""
        return self.parts[0].key if self.parts and isinstance(self.parts[0], Word) else ""

    @property
    def words(self) -> list[Word]:
        """The words among the parts."""
        return [part for part in self.parts if isinstance(part, Word)]

    @property
    def groups(self) -> list[Group]:
        """The groups among the parts."""
        return [part for part in self.parts if isinstance(part, Group)]


@dataclass(frozen=True, slots=True)
class Use:
    """A name in a task, from ``start`` up to ``end``.

    ``kind`` is object, fixture, region, variable, category or predicate. The name of a region is ``TARGET_REGION``
    wherever it stands, as in atoms; ``start`` and ``end`` are then those of the part that is the region's own.
    ``scope`` is the offset of the quantifier that binds a variable.
    """

    kind: str
    name: str
    start: int
    end: int
    declares: bool = False
    scope: int = -1


@lru_cache(maxsize=16)
def read_tree(text: str) -> Group:
    """The whole text as one group, around the groups that it holds."""
    root = Group(0, len(text))
    stack = [root]
    for match in _TOKEN.finditer(text):
        read = match[0]
        if read == "(":
            group = Group(match.start(), len(text))
            stack[-1].parts.append(group)
            stack.append(group)
        elif read == ")":
            if len(stack) > 1:
                stack.pop().end = match.end()
        elif read[0] != ";":
            stack[-1].parts.append(Word(read, match.start()))
    return root


def sections(text: str) -> Iterator[Group]:
    """The sections of a task: ``(:objects ...)`` and the like, wherever a lost parenthesis put them."""
    waiting = [read_tree(text)]
    while waiting:
        group = waiting.pop(0)
        if group.head in _SECTIONS:
            yield group
        waiting += group.groups


@lru_cache(maxsize=16)
def uses(text: str) -> tuple[Use, ...]:
    """Every name of a task, in the order in which they are written."""
    return tuple(sorted(_Reader().run(text), key=lambda use: (use.start, use.end)))


@dataclass(slots=True)
class _Reader:
    """``kinds`` are those of the declared instances, ``sites`` the lengths of the targets in the names of regions."""

    kinds: dict[str, str] = field(default_factory=dict)
    sites: dict[str, int] = field(default_factory=dict)

    def run(self, text: str) -> Iterator[Use]:
        found = {group.head: group for group in sections(text)}
        for head, kind in _INSTANCES.items():
            if head in found:
                self.kinds |= {word.key: kind for word, _ in pairs(found[head].words[1:])}
        regions = found[":regions"].groups if ":regions" in found else []
        self.sites |= {f"{target.key}_{name.key}": len(target.text) for name, target in map(_region, regions) if target}
        for head, group in found.items():
            if head in _INSTANCES:
                yield from self.declared(group, _INSTANCES[head])
            elif head == ":regions":
                yield from self.regions(group)
            elif head == ":obj_of_interest":
                yield from self.arguments(group.words[1:], {})
            else:
                for part in group.groups:
                    yield from self.formula(part, {})

    def declared(self, group: Group, kind: str) -> Iterator[Use]:
        words = group.words[1:]
        for word, _ in pairs(words):
            yield Use(kind, word.key, word.start, word.end, declares=True)
        for before, word in pairwise(words):
            if before.text == "-":
                yield Use("category", word.key, word.start, word.end)

    def regions(self, group: Group) -> Iterator[Use]:
        for each in group.groups:
            name, target = _region(each)
            if target is not None:
                yield Use("region", f"{target.key}_{name.key}", name.start, name.end, declares=True)
                yield from self.arguments([target], {})

    def formula(self, group: Group, bound: dict[str, int]) -> Iterator[Use]:
        head = group.head
        if head and head not in CONNECTIVES | QUANTIFIERS:
            if not head.isdigit():  # how many a quantifier asks for
                word = group.words[0]
                yield Use("predicate", word.key, word.start, word.end)
                yield from self.arguments(group.words[1:], bound)
            return
        inner = dict(bound)
        for part in group.groups:
            if head in QUANTIFIERS and part.head.startswith("?"):
                for use in self.variables(part, group.start):
                    if use.kind == "variable":
                        inner[use.name] = group.start
                    yield use
            else:
                yield from self.formula(part, inner)

    def variables(self, group: Group, scope: int) -> Iterator[Use]:
        """What a quantifier binds: ``(?x - category)``."""
        for before, word in zip([None, *group.words], group.words, strict=False):
            if word.text.startswith("?"):
                yield Use("variable", word.key, word.start, word.end, declares=True, scope=scope)
            elif before is not None and before.text == "-":
                yield Use("category", word.key, word.start, word.end)

    def arguments(self, words: list[Word], bound: dict[str, int]) -> Iterator[Use]:
        for word in words:
            if word.key in bound:
                yield Use("variable", word.key, word.start, word.end, scope=bound[word.key])
            elif word.key in self.sites:
                length = self.sites[word.key]
                target = word.text[:length].casefold()
                if target in self.kinds:
                    yield Use(self.kinds[target], target, word.start, word.start + length)
                yield Use("region", word.key, word.start + length + 1, word.end)
            elif word.key in self.kinds:
                yield Use(self.kinds[word.key], word.key, word.start, word.end)


def pairs(words: list[Word]) -> Iterator[tuple[Word, str]]:
    """Each name of ``a b - category`` with its category."""
    waiting: list[Word] = []
    category = False
    for word in words:
        if category:
            yield from ((one, word.key) for one in waiting)
            waiting, category = [], False
        elif word.text == "-":
            category = True
        else:
            waiting.append(word)


def _region(group: Group) -> tuple[Word, Word | None]:
    """The name of a region and its target, where it has one."""
    name = group.words[0] if group.words else Word("", group.start)
    targets = (part for part in group.groups if part.head == ":target" and len(part.words) > 1)
    return name, next((part.words[1] for part in targets), None)
