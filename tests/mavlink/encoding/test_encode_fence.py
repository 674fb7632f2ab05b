"""The fence of a mission: area and zones, closed rings, circles."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from mavlink.encoding.encode import EncodeError, encode
from planner.plan import Fence, ZoneCircle, ZonePolygon
from tests.mavlink.plans import lonlat, make_plan, square_fence


def test_fence_says_area_and_zones() -> None:
    """Area, polygons and circles become items; a zone flown under is left out with a note."""
    zone = ZonePolygon("keep out", tuple(lonlat(p) for p in ((3000, -900), (3300, -900), (3300, -600))))
    under = ZoneCircle("airway", lonlat((700.0, 300.0)), 400.0, floor_m=900.0)
    tower = ZoneCircle("tower", lonlat((-3000.0, 3000.0)), 150.0)
    fence = Fence(square_fence(6000.0).inclusion, (zone,), (under, tower))
    mission = encode(make_plan(fence=fence))
    assert [(i.command, i.param1, i.frame) for i in mission.fence] == [
        *[(5001, 4.0, 0)] * 4,
        *[(5002, 3.0, 0)] * 3,
        (5004, 150.0, 0),
    ]
    assert [i.seq for i in mission.fence] == list(range(8))
    assert any("airway" in note for note in mission.notes)
    assert not any("tower" in note for note in mission.notes)


def test_a_closed_ring_is_one_corner_less() -> None:
    """A fence ring whose last corner repeats the first is not sent with it."""
    area = square_fence(6000.0).inclusion[0]
    closed = Fence(inclusion=(replace(area, ring=(*area.ring, area.ring[0])),))
    assert encode(make_plan(fence=closed)).fence == encode(make_plan()).fence
    with pytest.raises(EncodeError, match="2 corners"):
        encode(
            make_plan(fence=Fence(inclusion=(replace(area, ring=area.ring[:2]),)), vehicle_type="multirotor")
        )


def test_a_nan_radius_is_never_encoded() -> None:
    """It would crash an autopilot."""
    bad = Fence(exclusion_circles=(ZoneCircle("bad", lonlat((9000.0, 0.0)), math.nan),))
    with pytest.raises(EncodeError, match="bad"):
        encode(make_plan(fence=bad, vehicle_type="multirotor"))
