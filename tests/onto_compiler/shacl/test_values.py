"""Lexical forms and the order of literals follow XML Schema and SPARQL."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import Literal, NamedNode, Store

from onto_compiler.rdf import XSD
from onto_compiler.shacl.values import is_well_formed, less, number


def typed(text, kind):
    return Literal(text, datatype=NamedNode(XSD + kind))


@pytest.mark.parametrize(
    ("kind", "good", "bad"),
    [
        ("boolean", "true false 1 0", "True yes 2"),
        ("byte", "-128 127 +5 05", "128 -129 1.0 a"),
        ("unsignedByte", "0 255 -0", "256 -1"),
        ("nonNegativeInteger", "0 7", "-1 1.5"),
        ("positiveInteger", "1", "0"),
        ("integer", "-3 +003", "1e2 3.0 -"),
        ("decimal", "1.5 -.5 3. 7", "1e5 . INF"),
        ("double", "1 1.5e-3 INF -INF NaN +.5", "inf 1e nan"),
        ("date", "2020-02-29 2000-02-29Z 2021-12-31+14:00", "2021-02-29 1900-02-29 2021-13-01 21-01-01 2021-04-31"),
        (
            "dateTime",
            "2020-01-01T24:00:00 2020-01-01T00:00:00.5-05:00",
            "2020-01-01 2020-01-01T25:00:00 2020-01-01T10:00",
        ),
        ("dateTimeStamp", "2020-01-01T00:00:00Z", "2020-01-01T00:00:00"),
        ("time", "10:00:00 23:59:59.9Z", "24:00:01 10:00"),
        ("duration", "P1Y2M3DT4H5M6.7S -P1D PT1S", "P P1YT 1Y P1S"),
        ("dayTimeDuration", "P1DT2H", "P1Y"),
        ("yearMonthDuration", "P1Y", "P1D"),
        ("gYear", "2020 -0044", "20 02020"),
        ("gMonthDay", "--12-31 --02-29", "12-31 --02-30 --04-31"),
        ("hexBinary", "0aFF", "0 0g"),
        ("base64Binary", "AAAA AA==", "A AAA"),
        ("language", "en de-AT", "e_n -"),
        ("NCName", "a-b été", "1a a:b"),
    ],
)
def test_lexical_forms(kind, good, bad):
    assert [text for text in good.split() if not is_well_formed(typed(text, kind))] == []
    assert [text for text in bad.split() if is_well_formed(typed(text, kind))] == []


@pytest.mark.parametrize(
    ("kind", "text", "good"),
    [
        ("integer", "9" * 5000, True),
        ("integer", "\u0661", False),
        ("integer", "1_0", False),
        ("byte", "9" * 5000, False),
        ("double", "0x1p3", False),
        ("string", "", True),
        ("anyURI", "http://a b", True),
        ("anyURI", "rel/x", True),
        ("anyURI", "", True),
        ("anyURI", "{a}\n\\<b>", True),
    ],
)
def test_what_python_reads_otherwise_is_read_as_xml_schema_has_it(kind, text, good):
    assert is_well_formed(typed(text, kind)) is good


def test_only_numbers_have_a_number():
    assert [number(typed(text, kind)) for text, kind in (("2", "integer"), ("1.5", "decimal"), ("2e0", "double"))] == [
        2,
        1.5,
        2.0,
    ]
    assert number(Literal("2")) is None
    assert number(typed("high", "integer")) is None
    assert number(typed("NaN", "double")) is None


def test_a_datatype_of_somebody_else_takes_any_form():
    assert is_well_formed(Literal("?", datatype=NamedNode("urn:kind")))


@pytest.mark.parametrize(
    ("left", "right", "expected"),
    [
        (typed("1", "integer"), typed("1.5", "decimal"), True),
        (typed("1.1", "decimal"), typed("1.1", "double"), False),
        (typed("INF", "double"), typed("1", "integer"), False),
        (typed("1", "integer"), typed("NaN", "double"), False),
        (Literal("a"), Literal("b"), True),
        (Literal("a", language="en"), Literal("b", language="en"), False),
        (typed("false", "boolean"), typed("1", "boolean"), True),
        (typed("false", "boolean"), typed("1", "integer"), False),
        (typed("2020-01-01", "date"), typed("2020-01-02", "date"), True),
        (typed("2020-01-01T10:00:00Z", "dateTime"), typed("2020-01-01T10:30:00+01:00", "dateTime"), False),
        (typed("2020-01-01T10:00:00", "dateTime"), typed("2020-01-01T23:00:00Z", "dateTime"), False),
        (typed("2020-01-01T10:00:00", "dateTime"), typed("2020-01-02T01:00:00Z", "dateTime"), True),
        (typed("-0001-01-01", "date"), typed("0001-01-01", "date"), True),
        (typed("9999-12-31", "date"), typed("10000-01-01", "date"), True),
        (typed("PT1H", "dayTimeDuration"), typed("PT61M", "dayTimeDuration"), True),
        (typed("P1D", "dayTimeDuration"), typed("P1Y", "yearMonthDuration"), True),
        (typed("P1M", "yearMonthDuration"), typed("P30D", "dayTimeDuration"), False),
        (typed("P30D", "dayTimeDuration"), typed("P1M", "yearMonthDuration"), False),
        (typed("P1M1D", "duration"), typed("P2M", "duration"), True),
        (typed("2020", "gYear"), typed("2021", "gYear"), True),
        (typed("2020", "gYear"), typed("2021", "integer"), False),
        (typed("--12-31Z", "gMonthDay"), typed("--01-01Z", "gMonthDay"), False),
        (typed("ten", "integer"), typed("20", "integer"), False),
    ],
)
def test_order(left, right, expected):
    assert less(left, right) is expected


ZONES = ("", "Z", "+14:00", "-05:00")
LITERALS = st.one_of(
    st.integers(-1000, 1000).map(lambda n: typed(str(n), "integer")),
    st.decimals(-100, 100, places=2).map(lambda n: typed(str(n), "decimal")),
    st.floats(-100, 100, allow_nan=False).map(lambda n: typed(repr(n), "double")),
    st.datetimes().map(lambda t: typed(t.isoformat() + "Z", "dateTime")),
    st.dates().map(lambda d: typed(d.isoformat(), "date")),
    st.integers(-2000, 2000).map(lambda n: typed(f"{'-' * (n < 0)}P{abs(n)}D", "dayTimeDuration")),
    st.integers(-60, 60).map(lambda n: typed(f"{'-' * (n < 0)}P{abs(n)}M", "yearMonthDuration")),
    st.tuples(st.integers(0, 60), st.integers(0, 400)).map(lambda n: typed(f"P{n[0]}M{n[1]}D", "duration")),
    st.tuples(st.integers(1000, 9999), st.sampled_from(ZONES)).map(lambda n: typed(f"{n[0]}{n[1]}", "gYear")),
    st.tuples(st.dates(), st.sampled_from(ZONES)).map(lambda d: typed(f"{d[0]:--%m-%d}{d[1]}", "gMonthDay")),
    st.tuples(st.dates(), st.sampled_from(ZONES)).map(lambda d: typed(f"{d[0]:--%m}{d[1]}", "gMonth")),
)


@settings(max_examples=200)
@given(LITERALS, LITERALS)
def test_the_order_is_that_of_oxigraph(left, right):
    """Source: SPARQL 1.1, section 17.3, as Oxigraph implements it."""
    for sign, or_equal in (("<", False), ("<=", True)):
        (row,) = Store().query(f"SELECT (COALESCE({left} {sign} {right}, false) AS ?holds) WHERE {{}}")
        assert less(left, right, or_equal=or_equal) == (row["holds"].value == "true")
