"""Multirotors that brake for their corners: when, how far they fly for it, and that nothing is quicker."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyproj import Geod

from mavlink.encoding.encode import encode
from mavlink.encoding.stops import MERGE_M
from mavlink.wire.items import Command
from planner.dubins.path import Path
from planner.dubins.words import candidates_between
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.profile.flight import Stretch
from planner.profile.smoothed import smoothed_times
from planner.profile.times import rotor_times
from planner.route import Anchor
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.manners import ONE_PLACE_M, manners_of

GEOD = Geod(ellps="WGS84")
LANE_M = 500.0
#: Of a turn over the ground: so much less is no gain.
SAME_S = 1.0


def field(**vehicle: Any) -> dict[str, Any]:
    """A field of 300 by 240 m, seen from 100 m by a camera whose lanes lie some 30 m apart."""
    east, north = (degrees / 111_195.0 for degrees in (300.0 / math.cos(math.radians(47.0)), 240.0))
    ring = [[8.0, 47.0], [8.0 + east, 47.0], [8.0 + east, 47.0 + north], [8.0, 47.0 + north], [8.0, 47.0]]
    camera = {"focal_length_m": 0.035, "pixel_pitch_m": 4.5e-6, "image_px": [7952, 5304]}
    return {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "id": "field",
                "geometry": {"type": "Polygon", "coordinates": [ring]},
                "properties": {"role": "roi"},
            },
            {
                "type": "Feature",
                "id": "start",
                "geometry": {"type": "Point", "coordinates": [7.999, 46.999]},
                "properties": {"role": "start"},
            },
        ],
        "vehicles": [{"name": "q", "type": "multirotor", "airspeed_m_s": 10.0, "settle_m": 0.0, **vehicle}],
        "sensors": [{"name": "eye", "type": "camera", "side_overlap": 0.7, **camera}],
        "altitude_m": 100.0,
    }


@pytest.fixture(scope="module", params=["ardupilot", "px4"])
def plan(request: pytest.FixtureRequest) -> Plan:
    return make_plan(read_scenario(field(autopilot=request.param)))


def apart_m(one: Any, other: Any) -> float:
    return float(GEOD.inv(*one[:2], *other[:2])[2])


def test_between_lanes_it_flies_hardly_farther_than_they_are_apart(plan: Plan) -> None:
    """From the end of a lane to the beginning of the next: their distance and two corners."""
    assert plan.violations == ()
    lanes, hops = plan.collects, plan.transits[1:-1]
    assert len(lanes) > 5
    for before, hop, behind in zip(lanes, hops, lanes[1:], strict=False):
        straight_m = apart_m(before.line[-1], behind.line[0])
        # Two right angles as quarters of a circle of 2 m stand out by 2 m and are shorter than their corners.
        assert hop.length_m <= straight_m + 4.0
    near_m = [apart_m(a.line[-1], b.line[0]) for a, b in pairwise(lanes)]
    assert min(near_m) < 40.0


def test_each_corner_is_one_waypoint(plan: Plan) -> None:
    """Waypoints lie on the path or a corner's 0.9 m beside it, none nearer to the next than a metre."""
    places = [
        (item.y / 1e7, item.x / 1e7) for item in encode(plan).mission if item.command == Command.NAV_WAYPOINT
    ]
    line = plan.paths[0].line
    for one, other in pairwise(places):
        assert apart_m(one, other) > 1.0
    corner_m = 2.002 * (math.sqrt(2.0) - 1.0)
    for place in places:
        # Vertices lie no farther apart than 0.2 m on arcs; the others are ends of straights.
        assert min(apart_m(place, vertex) for vertex in line) <= corner_m + 1.2


def test_times_count_the_places_that_missions_name() -> None:
    """What is one place in a mission is one where a flight's time is reckoned."""
    assert ONE_PLACE_M == MERGE_M


def test_a_stated_radius_is_kept() -> None:
    """Who says how tight it turns gets turns no tighter."""
    said = make_plan(read_scenario(field(min_turn_radius_m=12.0)))
    free = make_plan(read_scenario(field()))
    (wide_m,) = (path.min_turn_radius_m for path in said.paths)
    (tight_m,) = (path.min_turn_radius_m for path in free.paths)
    assert wide_m is not None
    assert wide_m >= 12.0
    assert tight_m == pytest.approx(2.0, rel=0.01)
    assert free.metrics.duration_s < said.metrics.duration_s


def flown_s(line: Path, autopilot: Any, speed_m_s: float) -> float:
    """A lane, the line and a lane, as the autopilot flies them."""
    aircraft = Aircraft("q", "multirotor", autopilot, speed_m_s, 2.0)
    lanes = (line.segments[0], line.segments[-1])
    rows = [
        Stretch("mission", segment.start, segment, 0.0, 80.0, 80.0, collects=segment in lanes)
        for segment in line.segments
    ]
    times = smoothed_times if autopilot == "px4" else rotor_times
    return math.fsum(times(rows, speed_m_s, manners_of(aircraft)))


def joined(apart: float, radius_m: float) -> Path:
    """Two lanes flown to and fro, and the shortest turn between them."""
    out = candidates_between(Anchor(0.0, 0.0, 0.0), Anchor(LANE_M, 0.0, 0.0), 1.0)[0]
    turn = candidates_between(Anchor(LANE_M, 0.0, 0.0), Anchor(LANE_M, apart, math.pi), radius_m)[0]
    back = candidates_between(Anchor(LANE_M, apart, math.pi), Anchor(0.0, apart, math.pi), 1.0)[0]
    return Path((*out.segments, *turn.segments, *back.segments))


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from(["ardupilot", "px4"]), st.floats(4.0, 16.0), st.floats(6.0, 200.0), st.floats(4.0, 90.0)
)
def test_no_arc_between_lanes_is_quicker(
    autopilot: str, speed_m_s: float, apart: float, radius_m: float
) -> None:
    """Turns of any radius are flown from chord to chord, more slowly than two corners and what is between."""
    braked_s = flown_s(joined(apart, 2.002), autopilot, speed_m_s)
    round_s = flown_s(joined(apart, radius_m), autopilot, speed_m_s)
    assert braked_s <= round_s + SAME_S
