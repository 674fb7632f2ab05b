"""The bound where passes are shared: below plans made by hand that share passes and see regions in parts."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from benchmarks.bound import scenario_document
from planner.bounds.allowance import Allowance
from planner.dubins.kernels import dubins_length
from planner.geojson import read_scenario
from planner.scenario import Scenario
from planner.sensors.sar import SarSensor
from planner.vehicle.model import FlightModel
from tests.planner.stages import plan_bound_m

Floats = NDArray[np.float64]

#: Changes tried on a plan made by hand.
TRIED = 1500


@dataclass(frozen=True)
class Pass:
    """A line, flown at a heading, with the sensor on: where in its own axes it lies, begins and ends."""

    heading_rad: float
    aside_m: float
    begin_m: float
    end_m: float

    def pose(self, along_m: float) -> tuple[float, float, float]:
        cos, sin = math.cos(self.heading_rad), math.sin(self.heading_rad)
        return cos * along_m - sin * self.aside_m, sin * along_m + cos * self.aside_m, self.heading_rad

    def seen(self, sensor: SarSensor, height_m: float, side: float) -> Polygon:
        """What it sees, by the sensor's angles alone."""
        near_m, far_m = (
            height_m * math.tan(sensor.incidence_rad + half)
            for half in (-0.5 * sensor.elevation_beamwidth_rad, 0.5 * sensor.elevation_beamwidth_rad)
        )
        half_m = 0.5 * sensor.aperture_m(height_m)
        begin_m, end_m = self.begin_m + half_m, self.end_m - half_m
        at = [(begin_m, near_m), (end_m, near_m), (end_m, far_m), (begin_m, far_m)]
        cos, sin = math.cos(self.heading_rad), math.sin(self.heading_rad)
        return Polygon(
            [
                (cos * x - sin * (self.aside_m + side * y), sin * x + cos * (self.aside_m + side * y))
                for x, y in at
            ]
        )


def length_m(passes: Sequence[Pass], scenario: Scenario, radius_m: float) -> float:
    """Of the shortest tour in any order, each pass flown as it is; headings at start and end are free."""
    best_m = math.inf
    free = np.arange(24) * (math.tau / 24.0)
    for order in itertools.permutations(passes):
        total = sum(p.end_m - p.begin_m for p in order)
        first, last = order[0].pose(order[0].begin_m), order[-1].pose(order[-1].end_m)
        total += min(dubins_length(*scenario.start.position, a, *first, radius_m) for a in free)
        total += min(dubins_length(*last, *scenario.end.position, a, radius_m) for a in free)
        for one, other in itertools.pairwise(order):
            total += dubins_length(*one.pose(one.end_m), *other.pose(other.begin_m), radius_m)
        best_m = min(best_m, total)
    return best_m


def by_hand(scenario: Scenario, radius_m: float, count: int, rng: np.random.Generator) -> float:
    """The shortest found of so many passes that together see everything, whatever each of them sees."""
    sensor = scenario.sensors[0]
    assert isinstance(sensor, SarSensor)
    height_m = scenario.height_m
    side = 1.0 if sensor.looks[0] == "left" else -1.0
    asked = shapely.union_all([region.area for region in scenario.regions])
    shapely.prepare(asked)
    middle = asked.centroid
    span_m = 2.0 * shapely.minimum_bounding_radius(asked) + sensor.aperture_m(height_m)
    mean_m = height_m * math.tan(sensor.incidence_rad)

    def all_seen(passes: Sequence[Pass]) -> bool:
        seen = shapely.union_all([p.seen(sensor, height_m, side) for p in passes])
        return bool(seen.buffer(1e-6).covers(asked))

    def begun() -> list[Pass]:
        heading = float(rng.uniform(0.0, math.tau))
        out = []
        for k in range(count):
            # Side by side, or one after the other at a heading of its own.
            turned = heading + (math.pi if k % 2 else 0.0) + float(rng.choice([0.0, rng.normal(0.0, 0.5)]))
            cos, sin = math.cos(turned), math.sin(turned)
            along, aside = cos * middle.x + sin * middle.y, cos * middle.y - sin * middle.x
            aside += float(rng.uniform(-0.5, 0.5)) * span_m - side * mean_m
            out.append(Pass(turned, aside, along - 0.6 * span_m, along + 0.6 * span_m))
        return out

    plan = next((p for p in (begun() for _ in range(TRIED)) if all_seen(p)), None)
    if plan is None:
        return math.inf
    best_m = length_m(plan, scenario, radius_m)
    for _ in range(TRIED):
        scale = float(10.0 ** rng.uniform(-2.5, -0.3))
        k, moved = int(rng.integers(count)), rng.normal(0.0, scale, 4)
        changed = plan[k]
        changed = Pass(
            changed.heading_rad + float(moved[0] * rng.integers(2)),
            changed.aside_m + float(moved[1] * rng.integers(2)) * span_m,
            changed.begin_m + float(abs(moved[2]) * rng.choice([-0.2, 0.0, 1.0])) * span_m,
            changed.end_m - float(abs(moved[3]) * rng.choice([-0.2, 0.0, 1.0])) * span_m,
        )
        if changed.end_m - changed.begin_m < sensor.aperture_m(height_m):
            continue
        trial = [*plan[:k], changed, *plan[k + 1 :]]
        if all_seen(trial):
            found_m = length_m(trial, scenario, radius_m)
            if found_m < best_m:
                plan, best_m = trial, found_m
    return best_m


@pytest.mark.parametrize("seed", range(3))
def test_no_plan_made_by_hand_is_shorter(seed: int) -> None:
    """Clusters seen by up to three passes of any headings, regions in parts, too: none is below the bound."""
    scenario = read_scenario(scenario_document("clusters", seed))
    rng = np.random.default_rng(seed)
    model = FlightModel.of(scenario.aircraft[0], scenario.wind)
    known_m = min(by_hand(scenario, model.turn_radius_m, count, rng) for count in (1, 2, 3))
    assert math.isfinite(known_m)
    bound_m = plan_bound_m(scenario, 1.5 * known_m, allowance=Allowance(2e6))
    assert 0.3 * known_m < bound_m <= known_m + 1e-6
