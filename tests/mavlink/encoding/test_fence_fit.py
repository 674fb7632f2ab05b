"""Fences made to fit what autopilots store: by shapely, never less forbidden, never in the flight's way."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.affinity import scale
from shapely.geometry import LineString, MultiPoint, Point, Polygon, box

from mavlink.dialects import dialect_for
from mavlink.dialects.stores import ARDUPLANE_STORE, PX4_STORE, FenceStore
from mavlink.encoding.encode import encode
from mavlink.encoding.fit import FAR_M, ROOM_M, THINNED_M, Piece, fitted, near_notes, thinned
from planner.plan import Fence, ZonePolygon
from tests.mavlink.plans import lonlat, make_plan, square_fence


def ragged(middle: tuple[float, float], size_m: float, corners: int, seed: int) -> Polygon:
    """An oval with a rough outline."""
    rng = np.random.default_rng(seed)
    radii = size_m + 3.0 * rng.standard_normal(corners)
    angles = np.linspace(0.0, math.tau, corners, endpoint=False)
    return Polygon(
        [
            (middle[0] + r * math.cos(a), middle[1] + 0.8 * r * math.sin(a))
            for a, r in zip(angles, radii, strict=True)
        ]
    )


corner = st.tuples(st.floats(-3000.0, 3000.0), st.floats(-3000.0, 3000.0))
hulls = st.lists(corner, min_size=4, max_size=40).map(lambda places: MultiPoint(places).convex_hull)
smooth = hulls.filter(lambda hull: isinstance(hull, Polygon) and hull.area > 1e4)
rough = st.builds(
    ragged,
    corner,
    st.floats(30.0, 2000.0),
    st.integers(5, 120),
    st.integers(0, 1000),
)


@settings(deadline=None, max_examples=150)
@given(st.one_of(smooth, rough), st.sampled_from(THINNED_M), st.booleans())
def test_thinned_edges_lie_on_the_safe_side_within_the_distance_told(
    shape: Polygon, by_m: float, inside: bool
) -> None:
    """Round a zone, inside an area; nowhere farther from the drawn edge than said."""
    found = thinned(shape, by_m, inside=inside)
    if found is None:
        return
    assert found.is_valid
    assert (shape if inside else found).covers(found if inside else shape)
    edge, told = found.exterior, shape.exterior.buffer(by_m * 1.0001, quad_segs=64)
    assert told.covers(edge)


@pytest.mark.parametrize("store", [ARDUPLANE_STORE, PX4_STORE])
@pytest.mark.parametrize("corners", [120, 300, 900])
def test_a_zone_of_many_corners_fits(store: FenceStore, corners: int) -> None:
    """It holds the drawn zone, leaves the flight its room, and the note tells what was done."""
    zone, flown = ragged((0.0, 0.0), 600.0, corners, corners), LineString([(-2000.0, 760.0), (2000.0, 760.0)])
    pieces, notes = fitted([Piece.polygon("N", zone, False)], [flown], store)
    (piece,) = pieces
    assert store.holds([piece.corners], 0)
    assert piece.shape.covers(zone)
    assert zone.exterior.buffer(1.0001 * piece.thinned_m, quad_segs=64).covers(piece.shape.exterior)
    assert flown.distance(piece.shape) >= min(ROOM_M, flown.distance(zone))
    assert any("N" in note and f"{piece.thinned_m:g} m" in note for note in notes)


def test_a_circle_drawn_with_many_corners_is_one() -> None:
    """Round the drawn one, by no more than is told; on the wire a circle. An ellipse is none."""
    drawn = Point(4000.0, 0.0).buffer(1500.0, quad_segs=90)
    (piece,), (note,) = fitted([Piece.polygon("CTR", drawn, False)], [], PX4_STORE)
    assert piece.round
    assert piece.radius_m is not None
    disc = drawn.centroid.buffer(piece.radius_m, quad_segs=1024)
    assert disc.covers(drawn)
    assert piece.radius_m - 1500.0 <= piece.thinned_m
    assert "CTR" in note
    ring = tuple(lonlat((x, y)) for x, y in drawn.exterior.coords[:-1])
    mission = encode(make_plan(fence=Fence((), (ZonePolygon("CTR", ring),))))
    (item,) = mission.fence
    assert (item.command, item.param1) == (5004, pytest.approx(1500.0, abs=2.0))
    middle = lonlat((4000.0, 0.0))
    assert (item.y / 1e7, item.x / 1e7) == pytest.approx(middle, abs=1e-5)
    ellipse = scale(drawn, 1.0, 0.7)
    (piece,), _ = fitted([Piece.polygon("E", ellipse, False)], [], PX4_STORE)
    assert not piece.round


def test_an_area_of_many_corners_fits_round_the_flight() -> None:
    """It lies within the drawn area and still holds the flight, as far from its edge as ``ROOM_M``."""
    area = ragged((0.0, 0.0), 3000.0, 400, 3)
    flown = LineString([(-2000.0, 0.0), (2000.0, 300.0)])
    (piece,), _ = fitted([Piece.polygon("area", area, True)], [flown], PX4_STORE)
    assert PX4_STORE.holds([piece.corners], 0)
    assert area.covers(piece.shape)
    assert piece.shape.covers(flown.buffer(ROOM_M))


def test_a_zone_is_not_thinned_into_the_flight() -> None:
    """Where a flight fills the notch that thinning would close, the corners stay and the note says so."""
    notch = Polygon([(0, 0), (1000, 0), (1000, 1000), (520, 1000), (500, 100), (480, 1000), (0, 1000)])
    many = notch.segmentize(20.0).union(box(-1, -1, 1, 1))
    flown = LineString([(500.0, 120.0), (500.0, 2000.0)])
    (piece,), notes = fitted([Piece.polygon("N", many, False)], [flown], FenceStore(5))
    assert not piece.shape.intersects(flown)
    assert any("does not fit" in note for note in notes)


def test_zones_that_the_area_shuts_out_are_left_out() -> None:
    """They forbid nothing that the area does not; one that reaches in stays."""
    area = Piece.polygon("area", box(0, 0, 1000, 1000), True)
    away = Piece.polygon("away", box(2000, 0, 2100, 100), False)
    near = Piece.polygon("near", box(900, 0, 1100, 100), False)
    disc = Piece("disc", Point(5000.0, 0.0).buffer(50.0))
    pieces, (note,) = fitted([area, away, near, disc], [], PX4_STORE)
    assert [piece.name for piece in pieces] == ["area", "near"]
    assert "away" in note
    assert "disc" in note


def test_of_zones_without_number_the_farthest_are_left_out() -> None:
    """As few as let the rest fit, none within ``FAR_M`` of the flight; where that is too few it is told."""
    flown = LineString([(0.0, 0.0), (1000.0, 0.0)])
    zones = [
        Piece.polygon(f"Z{k}", box(1000.0 * k, 500.0, 1000.0 * k + 10.0, 510.0), False) for k in range(40)
    ]
    pieces, notes = fitted(zones, [flown], PX4_STORE)
    assert [piece.name for piece in pieces] == [f"Z{k}" for k in range(63 // 4)]
    assert any("25 zones" in note and "left out" in note for note in notes)
    crowd = [Piece.polygon(f"C{k}", box(50.0 * k, 500.0, 50.0 * k + 10.0, 510.0), False) for k in range(20)]
    pieces, notes = fitted(crowd, [flown], PX4_STORE)
    assert len(pieces) == 20
    assert max(flown.distance(piece.shape) for piece in pieces) < FAR_M
    assert any("does not fit" in note for note in notes)


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_a_mission_with_a_zone_of_many_corners_is_taken(autopilot: Any) -> None:
    """Its fence fits, no finding is left, and its corners on the wire hold the zone as drawn."""
    zone = ragged((3600.0, -900.0), 400.0, 300, 1)
    drawn = ZonePolygon("N", tuple(lonlat((x, y)) for x, y in zone.exterior.coords[:-1]))
    plan = make_plan(fence=Fence(square_fence(6000.0).inclusion, (drawn,)), autopilot=autopilot)
    mission = encode(plan)
    store = dialect_for(autopilot, "fixed_wing").fence_store
    vertices = [item for item in mission.fence if item.command == 5002]
    assert store.holds([len(vertices), 4], 0)
    assert {item.param1 for item in vertices} == {float(len(vertices))}
    assert mission.dialect.check(mission.fence) == ()
    ring = Polygon([(item.y / 1e7, item.x / 1e7) for item in vertices])
    # Places go in steps of 1e-7 degrees, some centimetre.
    assert ring.buffer(2e-7).covers(Polygon(drawn.ring))
    assert any("thinned" in note for note in mission.notes)


def test_a_fence_that_the_flight_nearly_meets_is_told() -> None:
    """By shapely's distance: an edge 2 m beside the line, not one 20 m beside it; inside an area as well."""
    flown = LineString([(0.0, 0.0), (1000.0, 0.0)])
    pieces = [
        Piece.polygon("near", box(400, 2, 500, 50), False),
        Piece.polygon("apart", box(400, -50, 500, -20), False),
        Piece.polygon("area", box(-3, -900, 1900, 900), True),
    ]
    notes = near_notes(pieces, [flown])
    assert len(notes) == 2
    assert "2.0 m from the edge of 'near'" in notes[0]
    assert "3.0 m from the edge of 'area'" in notes[1]


def test_more_than_is_stored_is_found() -> None:
    """In ArduPilot's bytes, and in PX4's points."""
    crowd = tuple(
        ZonePolygon(
            f"C{k}", tuple(lonlat(place) for place in ((x, 900), (x + 40, 900), (x + 40, 940), (x, 940)))
        )
        for k, x in enumerate(range(2500, 4500, 80))
    )
    for autopilot, rule in (("ardupilot", "fence-storage"), ("px4", "too-many-items")):
        mission = encode(make_plan(fence=Fence((), crowd), autopilot=autopilot))
        assert rule in {found.rule for found in mission.dialect.check(mission.fence)}
        assert any("does not fit" in note for note in mission.notes)
