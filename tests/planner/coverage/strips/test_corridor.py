"""Corridors in few straight pieces: all of the ground, no more passes than there need be."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from shapely.geometry import LineString, Point, Polygon

from planner.coverage import decompose
from planner.coverage.estimate import least_tour_m
from planner.coverage.merge import merge_regions, split_region
from planner.coverage.strips.corridor import Corridor, Pieces
from planner.coverage.strips.targets import StripTarget, targets
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.sensors.strip import swaths_m
from planner.wishes import Region
from tests.planner.coverage.lines import KINDS, digitised
from tests.planner.coverage.shapes import HEIGHT_M, paper_sensor, unseen_m2
from tests.planner.coverage.strips.test_sweeps import open_ground

SENSOR = paper_sensor()
SWATH_M = SENSOR.swath_m(HEIGHT_M)
RADIUS_M = 100.0
DIGITISED = Path(__file__).parents[3] / "faults" / "corridor_digitised.geojson"
CORRIDORS = [(kind, seed) for kind in KINDS for seed in range(3)]
ETAS = np.array([0.0, 0.5, 1.0])
#: A turn so dear that passes alone count.
DEAR_M = 1e7


def of_line(kind: str, seed: int) -> tuple[LineString, Polygon]:
    line = digitised(kind, seed)
    area = line.buffer((20.0, 60.0, 120.0)[seed % 3], cap_style="flat")
    assert isinstance(area, Polygon)
    return line, area


def narrowest_m(points_m: np.ndarray) -> float:
    """The least width of points, by looking all round and then closer."""
    middle_rad, half_rad = 0.0, math.pi / 2.0
    width_m = math.inf
    for _ in range(5):
        angles_rad = middle_rad + half_rad * np.linspace(-1.0, 1.0, 721)
        across_m = np.outer(-np.sin(angles_rad), points_m[:, 0]) + np.outer(
            np.cos(angles_rad), points_m[:, 1]
        )
        widths_m = np.ptp(across_m, axis=1)
        middle_rad, half_rad = float(angles_rad[widths_m.argmin()]), half_rad / 100.0
        width_m = min(width_m, float(widths_m.min()))
    return width_m


def fewest(corridor: Corridor, begin: int) -> int:
    """The fewest pieces from a place on that a swath holds, each as long as can be."""
    count = len(corridor.runs)
    at, pieces = 0, 0
    while at < count:
        reach = at
        points_m = np.empty((0, 2))
        while reach < count:
            points_m = np.concatenate([points_m, corridor.runs[(begin + reach) % count]])
            if narrowest_m(points_m) + 2.0 * corridor.half_m > SWATH_M:
                break
            reach += 1
        assert reach > at
        at, pieces = reach, pieces + 1
    return pieces


def swaths(angles_rad: np.ndarray) -> np.ndarray:
    return swaths_m(SENSOR, HEIGHT_M, angles_rad)


@pytest.mark.parametrize("kind", KINDS)
def test_pieces_are_as_few_as_swaths_can_hold(kind: str) -> None:
    """Where turns are dear a line is cut as seldom as by reaching ahead as far as a swath holds."""
    line, area = of_line(kind, 1)
    corridor = Corridor.of(area, line, SWATH_M)
    pieces = Pieces.of(corridor, swaths, None).cheapest(DEAR_M, closed=corridor.closed)
    assert pieces is not None
    assert [end for _, end in pieces[:-1]] == [begin for begin, _ in pieces[1:]]
    assert pieces[-1][1] - pieces[0][0] == len(corridor.runs)
    assert len(pieces) <= fewest(corridor, pieces[0][0])
    assert len(pieces) <= fewest(corridor, 0)


@pytest.mark.parametrize(("kind", "seed"), CORRIDORS)
def test_pieces_are_all_of_the_corridor(kind: str, seed: int) -> None:
    """However a line runs, its pieces leave no ground between them, and each is its own line's ground."""
    line, area = of_line(kind, seed)
    corridor = Corridor.of(area, line, SWATH_M)
    pieces = Pieces.of(corridor, swaths, None).cheapest(300.0, closed=corridor.closed)
    assert pieces is not None
    division = corridor.division(pieces)
    assert division is not None
    assert unseen_m2(area, [piece.buffer(1e-4) for piece in division]) < 1e-3
    for piece, ground in zip(pieces, division, strict=True):
        runs = [corridor.runs[k % len(corridor.runs)] for k in range(*piece)]
        own = LineString(np.concatenate(runs)).buffer(1.02 * corridor.half_m + 1.0)
        assert own.covers(ground)


@pytest.mark.parametrize(("kind", "seed"), [(kind, k % 3) for k, kind in enumerate(KINDS)])
def test_a_corridor_takes_no_more_passes_than_its_legs(kind: str, seed: int) -> None:
    """All of it is seen, in no more stops and on no longer way than leg by leg."""
    line, area = of_line(kind, seed)
    around = open_ground(RADIUS_M)
    (region,) = split_region(Region("R", area, axis=line))
    found = targets(region, SENSOR, HEIGHT_M, around)
    cheapest = zip(found, _coarse(found), strict=True)
    passes = [stop.passes(options, int(options.inner_m.argmin())) for stop, options in cheapest]
    seen = [one.footprint for each in passes for one in each]
    assert unseen_m2(area, [footprint.buffer(1e-6) for footprint in seen]) < 1e-2
    legs = decompose.legs(area, line)
    if legs is None:
        return
    alone = [targets(region.piece(leg), SENSOR, HEIGHT_M, around, division="whole") for leg in legs]
    by_leg = [stop for each in alone for stop in each]
    assert len(found) <= len(by_leg)
    assert _way_m(found) <= 1.01 * _way_m(by_leg)


def test_a_corridor_among_other_regions_keeps_its_line() -> None:
    """Beside a target that the close filter joins to it a curve is flown in straight pieces all the same."""
    line, area = of_line("curve", 0)
    beside = Point(line.interpolate(0.5, normalized=True)).buffer(90.0)
    whole = merge_regions((Region("R", area, axis=line), Region("P", beside)))
    assert [region.names for region in whole] == [("R", "P")]
    around = open_ground(RADIUS_M)
    found = targets(whole[0], SENSOR, HEIGHT_M, around)
    (alone,) = split_region(Region("R", area, axis=line))
    assert len(found) <= len(targets(alone, SENSOR, HEIGHT_M, around)) + 1
    assert {name for stop in found for name in stop.region.names} == {"R", "P"}
    assert unseen_m2(area, [stop.region.area.buffer(1e-4) for stop in found]) < 1e-3


def test_pieces_keep_out_of_what_is_barred() -> None:
    """A piece that may not be is in no other piece either, so long as it can be cut."""
    line, area = of_line("road", 0)
    corridor = Corridor.of(area, line, SWATH_M)
    lengths = Pieces.of(corridor, swaths, None)
    middle = len(corridor.runs) // 2
    assert lengths.cheapest(300.0, closed=False) == ((0, len(corridor.runs)),)
    cut = lengths.cheapest(300.0, [(middle - 1, middle + 1)], closed=False)
    assert cut == ((0, middle), (middle, len(corridor.runs)))
    assert lengths.cheapest(300.0, [(middle, middle + 1)], closed=False) is None


def test_a_digitised_curve_is_flown_like_one_cut_by_hand() -> None:
    """69 short legs take no more than the 15 passes and 54.7 km that they take cut by hand."""
    plan = make_plan(read_scenario(json.loads(DIGITISED.read_text())))
    assert plan.metrics.length_m <= 54_700.0
    assert len(plan.collects) <= 15
    assert not plan.violations
    assert plan.metrics.coverage["C"] == 1.0


def _coarse(stops: list[StripTarget] | tuple[StripTarget, ...]) -> list:
    return [stop.coarse(math.radians(15.0), ETAS) for stop in stops]


def _way_m(stops: list[StripTarget] | tuple[StripTarget, ...]) -> float:
    found = [(options.entries, options.exits, options.inner_m) for options in _coarse(stops)]
    return least_tour_m(found, open_ground(RADIUS_M))
