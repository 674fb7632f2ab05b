"""Nothing is credited outside the true beam: random flights, judged by rotations of the test's own."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from shapely.affinity import translate
from shapely.geometry import box

from planner.as_flown.coverage import FlownCoverage
from planner.as_flown.track import TrackSample
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from planner.tasks.flown import flown_coverage
from tests.planner.scenarios import feature, small

SPEED_M_S, STEP_S = 20.0, 0.5
INCIDENCE_DEG, ELEVATION_DEG, AZIMUTH_DEG, HEIGHT_M = 45.0, 30.0, 10.0, 500.0
#: Half an aperture at the beam's centre, less a step of the record; and how near the edges are trusted.
HALF_M = HEIGHT_M / math.cos(math.radians(INCIDENCE_DEG)) * math.radians(AZIMUTH_DEG) / 2.0
EDGE_DEG = 0.3


@lru_cache
def planned() -> tuple[Scenario, Plan]:
    """One region and its pass, judged by all the ground round it: what is seen anywhere is seen."""
    scenario = read_scenario(_document())
    plan = make_plan(scenario)
    everywhere = tuple(replace(region, area=box(-2e4, -2e4, 2e4, 2e4)) for region in scenario.regions)
    return replace(scenario, regions=everywhere), plan


def _document() -> dict[str, Any]:
    document = small()
    ring = [[0.0, 0.0], [0.008, 0.0], [0.008, 0.003], [0.0, 0.003], [0.0, 0.0]]
    document["features"][:2] = [feature("A", "roi", "Polygon", [ring])]
    return document


@dataclass(frozen=True)
class Leg:
    """A piece of a flight: metres, degrees turned, attitude off level and the course, a gap behind."""

    length_m: float
    turn_deg: float
    roll_deg: float
    pitch_deg: float
    nose_deg: float
    gap_s: float


def mostly(usual: float, *else_: float) -> st.SearchStrategy[float]:
    """Nothing, as a good pass has it, a little, or too much."""
    return st.one_of(st.just(0.0), st.floats(-usual, usual), *(st.floats(-much, much) for much in else_))


legs = st.builds(
    Leg,
    st.floats(200.0, 900.0),
    mostly(2.0, 200.0),
    mostly(9.0, 61.0),
    mostly(9.0, 20.0),
    mostly(5.0, 20.0),
    st.sampled_from([0.0, 0.0, 3.0, 12.0]),
)


@dataclass(frozen=True)
class Flight:
    """A flight in the local frame, one row a sample."""

    time_s: NDArray[np.float64]
    places: NDArray[np.float64]
    height_m: float
    roll: NDArray[np.float64]
    pitch: NDArray[np.float64]
    nose: NDArray[np.float64]

    def seen(self, judged: Scenario | None = None) -> FlownCoverage:
        """What is credited, with the sensor on all the time."""
        scenario, plan = planned()
        lonlat = scenario.frame.to_wgs84(self.places)
        angles = np.degrees(np.stack([self.roll, self.pitch, self.nose - scenario.frame.turned_rad], axis=1))
        track = [
            TrackSample(t, lon, lat, self.height_m, roll, True, nose % 360.0, pitch)
            for t, (lon, lat), (roll, pitch, nose) in zip(
                self.time_s.tolist(), lonlat.tolist(), angles.tolist(), strict=True
            )
        ]
        return flown_coverage(judged or scenario, plan, track)


def fly(pieces: list[Leg], aside_m: float, off_deg: float, height_m: float) -> Flight:
    """From beside the pass's beginning, one leg after the other."""
    scenario, plan = planned()
    first, last = scenario.frame.to_local([place[:2] for place in plan.collects[0].line])
    ahead = (last - first) / np.hypot(*(last - first))
    place = first - 50.0 * ahead + aside_m * np.array([ahead[1], -ahead[0]])
    heading = math.atan2(ahead[0], ahead[1]) + math.radians(off_deg)
    rows, now_s = [], 0.0
    for leg in pieces:
        for _ in range(max(int(leg.length_m / (SPEED_M_S * STEP_S)), 1)):
            rows.append((now_s, *place, leg.roll_deg, leg.pitch_deg, math.degrees(heading) + leg.nose_deg))
            heading += math.radians(leg.turn_deg) * SPEED_M_S * STEP_S / leg.length_m
            place = place + SPEED_M_S * STEP_S * np.array([math.sin(heading), math.cos(heading)])
            now_s += STEP_S
        place = place + SPEED_M_S * leg.gap_s * np.array([math.sin(heading), math.cos(heading)])
        now_s += leg.gap_s
    table = np.array(rows)
    return Flight(table[:, 0], table[:, 1:3], height_m, *np.radians(table[:, 3:]).T)


def truly_in_beam(flight: Flight, ground: NDArray[np.float64]) -> bool:
    """Whether the beam lay on a place over an aperture, within every limit, by the test's own rotations."""
    # The antenna is mounted for the pitch that is flown mostly, within 5° of level.
    pitch = flight.pitch - np.clip(np.median(flight.pitch), *np.radians([-5.0, 5.0]))
    to_ned = Rotation.from_euler("ZYX", np.stack([flight.nose, pitch, flight.roll], axis=1))
    offset = ground - flight.places
    down = np.full(len(offset), flight.height_m)
    body = to_ned.inv().apply(np.stack([offset[:, 1], offset[:, 0], down], axis=1))
    across_deg = np.degrees(np.arctan2(body[:, 1], body[:, 2]))
    along_deg = np.degrees(np.arcsin(body[:, 0] / np.linalg.norm(body, axis=1)))
    # The edges of a turned beam run aslant: a place is held against those at its aperture's middle.
    slant_m = np.hypot(np.hypot(*offset.T), flight.height_m)
    course = np.unwrap(np.arctan2(*np.gradient(flight.places, axis=0).T))
    aslant_deg = np.degrees(
        HALF_M * flight.height_m / HEIGHT_M * np.abs(np.sin(flight.nose - course)) / slant_m
    )
    fits = np.abs(across_deg - INCIDENCE_DEG) <= ELEVATION_DEG / 2.0 + EDGE_DEG + aslant_deg
    # Pulses at the ends of an aperture see it at half the beam, turned by half of it at most.
    fits &= np.abs(along_deg) <= AZIMUTH_DEG + EDGE_DEG
    fits &= (np.abs(np.degrees(flight.roll)) <= 10.0) & (np.abs(np.degrees(pitch)) <= 10.0)
    fits &= slant_m <= 1.1 * HEIGHT_M / math.cos(math.radians(60.0 + EDGE_DEG)) / math.cos(
        math.radians(AZIMUTH_DEG)
    )
    steps = math.floor(2.0 * HALF_M * flight.height_m / HEIGHT_M / (SPEED_M_S * STEP_S)) - 1
    whole = np.diff(flight.time_s) <= 2.0
    return any(
        _straight(flight.places[start : start + steps + 1])
        for first, last in _runs(fits, whole)
        for start in range(first, last - steps + 1)
    )


def _runs(fits: NDArray[np.bool_], whole: NDArray[np.bool_]) -> list[tuple[int, int]]:
    found: list[tuple[int, int]] = []
    first: int | None = None
    for k, fit in enumerate(fits):
        if fit and (first is None or not whole[k - 1]):
            if first is not None:
                found.append((first, k - 1))
            first = k
        elif not fit and first is not None:
            found.append((first, k - 1))
            first = None
    return found if first is None else [*found, (first, len(fits) - 1)]


def _straight(places: NDArray[np.float64]) -> bool:
    """Whether it keeps within 5 m of the line from its first place to its last."""
    chord = shapely.LineString(places[[0, -1]])
    return bool(shapely.distance(chord, shapely.points(places)).max() <= 5.0)


@settings(max_examples=40, deadline=None)
@given(
    st.lists(legs, min_size=1, max_size=4),
    mostly(100.0, 900.0),
    mostly(5.0, 15.0),
    st.one_of(st.just(HEIGHT_M), st.floats(400.0, 600.0), st.floats(150.0, 1500.0)),
    st.integers(0, 2**32 - 1),
)
@example([Leg(900.0, 0.0, 0.0, 0.0, 0.0, 0.0), Leg(600.0, 200.0, 61.0, 0.0, 0.0, 0.0)], 0.0, 0.0, HEIGHT_M, 1)
def test_what_is_credited_lay_in_the_beam(
    pieces: list[Leg], aside_m: float, off_deg: float, height_m: float, seed: int
) -> None:
    """Whatever is flown with the sensor on, every place credited was in the beam long enough."""
    flight = fly(pieces, aside_m, off_deg, height_m)
    credited = flight.seen().seen["A"]
    if credited.is_empty:
        return
    rng = np.random.default_rng(seed)
    safe = credited.buffer(-2.0)
    west, south, east, north = credited.bounds
    tried = rng.uniform((west, south), (east, north), (100, 2))
    inside = tried[shapely.contains_xy(safe, *tried.T)]
    edge = [safe.boundary.interpolate(share, normalized=True) for share in rng.uniform(size=15)]
    for place in [*inside[:10], *(np.array(point.coords[0]) for point in edge if not point.is_empty)]:
        assert truly_in_beam(flight, place), place


@pytest.mark.parametrize("aside_m", [0.0, 100.0])
def test_a_pass_flown_well_is_credited(aside_m: float) -> None:
    """The property above does not hold for want of credit: a level straight line sees its whole strip."""
    flight = fly([Leg(1500.0, 0.0, 0.0, 0.0, 0.0, 0.0)], aside_m, 0.0, HEIGHT_M)
    length_m = SPEED_M_S * (flight.time_s[-1] - flight.time_s[0])
    strip_m = HEIGHT_M * (math.tan(math.radians(60.0)) - math.tan(math.radians(30.0)))
    assert flight.seen().seen["A"].area == pytest.approx(strip_m * (length_m - 2.0 * HALF_M), rel=1e-3)


@pytest.mark.parametrize("bank_deg", [25.0, 45.0, 61.0])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_turn_sees_nothing(bank_deg: float, side: float) -> None:
    """With the sensor left on through turns of any bank, to either side, only the straight part counts."""
    straight = Leg(700.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    turn = Leg(800.0, side * 360.0, side * bank_deg, 0.0, 0.0, 0.0)
    alone, turned = (fly(pieces, 0.0, 0.0, HEIGHT_M).seen() for pieces in ([straight], [straight, turn]))
    assert turned.seen["A"].difference(alone.seen["A"].buffer(15.0)).is_empty
    assert turned.seen["A"].area == pytest.approx(alone.seen["A"].area, rel=0.02)
    assert {left.reason for left in turned.not_counted} == {"bank"}
    assert alone.not_counted == ()


@pytest.mark.parametrize("pitch_deg", [-11.0, -3.0, 3.0, 11.0])
def test_pitch_leans_the_strip(pitch_deg: float) -> None:
    """A nose up or down moves what is seen along the line, less the 5° that an antenna may be mounted for."""
    level, leaned = (
        fly([Leg(1200.0, 0.0, 0.0, pitch, 0.0, 0.0)], 0.0, 0.0, HEIGHT_M) for pitch in (0.0, pitch_deg)
    )
    moved = leaned.places[-1] - leaned.places[0]
    beyond_deg = math.copysign(max(abs(pitch_deg) - 5.0, 0.0), pitch_deg)
    moved_m = HEIGHT_M * math.tan(math.radians(beyond_deg)) * moved / np.hypot(*moved)
    expected = translate(level.seen().seen["A"], *moved_m)
    assert leaned.seen().seen["A"].symmetric_difference(expected).area < 0.03 * expected.area


def test_a_weaving_line_is_not_straight() -> None:
    """Half a dozen turns of 30°, level all the while: no aperture of it counts."""
    weave = [Leg(60.0, turn, 0.0, 0.0, 0.0, 0.0) for turn in (15.0, -30.0, 30.0, -30.0, 30.0, -30.0)]
    seen = fly([Leg(40.0, 0.0, 0.0, 0.0, 0.0, 0.0), *weave], 0.0, 0.0, HEIGHT_M).seen()
    assert seen.seen["A"].is_empty
    assert {left.reason for left in seen.not_counted} <= {"not-straight", "no-planned-pass", "too-short"}


@given(st.floats(2.5, 300.0), st.floats(200.0, 700.0))
@settings(max_examples=15, deadline=None)
def test_a_gap_is_neither_seen_nor_missed(gap_s: float, before_m: float) -> None:
    """Whatever its length: what it may have seen of the pass is unknown, and the three make up the region."""
    scenario, plan = planned()
    region = read_scenario(_document()).regions[0]
    pieces = [Leg(before_m, 0.0, 0.0, 0.0, 0.0, gap_s), Leg(300.0, 0.0, 0.0, 0.0, 0.0, 0.0)]
    found = fly(pieces, 0.0, 0.0, HEIGHT_M).seen(replace(scenario, regions=(region,)))
    whole = fly([Leg(3000.0, 0.0, 0.0, 0.0, 0.0, 0.0)], 0.0, 0.0, HEIGHT_M).seen()
    ((gap,),) = found.gaps
    assert gap.duration_s == pytest.approx(gap_s + STEP_S)
    parts = found.seen["A"], found.unknown["A"], found.unseen["A"]
    assert sum(part.area for part in parts) == pytest.approx(region.area.area)
    assert found.seen["A"].difference(whole.seen["A"].buffer(1.0)).is_empty
    first, last = scenario.frame.to_local([place[:2] for place in plan.collects[0].line])
    ahead = (last - first) / np.hypot(*(last - first))
    start_m, end_m = before_m - 60.0, before_m - 40.0 + SPEED_M_S * gap_s
    inside = shapely.LineString([first + at_m * ahead for at_m in (start_m, end_m)])
    abeam = inside.buffer(2000.0, cap_style="flat").intersection(region.area).buffer(-5.0)
    assert abeam.intersection(found.unseen["A"]).area < 1.0
    assert abeam.intersection(found.seen["A"]).area < 1.0
