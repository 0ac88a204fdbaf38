"""The short forms of an episode: the JSON record and the table."""

from __future__ import annotations

import io
import json

import pytest
from hypothesis import HealthCheck, given, settings
from rich.console import Console

from runtime.trace.narrate import narrate
from runtime.trace.summary import demo_table, episode_summary
from runtime.wording import amount
from tests.runtime.trace import samples
from tests.strategies import SCHEMA, episodes

law = settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])


def test_a_summary_names_predicate_arguments_margin_failure_and_route():
    summary = episode_summary(samples.accepted(), SCHEMA)
    (diagnosis,) = summary["diagnoses"]
    assert diagnosis["predicate"] == "on"
    assert diagnosis["arguments"] == ["akita_black_bowl_1", "plate_1"]
    assert diagnosis["margin"] == -0.142
    assert diagnosis["margin_after"] == 0.018
    assert diagnosis["unit"] == "m"
    assert diagnosis["failure"] == "relation_missing"
    assert diagnosis["route"] == "object_relation_predicate"
    assert diagnosis["routes"] == ["object_relation_predicate", "source_joint_residual"]
    assert (summary["attempts"], summary["accepted"], summary["settled"]) == (2, True, True)


def test_a_fact_that_no_attempt_selected_has_no_route():
    diagnoses = episode_summary(samples.negated(), SCHEMA)["diagnoses"]
    assert [d["route"] for d in diagnoses] == ["object_relation_predicate", None]
    assert diagnoses[1]["margin"] is None
    assert diagnoses[0]["polarity"] is False


def test_the_unit_of_a_joint_is_its_thresholds():
    (diagnosis,) = episode_summary(samples.unresolved(), SCHEMA)["diagnoses"]
    assert diagnosis["unit"] == "rad"
    assert diagnosis["failure"] == "joint_state"


@law
@given(episodes())
def test_every_summary_is_json_and_every_episode_can_be_told(episode):
    text = json.dumps(episode_summary(episode, SCHEMA))
    assert json.loads(text)["attempts"] == len(episode.attempts)
    assert sum(line.startswith("Attempt ") for line in narrate(episode, SCHEMA)) >= len(episode.attempts)


@pytest.mark.parametrize("width", [80, 100, 160])
def test_the_table_fits_its_width_and_breaks_no_route_name(width):
    console = Console(file=io.StringIO(), width=width)
    console.print(demo_table(samples.all_samples(), SCHEMA))
    text = console.file.getvalue()
    assert max(map(len, text.splitlines())) <= width
    for word in ("object_relation_predicate", "source_joint_residual", "predicate_mismatch", "disagreement", "lost"):
        assert word in text
    assert "-142 mm -> +18 mm" in text


@pytest.mark.parametrize(
    ("margin", "unit", "text"),
    [
        (-0.1424, "m", "-142 mm"),
        (0.0004, "m", "+0.4 mm"),
        (2.5, "m", "+2.5 m"),
        (-0.5, "rad", "-0.5 rad"),
        (float("nan"), "m", "no margin"),
        (1.0, "", "+1"),
    ],
)
def test_an_amount_has_its_sign_and_unit(margin, unit, text):
    assert amount(margin, unit) == text
