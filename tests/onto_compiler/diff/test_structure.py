"""Blank nodes are the same where they say the same, however they are written."""

from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import RdfFormat, parse

from onto_compiler.diff.expressions import Texts
from onto_compiler.diff.structure import Descriptions, Structures

HEAD = "@prefix owl: <http://www.w3.org/2002/07/owl#> . @prefix ex: <https://example.org/> .\n"
LEAVES = st.sampled_from(["ex:A", "ex:B", "1", "1.0", "01", '"x"@en', "<<( ex:A ex:p 1 )>>"])
TREES = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.tuples(st.just("set"), st.lists(inner, min_size=1, max_size=3)),
        st.tuples(st.just("list"), st.lists(inner, max_size=3)),
        st.tuples(
            st.just("node"), st.lists(st.tuples(st.sampled_from(["ex:p", "ex:q"]), inner), min_size=1, max_size=3)
        ),
    ),
    max_leaves=12,
)


def read(text):
    """The statements of a document, and what its ``ex:S`` is said to be."""
    found = list(parse((HEAD + text).encode(), format=RdfFormat.TURTLE, rename_blank_nodes=True))
    (value,) = (one.object for one in found if one.subject.value == "https://example.org/S")
    return found, value


def written(tree, rng):
    """A document that says ``tree`` of ``ex:S``: sets in any order, blank nodes with labels or without."""
    statements = []

    def text(part):
        if isinstance(part, str):
            return part
        kind, parts = part[0], list(part[1])
        if kind == "list":
            return f"( {' '.join(map(text, parts))} )"
        rng.shuffle(parts)
        if kind == "set":
            return f"[ owl:unionOf ( {' '.join(map(text, parts))} ) ]"
        said = [f"{name} {text(value)}" for name, value in parts]
        if rng.random() < 0.5:
            return f"[ {' ; '.join(said)} ]"
        label = f"_:b{rng.randrange(10**9)}"
        statements.extend(f"{label} {one} ." for one in said)
        return label

    statements.append(f"ex:S ex:r {text(tree)} .")
    rng.shuffle(statements)
    return "\n".join(statements)


@given(TREES, st.randoms(use_true_random=False))
def test_what_is_said_in_other_words_is_the_same_and_its_text_reads_back(tree, rng):
    sides = [read(written(tree, rng)), read(written(tree, rng))]
    found = Descriptions.of([*sides[0][0], *sides[1][0]])
    sides.append(read(f"ex:S ex:r {Texts(found, ()).turtle(sides[0][1])} ."))
    both = Structures(Descriptions.of([quad for quads, _ in sides for quad in quads]))
    assert len({both.key(value) for _, value in sides}) == 1


@given(TREES, TREES, st.randoms(use_true_random=False))
def test_another_statement_more_is_another_structure(tree, other, rng):
    more = ("node", [("ex:p", tree), ("ex:extra", other)])
    less = ("node", [("ex:p", tree)])
    sides = [read(written(each, rng)) for each in (more, less)]
    both = Structures(Descriptions.of([quad for quads, _ in sides for quad in quads]))
    assert both.key(sides[0][1]) != both.key(sides[1][1])


def test_numbers_are_equal_by_value_where_the_meaning_is_asked():
    sides = [read(f"ex:S ex:r [ ex:p {number} ] .") for number in ("1.50", "1.5")]
    found = Descriptions.of([quad for quads, _ in sides for quad in quads])
    keys = [{Structures(found, meaning=meaning).key(value) for _, value in sides} for meaning in (False, True)]
    assert list(map(len, keys)) == [2, 1]
