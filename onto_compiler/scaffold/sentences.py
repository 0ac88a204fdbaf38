"""English sentences about terms of which nothing is known but the name, for one argument and for two."""

from __future__ import annotations

from onto_compiler.scaffold.names import WordedName

__all__ = ["holds_when"]

_PREPOSITIONS = frozenset(
    (
        *("above", "across", "against", "along", "around", "at", "before", "behind", "below", "beneath", "beside"),
        *("between", "beyond", "by", "for", "from", "in", "inside", "into", "near", "next", "of", "off", "on", "onto"),
        *("outside", "over", "past", "than", "through", "to", "toward", "towards", "under", "upon", "with", "within"),
    )
)
_VERBS = frozenset(("is", "has", "does"))


def holds_when(name: WordedName, arity: int) -> str:
    """A predicate's definition; a name that is no part of a sentence is quoted in one."""
    first, last = name.words[0], name.words[-1]
    verb = first in _VERBS or (first.endswith("s") and not first.endswith(("ss", "us", "is")) and len(first) > 3)
    participle = last.endswith(("ed", "ing")) and len(last) > 4
    if arity == 1 and last not in _PREPOSITIONS and (verb or participle):
        return f"Holds when the argument {'' if verb else 'is '}{name.text}."
    if arity > 1 and (last in _PREPOSITIONS or last.endswith("ing") or (verb and len(name.words) == 1)):
        return f"Holds when the first argument {'' if verb else 'is '}{name.text} the second."
    arguments = "the argument" if arity == 1 else "the first argument and the second"
    return f"Holds when `{name.text}` is true of {arguments}."
