"""From a number to a damaged file: a seed drawn by the number, then one to four mutations, then its bytes.

Most mutations move whole tokens, brackets and statements, so that what comes out reads like the work of a tired person
and reaches the parser; some are of the encoding, and a few are of a size that no person writes.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise

from benchmarks.fuzz_seeds import BDDL, TURTLE, parts, seeds
from onto_compiler.turtle.tokens import tokens

__all__ = ["ENCODINGS", "MUTATIONS", "FuzzInput", "fuzz_input", "past_the_lexer"]

Mutation = Callable[[random.Random, list[str], str], list[str]]

_NAME = re.compile(r"[\w:.@<>/#?-]*\w[\w:.@<>/#?-]*")
_NUMBER = re.compile(r"[+-]?\d*\.?\d+(?:[eE][+-]?\d+)?")
_NUMBERS = (
    "0",
    "-0",
    "1e400",
    "-1e-400",
    "00012",
    "1.",
    ".5",
    "1e",
    "NaN",
    "INF",
    "9" * 400,
    "9" * 5000,
    "\u0663",
    "1_000",
)
_BRACKETS = ("(", ")", "[", "]", "()", "[]", "((", "))", "{", "}", "<", ">", '"', '"""', "'")
_UNICODE = (
    *map(chr, (0, 0xA0, 0x2028, 0x200B, 0x202E, 0x301, 0xFEFF, 0xFFFE, 0x664, 0x2167)),
    *("\u0130", "ß", "\u01c5", "\U0001d52c\U0001d52b", "\x1b[31m"),
)
_RUNS = (
    "(",
    ")",
    "[",
    "]",
    "a.",
    ".",
    "a-",
    "'",
    '"',
    "\\",
    ":",
    "-",
    ";",
    ",",
    "@a",
    "^^",
    "<",
    "_:",
    "?",
    " ",
    "\n",
    "#",
    "é",
)
_WORDS = {
    BDDL: (
        *(
            "define",
            ":init",
            ":goal",
            ":objects",
            ":regions",
            ":ranges",
            ":target",
            "and",
            "Or",
            "Not",
            "imply",
            "forall",
        ),
        *("exists", "forn", "forpairs", "fornpairs", "?x", "-", "On", "In", "Open", "robosuite", "(Not (On a b))"),
        "(exists (?x - plate) (On ?x plate_1))",
    ),
    TURTLE: (
        *(
            "@prefix",
            "@base",
            "PREFIX",
            "a",
            "true",
            "core:Predicate",
            "core:domain",
            "owl:Class",
            "rdfs:subClassOf",
            ",",
        ),
        *("sh:path", "sh:not", "sh:and", "sh:property", "sh:select", "sh:minCount", "rdf:first", "rdf:rest", "rdf:nil"),
        *("<relative>", "<>", "_:b", "[ ]", "( )", '"text"@en', '"1"^^xsd:integer', "^^", "@en-GB", "core:priority"),
    ),
}


@dataclass(frozen=True, slots=True)
class FuzzInput:
    """One input; ``how`` names its mutations in the order in which they were made."""

    number: int
    language: str
    seed: str
    how: tuple[str, ...]
    data: bytes


def fuzz_input(number: int) -> FuzzInput:
    """The input with that number: even ones are BDDL, odd ones Turtle. Equal numbers give equal bytes."""
    language = TURTLE if number % 2 else BDDL
    rng = random.Random(number)  # noqa: S311 - reproducible by design, and no secret
    seed = rng.choice(seeds(language))
    pieces = _excerpt(rng, list(seed.pieces), language)
    how = rng.choices(list(MUTATIONS), list(_WEIGHTS), k=rng.randint(1, 4))
    for name in how:
        pieces = MUTATIONS[name](rng, pieces, language) if pieces else pieces
    data = "".join(pieces).encode("utf-8", errors="replace")
    if rng.random() < 0.1:
        how.append(rng.choice(list(ENCODINGS)))
        data = ENCODINGS[how[-1]](rng, data)
    return FuzzInput(number, language, seed.name, tuple(how), data)


def past_the_lexer(data: bytes, language: str) -> bool:
    """Whether ``data`` is UTF-8 without a mark whose tokens are all tokens of the language.

    In BDDL every run of characters is a word, so there the parentheses must match too.
    """
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        return False
    if language == BDDL:
        depth = 0
        for piece in re.findall(r"[()]", re.sub(r";[^\n]*", "", text)):
            depth += 1 if piece == "(" else -1
            if depth < 0:
                return False
        return depth == 0 and not text.startswith("\ufeff")
    text = text.removeprefix("\ufeff")
    return all(_is_turtle(token.kind, token.text) for token in tokens(text))


def _is_turtle(kind: str, text: str) -> bool:
    match kind:
        case "mark":
            return text in ".;,()[]"
        case "word":
            return text in {"a", "true", "false"} or text.upper() in {"PREFIX", "BASE"}
        case _:
            return kind not in {"unterminated", "variable"}


def _excerpt(rng: random.Random, pieces: list[str], language: str) -> list[str]:
    """Mostly a few statements of a long Turtle file with its prefixes: what is short is run more often."""
    if language != TURTLE or len(pieces) < 400 or rng.random() < 0.1:
        return pieces
    ends = [0, *(place + 1 for place, piece in enumerate(pieces) if piece == ".")]
    head = max((end for start, end in pairwise(ends) if "@prefix" in pieces[start:end]), default=0)
    begin = rng.randrange(len(ends))
    chosen = ends[begin : begin + rng.randint(2, 12)]
    return pieces[:head] + pieces[max(chosen[0], head) : max(chosen[-1], head)]


def _some(rng: random.Random, pieces: list[str]) -> int:
    """The place of a piece that is no space, where three draws find one."""
    place = rng.randrange(len(pieces))
    for _ in range(3):
        if not pieces[place].isspace():
            break
        place = rng.randrange(len(pieces))
    return place


def _put(pieces: list[str], place: int, *new: str, instead: int = 0) -> list[str]:
    return [*pieces[:place], *new, *pieces[place + instead :]]


# Tokens


def _delete(rng: random.Random, pieces: list[str], _: str) -> list[str]:
    return _put(pieces, _some(rng, pieces), instead=rng.choice((1, 1, 1, 2, 5)))


def _duplicate(rng: random.Random, pieces: list[str], _: str) -> list[str]:
    place = _some(rng, pieces)
    return _put(pieces, place, *(pieces[place], " ") * rng.choice((1, 1, 2, 20)))


def _swap(rng: random.Random, pieces: list[str], _: str) -> list[str]:
    one, other = _some(rng, pieces), _some(rng, pieces)
    pieces[one], pieces[other] = pieces[other], pieces[one]
    return pieces


def _rename(rng: random.Random, pieces: list[str], _: str) -> list[str]:
    """A name gives way to another name of the file, once or everywhere."""
    places = [place for place, piece in enumerate(pieces) if _NAME.fullmatch(piece)]
    if not places:
        return pieces
    old, new = rng.choice(places), pieces[rng.choice(places)]
    if rng.random() < 0.3:
        return [new if piece == pieces[old] else piece for piece in pieces]
    return _put(pieces, old, new, instead=1)


def _word(rng: random.Random, pieces: list[str], language: str) -> list[str]:
    return _put(pieces, _some(rng, pieces), rng.choice(_WORDS[language]), " ", instead=rng.randint(0, 1))


def _foreign(rng: random.Random, pieces: list[str], language: str) -> list[str]:
    """A piece of another file, now and then of the other language."""
    other = rng.choice(seeds(language if rng.random() < 0.9 else TURTLE if language == BDDL else BDDL))
    return _put(pieces, _some(rng, pieces), rng.choice(other.pieces or ("x",)), " ", instead=rng.randint(0, 1))


def _bracket(rng: random.Random, pieces: list[str], _: str) -> list[str]:
    return _put(pieces, _some(rng, pieces), rng.choice(_BRACKETS))


def _number(rng: random.Random, pieces: list[str], _: str) -> list[str]:
    places = [place for place, piece in enumerate(pieces) if _NUMBER.fullmatch(piece)]
    return _put(pieces, rng.choice(places), rng.choice(_NUMBERS), instead=1) if places else pieces


def _letter(rng: random.Random, pieces: list[str], _: str) -> list[str]:
    """One character of a token is lost, doubled, or of the other case."""
    place = _some(rng, pieces)
    piece = pieces[place]
    if not piece:
        return pieces
    at = rng.randrange(len(piece))
    new = rng.choice(("", piece[at] * 2, piece[at].swapcase(), chr(ord(piece[at]) ^ 1)))
    return _put(pieces, place, piece[:at] + new + piece[at + 1 :], instead=1)


def _unicode(rng: random.Random, pieces: list[str], _: str) -> list[str]:
    place = _some(rng, pieces)
    at = rng.randint(0, len(pieces[place]))
    new = (
        rng.choice(_UNICODE)
        if rng.random() < 0.7
        else chr(rng.choice((rng.randrange(0xD800), rng.randrange(0xE000, 0x110000))))
    )
    return _put(pieces, place, pieces[place][:at] + new + pieces[place][at:], instead=1)


# Structure


def _drop(rng: random.Random, pieces: list[str], language: str) -> list[str]:
    found = parts(pieces, language)
    begin, end = rng.choice(found) if found else (0, 0)
    return pieces if end - begin > len(pieces) // 2 else _put(pieces, begin, instead=end - begin)


def _repeat(rng: random.Random, pieces: list[str], language: str) -> list[str]:
    found = parts(pieces, language)
    begin, end = rng.choice(found) if found else (0, 0)
    times = rng.choice((1, 1, 1, 3, 30)) if end - begin < 100 else 1
    return _put(pieces, end, *([" ", *pieces[begin:end]] * times))


def _exchange(rng: random.Random, pieces: list[str], language: str) -> list[str]:
    """Two parts change places, where neither holds the other."""
    found = parts(pieces, language)
    if len(found) < 2:
        return pieces
    (a, b), (c, d) = sorted(rng.sample(found, 2))
    return pieces if c < b else [*pieces[:a], *pieces[c:d], *pieces[b:c], *pieces[a:b], *pieces[d:]]


def _move(rng: random.Random, pieces: list[str], language: str) -> list[str]:
    """A part stands where another begins, inside of what it was not written for."""
    found = parts(pieces, language)
    if len(found) < 2:
        return pieces
    (a, b), (c, _) = rng.sample(found, 2)
    rest = _put(pieces, a, instead=b - a)
    return _put(rest, c if c <= a else max(a, c - (b - a)), *pieces[a:b], " ")


def _graft(rng: random.Random, pieces: list[str], language: str) -> list[str]:
    """A part of another file in the place of one of this file."""
    own = parts(pieces, language)
    other = list(rng.choice(seeds(language)).pieces)
    theirs = parts(other, language)
    if not own or not theirs:
        return pieces
    (a, b), (c, d) = rng.choice(own), rng.choice(theirs)
    return _put(pieces, a, *other[c:d], instead=b - a)


def _splice(rng: random.Random, pieces: list[str], language: str) -> list[str]:
    """The beginning of this file and the end of another, cut where parts end."""
    own = parts(pieces, language)
    other = list(rng.choice(seeds(language)).pieces)
    theirs = parts(other, language)
    return pieces[: rng.choice(own)[1]] + other[rng.choice(theirs)[1] :] if own and theirs else pieces


def _nest(rng: random.Random, pieces: list[str], language: str) -> list[str]:
    """A part within brackets, mostly few and now and then more than any file has."""
    found = parts(pieces, language)
    begin, end = rng.choice(found) if found else (0, len(pieces))
    depth = rng.choice((1, 2, 3, 10, 60, 70))
    if rng.random() < 0.05:
        depth = rng.choice((300, 2_000, 20_000))
    pairs = (
        (("(", ")"), ("(Not ", ")"), ("(And ", ")"))
        if language == BDDL
        else (("(", ")"), ("[ a ", " ]"), ("[ sh:not ", " ]"))
    )
    opening, closing = rng.choice(pairs)
    return [*pieces[:begin], opening * depth, *pieces[begin:end], closing * depth, *pieces[end:]]


def _huge(rng: random.Random, pieces: list[str], language: str) -> list[str]:
    """A name, number or string of 10 kB to 100 kB, or of 1.1 MB; one that goes on, or one of many short pieces."""
    size = rng.choice((10_000, 10_000, 10_000, 100_000)) if rng.random() < 0.97 else 1_100_000
    unit = rng.choice(("a", "9", "0.", "a b ", "é", "\\n", "(a) ", "a\n"))
    text = unit * (size // len(unit))
    if language == TURTLE and rng.random() < 0.7:
        text = f'"""{text}"""'
    place = _some(rng, pieces)
    return _put(pieces, place, text, " ", instead=rng.randint(0, 1))


def _run(rng: random.Random, pieces: list[str], _: str) -> list[str]:
    """One piece over and over, of the kind that makes a scanner look back."""
    return _put(pieces, _some(rng, pieces), rng.choice(_RUNS) * rng.choice((5, 100, 3_000)))


_WEIGHTED: Mapping[str, tuple[int, Mutation]] = {
    "delete": (6, _delete),
    "duplicate": (5, _duplicate),
    "swap": (6, _swap),
    "rename": (14, _rename),
    "word": (5, _word),
    "foreign": (4, _foreign),
    "bracket": (4, _bracket),
    "number": (6, _number),
    "letter": (6, _letter),
    "unicode": (4, _unicode),
    "drop": (9, _drop),
    "repeat": (9, _repeat),
    "exchange": (9, _exchange),
    "move": (6, _move),
    "graft": (6, _graft),
    "splice": (4, _splice),
    "nest": (4, _nest),
    "huge": (1, _huge),
    "run": (1, _run),
}
MUTATIONS: Mapping[str, Mutation] = {name: mutation for name, (_, mutation) in _WEIGHTED.items()}
_WEIGHTS = [weight for weight, _ in _WEIGHTED.values()]


# Encodings


def _flip(rng: random.Random, data: bytes) -> bytes:
    at = rng.randrange(len(data) or 1)
    return data[:at] + bytes([rng.randrange(256)]) + data[at + 1 :]


def _insert(what: bytes) -> Callable[[random.Random, bytes], bytes]:
    def insert(rng: random.Random, data: bytes) -> bytes:
        at = rng.randint(0, len(data))
        return data[:at] + what + data[at:]

    return insert


ENCODINGS: Mapping[str, Callable[[random.Random, bytes], bytes]] = {
    "flipped byte": _flip,
    "NUL": _insert(b"\0"),
    "surrogate": _insert(b"\xed\xa0\x80"),
    "lone byte": _insert(b"\xff"),
    "byte-order mark": lambda _, data: b"\xef\xbb\xbf" + data,
    "CRLF": lambda _, data: data.replace(b"\n", b"\r\n"),
    "CR": lambda _, data: data.replace(b"\n", b"\r"),
    "UTF-16": lambda _, data: data.decode("utf-8", errors="replace").encode("utf-16"),
    "cut off": lambda rng, data: data[: rng.randint(0, len(data))],
}
