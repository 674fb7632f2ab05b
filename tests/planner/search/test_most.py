"""What no flight finds more than, against a linear programme, geometry, and plans."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely
from scipy.optimize import linprog
from shapely.geometry import LineString

from planner.search.most import LOOKS, Sweeping, most_found, most_of
from planner.search.values import Swath
from planner.wishes import Importance, ImportancePatch, ImportancePoint, ImportanceRaster

CAMERA = Swath(-60.0, 60.0, -45.0, -45.0)
STRIP = Swath(-300.0, -180.0, 20.0, 10.0)


@pytest.mark.parametrize("detection", [1.0, 0.6])
def test_the_worth_is_that_of_a_linear_programme(detection: float) -> None:
    """Looks on pieces of ground, each so often for its place in the row, their areas within what is swept."""
    rng = np.random.default_rng(4)
    scores, areas_m2 = rng.uniform(0.0, 5.0, 90), rng.uniform(100.0, 4_000.0, 90)
    looks = 1 if detection == 1.0 else LOOKS
    pays = np.concatenate([scores * detection * (1.0 - detection) ** k for k in range(looks)])
    bounds = [(0.0, area) for area in np.tile(areas_m2, looks)]
    best = linprog(-pays, np.ones((1, len(pays))), [60_000.0], bounds=bounds)
    rest = float((scores * areas_m2).sum()) * (1.0 - detection) ** looks
    assert most_of((scores, areas_m2), 60_000.0, detection) == pytest.approx(-best.fun + rest)


def test_what_lies_on_the_ground_is_counted_once_and_as_deep_as_it_lies() -> None:
    """Two squares that overlap, half of one off the ground; a point's worth in all; a raster's cells."""
    ground = shapely.box(0.0, 0.0, 1_000.0, 1_000.0)
    patches = (
        ImportancePatch("a", shapely.box(100.0, 100.0, 300.0, 300.0), 2.0),
        ImportancePatch("b", shapely.box(200.0, 200.0, 400.0, 400.0), 3.0),
        ImportancePatch("c", shapely.box(-100.0, 500.0, 100.0, 600.0), 1.0),
    )
    few = Sweeping((0.0, 0.0), (0.0, 0.0), 50_000.0, (Swath(-0.1, 0.1, 0.0, 0.0),))
    area_m2, worth = most_found(ground, Importance(patches), [few])
    assert area_m2 == pytest.approx(10_000.0)
    assert worth == pytest.approx(10_000.0 * 5.0)
    whole = Sweeping((0.0, 0.0), (0.0, 0.0), math.inf, (CAMERA,))
    assert most_found(ground, Importance(patches), [whole])[1] == pytest.approx(2 * 4e4 + 3 * 4e4 + 1e4)
    point = ImportancePoint("p", (500.0, 500.0), 50.0, 0.01)
    assert most_found(ground, Importance(points=(point,)), [whole])[1] == pytest.approx(point.total, rel=0.03)
    raster = ImportanceRaster("r", np.arange(16.0).reshape(4, 4), 0.0, 0.0, 250.0)
    assert most_found(ground, Importance(raster=raster), [whole])[1] == pytest.approx(120.0 * 250.0**2)


@pytest.mark.parametrize("swath", [CAMERA, STRIP])
def test_no_flight_sweeps_more(swath: Swath) -> None:
    """A hundred random flights of straight passes see less, and nothing beyond their reach."""
    rng = np.random.default_rng(9)
    for _ in range(100):
        corners = np.cumsum(rng.normal(0.0, 400.0, (8, 2)), axis=0)
        seen = []
        for start, end in pairwise(corners):
            long_m = math.dist(start, end)
            along = (end - start) / long_m
            aside = np.array([-along[1], along[0]])
            first, last = start + swath.run_in_m * along, end - swath.run_out_m * along
            if swath.run_in_m + swath.run_out_m >= long_m:
                continue
            edges = [at + off * aside for at, off in (
                (first, swath.right_m), (last, swath.right_m), (last, swath.left_m), (first, swath.left_m)
            )]  # fmt: skip
            seen.append(shapely.Polygon(edges))
        ground = shapely.union_all(seen)
        flight = Sweeping(tuple(corners[0]), tuple(corners[-1]), LineString(corners).length, (swath,))
        assert ground.area <= flight.area_m2
        within = flight.within()
        assert within is not None
        assert within.covers(ground)
