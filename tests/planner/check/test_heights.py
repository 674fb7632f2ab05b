"""What of a line lies between heights, against a line cut finely; heights between collects."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from planner.check import judge
from planner.check.heights import between
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.wishes import Band
from tests.planner.scenarios import small

LINE = np.array([(0.0, 0.0), (100.0, 0.0), (200.0, 0.0), (300.0, 0.0)])
HEIGHTS = np.array([0.0, 60.0, 60.0, 20.0])


@pytest.mark.parametrize(
    "band", [(-math.inf, math.inf), (-10.0, 60.0), (30.0, 50.0), (60.0, 90.0), (61.0, 90.0), (-9.0, -1.0)]
)
def test_the_part_between_two_heights(band: tuple[float, float]) -> None:
    """As long as the places, a centimetre apart, whose height lies between them."""
    along = np.linspace(0.0, 300.0, 30001)
    inside = np.interp(along, LINE[:, 0], HEIGHTS)
    expected = ((inside >= band[0]) & (inside <= band[1])).mean() * 300.0
    found = between(LINE, HEIGHTS, *band)
    assert found.length == pytest.approx(expected, abs=0.03)
    assert found.is_empty == (expected == 0.0)


@pytest.mark.parametrize(
    ("off_m", "band", "told"),
    [
        (20.0, None, True),
        (-20.0, None, True),
        (20.0, Band(None, 330.0), False),
        (20.0, Band(None, 310.0), True),
        (-20.0, Band(270.0, None), False),
        (-20.0, Band(None, 330.0), True),
    ],
)
def test_a_leg_at_a_height_that_is_not_left_open_is_told_of(
    off_m: float, band: Band | None, told: bool
) -> None:
    """Between two collects, at 300 m over the ground, one vertex higher or lower."""
    scenario = read_scenario(small(altitude_m=300.0))
    plan = make_plan(scenario)
    (path,) = plan.paths
    one, other = sorted(plan.collects, key=lambda each: each.start_m)[:2]
    line_m = scenario.frame.to_local([place[:2] for place in path.line])
    ends_m = scenario.frame.to_local([one.line[1][:2], other.line[0][:2]])
    middle_m = ends_m.mean(axis=0)
    nearest = int(np.argmin(np.hypot(*(line_m - middle_m).T)))
    lon, lat, up_m = path.line[nearest]
    line = (*path.line[:nearest], (lon, lat, up_m + off_m), *path.line[nearest + 1 :])
    bent = replace(plan, paths=(replace(path, line=line),))
    found = judge(replace(scenario, band=band), bent).violations
    assert up_m == pytest.approx(300.0)
    assert ("transit-height" in {each.constraint for each in found}) == told
