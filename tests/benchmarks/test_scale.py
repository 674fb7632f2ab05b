"""The scenarios of many regions are what their figures are said to be of."""

from __future__ import annotations

import math

from benchmarks.scale import WIDE_HEIGHT_M, wide_document
from planner.geojson import read_scenario


def test_wide_regions_are_a_thousand_square_kilometres_of_two_hundred_strips() -> None:
    """Squares of no fewer than twenty swaths across, whichever way they are flown."""
    scenario = read_scenario(wide_document())
    areas = [region.area for region in scenario.regions]
    assert 1e9 < sum(area.area for area in areas) < 1.01e9
    swath_m = WIDE_HEIGHT_M * (math.tan(math.radians(60.0)) - math.tan(math.radians(30.0)))
    strips = [math.ceil(min(math.sqrt(area.area), area.length / 4.0) / swath_m) for area in areas]
    assert sum(strips) == 200
    assert all(one.distance(other) > swath_m for one in areas for other in areas if one is not other)
