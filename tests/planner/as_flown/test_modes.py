"""As flown in the wind and in spotlight: by where the nose pointed, and by the dwell on the target."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from shapely.geometry import Polygon

from planner.as_flown.coverage import FlownCoverage
from planner.as_flown.track import TrackSample
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from planner.tasks.flown import flown_coverage
from tests.planner.scenarios import feature, small
from tests.planner.terrains import raster


@lru_cache
def planned(kind: str) -> tuple[Scenario, Plan]:
    """A crosswind plan with a fixed antenna, or a target seen in spotlight, squinted or on terrain."""
    document = small()
    terrains = {}
    if kind == "wind":
        document["wind"] = {"speed_m_s": 8.0, "from_deg": 20.0}
    else:
        document["features"][:2] = [feature("T", "roi", "Point", [0.01, 0.01], radius_m=15.0)]
        document["sensors"][0].update(mode="spotlight", resolution_m=0.05, wavelength_m=0.031, squint_deg=0.0)
        if kind == "squinted spot":
            document["sensors"][0]["squint_deg"] = 12.0
        if kind == "spot on terrain":
            document.update(terrain="t", clearance_m=10.0)
            slope = raster(lambda e, n: 100.0 + 0.02 * e, LocalFrame(0.0125, 0.01), posts=401)
            terrains["t"] = slope
    scenario = read_scenario(document, terrains)
    return scenario, make_plan(scenario)


def flown(
    kind: str,
    change: Callable[[TrackSample], TrackSample] = lambda s: s,
    *,
    part: tuple[float, float] = (0.0, 1.0),
    aside_m: float = 0.0,
    nose_deg: float | None = None,
) -> FlownCoverage:
    """The plan flown exactly but for ``change``, the part of each pass, a shift aside, and the nose."""
    scenario, plan = planned(kind)
    samples: list[TrackSample] = []
    for collect in plan.collects:
        first, last = scenario.frame.to_local([p[:2] for p in collect.line])
        ahead = (last - first) / np.hypot(*(last - first))
        line = [first + share * (last - first) + aside_m * np.array([ahead[1], -ahead[0]]) for share in part]
        height_m = collect.line[0][2] - (scenario.home_amsl_m or 0.0)
        heading_deg = None if nose_deg is None else collect.heading_deg + nose_deg
        for lon, lat in scenario.frame.to_wgs84(np.linspace(*line, 200)):
            samples.append(
                change(TrackSample(float(len(samples)), lon, lat, height_m, 0.0, True, heading_deg))
            )
        samples.append(replace(samples[-1], sensor_on=False))
    return flown_coverage(scenario, plan, samples)


def test_in_the_wind_flown_as_planned_all_is_seen() -> None:
    """Where no heading was recorded the nose is where the wind has it: the plan's footprints."""
    found = flown("wind")
    assert all(fraction > 0.99999 for fraction in found.fraction.values())


def test_the_nose_as_recorded_goes_before_the_wind() -> None:
    """A nose along the course, in a plan for a crosswind, looks elsewhere; the crab as recorded sees all."""
    scenario, plan = planned("wind")
    assert min(flown("wind", nose_deg=0.0).fraction.values()) < 0.995
    samples_nose: dict[float, float] = {}
    for collect in plan.collects:
        course = math.radians(90.0 - collect.heading_deg)
        delta = course - scenario.frame.turned_rad - scenario.wind.toward_rad
        samples_nose[collect.heading_deg] = -math.degrees(math.asin(math.sin(delta) * 8.0 / 20.0))

    def crabbing(sample: TrackSample) -> TrackSample:
        assert sample.heading_deg is not None
        return replace(sample, heading_deg=sample.heading_deg + samples_nose[sample.heading_deg])

    assert min(flown("wind", crabbing, nose_deg=0.0).fraction.values()) > 0.9999


@pytest.mark.parametrize("kind", ["spot", "squinted spot", "spot on terrain"])
def test_a_spot_flown_as_planned_is_seen(kind: str) -> None:
    """The whole line turns as far as the resolution asks: the target is seen, the planned spot at that."""
    scenario, plan = planned(kind)
    found = flown(kind)
    assert found.fraction["T"] > 0.9999
    if kind == "spot":
        print_ = Polygon(scenario.frame.to_local(plan.footprints[0].ring))
        assert print_.buffer(0.1).covers(found.seen["T"])


@pytest.mark.parametrize("kind", ["spot", "squinted spot", "spot on terrain"])
@pytest.mark.parametrize("part", [(0.0, 0.6), (0.4, 1.0), (0.25, 0.75)])
def test_a_spot_left_early_is_not_seen(kind: str, part: tuple[float, float]) -> None:
    """With part of the line missing the line of sight turns less than the resolution asks."""
    assert flown(kind, part=part).fraction["T"] == 0.0


def test_a_longer_line_sees_the_spot_as_well() -> None:
    """Stripmap would see more ground of a longer line; of a spot it is the same."""
    assert flown("spot", part=(-0.2, 1.2)).fraction["T"] > 0.9999


@pytest.mark.parametrize(("aside_m", "roll_deg"), [(400.0, 0.0), (-400.0, 0.0), (0.0, 20.0), (0.0, -20.0)])
def test_a_spot_out_of_the_beam_is_not_seen(aside_m: float, roll_deg: float) -> None:
    """Beside its line, or banked, the elevation beam misses the target however long the flight."""
    found = flown("spot", lambda s: replace(s, roll_deg=roll_deg), aside_m=aside_m, part=(-0.5, 1.5))
    assert found.fraction["T"] < 0.5


def test_bank_in_the_middle_ends_the_dwell() -> None:
    """Banked away for a moment half-way, neither half of the line is long enough."""
    count = iter(range(10_000))
    found = flown("spot", lambda s: replace(s, roll_deg=25.0 if 95 <= next(count) <= 105 else 0.0))
    assert found.fraction["T"] == 0.0
