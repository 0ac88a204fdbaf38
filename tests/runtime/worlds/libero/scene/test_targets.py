from __future__ import annotations

import pytest

from onto_compiler.required import RequiredABox
from runtime.worlds.libero.scene.targets import PlacementTarget, place_of, slot_of, threshold_of
from tests.runtime.worlds.libero.proposers import conftest as scenes

pytestmark = pytest.mark.sim


@pytest.mark.parametrize(
    ("fact", "expected"),
    [
        (scenes.ON_TABLE, PlacementTarget("box_1", "table_goal_region", None, False)),
        (scenes.ON_TRAY, PlacementTarget("box_1", None, "tray_1", False)),
        (scenes.IN_DRAWER, PlacementTarget("box_1", "chest_1_drawer_region", "chest_1", True)),
        (scenes.OPEN_DRAWER, None),
        (scenes.fact("On", "chest_1", "table_goal_region", grounded_by="placed_in_region"), None),
        (scenes.fact("On", "box_1", "box_1", grounded_by="on_object"), None),
        (scenes.OFF_TRAY, PlacementTarget("box_1", None, "tray_1", False)),
    ],
)
def test_a_place_is_read_from_the_native_arguments(world, fact, expected):
    assert place_of(world.scene, fact) == expected


def test_a_threshold_is_found_by_the_second_arguments_iri():
    assert threshold_of(scenes.SCHEMA, scenes.OPEN_DRAWER) is scenes.OPEN
    assert threshold_of(scenes.SCHEMA, scenes.ON_TRAY) is None


def test_facts_with_the_same_second_argument_have_slots():
    other = scenes.fact("On", "block_1", "tray_1", grounded_by="on_object")
    required = RequiredABox("t", "l", "p", (scenes.ON_TRAY, scenes.ON_TABLE, other))
    assert slot_of(required, scenes.ON_TRAY) == (0, 2)
    assert slot_of(required, other) == (1, 2)
    assert slot_of(required, scenes.ON_TABLE) == (0, 1)
