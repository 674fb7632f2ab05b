"""Fences that will not be on board as drawn are told before anything is sent."""

from __future__ import annotations

import math
from typing import Any

import pytest

from app.services.plans.fences import fence_notes
from app.services.scenarios.validation import judge
from mavlink.encoding.encode import encode
from planner.plan import Fence, ZonePolygon
from tests.mavlink.plans import lonlat, make_plan
from tests.planner.scenarios import feature, small


def disc(east_deg: float, north_deg: float, corners: int) -> list[list[list[float]]]:
    """A ring of corners, 200 m wide."""
    angles = [math.tau * k / corners for k in range(corners)]
    ring = [[east_deg + 0.0009 * math.cos(a), north_deg + 0.0009 * math.sin(a)] for a in angles]
    return [[*ring, ring[0]]]


def crowd(count: int, corners: int, autopilot: str) -> dict[str, Any]:
    """The small scenario with zones in a row beside it, all within its area."""
    zones = [
        feature(f"Z{k}", "no_fly", "Polygon", disc(-0.045 + 0.0024 * k, 0.035, corners)) for k in range(count)
    ]
    document = small(*zones, clearance_m=0.0)
    document["vehicles"][0] |= {"autopilot": autopilot, "finish": "land"}
    return document


@pytest.mark.parametrize(("autopilot", "fits", "too_many"), [("ardupilot", 15, 40), ("px4", 12, 30)])
def test_a_fence_that_will_not_fit_is_a_finding(autopilot: str, fits: int, too_many: int) -> None:
    """With the count and the limit; what thinning makes fit is none, however many corners it has."""
    (told,) = [f for f in judge(crowd(too_many, 12, autopilot)).warnings if f.rule == "fence-does-not-fit"]
    assert {"ardupilot": "84", "px4": "63"}[autopilot] in told.message
    assert "fence-does-not-fit" not in {f.rule for f in judge(crowd(fits, 60, autopilot)).warnings}


def test_the_plan_says_what_its_mission_will_say() -> None:
    """The notes on a fence are those of the encoded mission."""
    ring = tuple(
        lonlat((3600.0 + 400.0 * math.cos(k / 48.0), 400.0 * math.sin(k / 48.0))) for k in range(301)
    )
    plan = make_plan(fence=Fence((), (ZonePolygon("N", ring),)))
    notes = fence_notes(plan)
    assert len(notes) == 1
    assert "N thinned" in notes[0]
    assert set(notes) <= set(encode(plan).notes)
