"""What order of lanes and division of regions save: prints the figures of docs/coverage.md."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from shapely.geometry import LineString, Polygon, box

from planner.airspace.surroundings import Surroundings
from planner.coverage.merge import split_region
from planner.coverage.strips.options import Options, make_options
from planner.coverage.strips.sweeps import Side, sweeps
from planner.coverage.strips.targets import targets
from planner.dubins.estimate_kernels import transit_costs
from planner.orders_kernels import best_orders
from planner.sensors.sar import SarSensor
from planner.wishes import Region

HEIGHT_M = 500.0
HEADINGS_RAD = np.radians(np.arange(0.0, 360.0, 5.0))
ETAS = np.array([0.0, 0.5, 1.0])


def around(radius_m: float) -> Surroundings:
    none = np.empty((0, 3))
    return Surroundings(None, None, none, none, (), radius_m, 0.0)


def swept(sides: tuple[Side, ...], radius_m: float, headings_rad: np.ndarray = HEADINGS_RAD) -> Options:
    """Ways to see a region undivided."""
    options = make_options(sides, headings_rad, ETAS, around(radius_m))
    assert options is not None
    return options


def tour_m(options: list[Options], radius_m: float) -> float:
    """The shortest line through all stops, exact over order, headings and offsets given."""
    entries, exits, inner_m = (
        np.concatenate([getattr(each, name) for each in options]) for name in ("entries", "exits", "inner_m")
    )
    offsets = np.cumsum([0, *(len(each.inner_m) for each in options)]).astype(np.int64)
    between = transit_costs(exits, entries, radius_m, np.empty((0, 3))) + inner_m
    costs, _ = best_orders(inner_m, between, np.zeros(len(inner_m)), offsets)
    return float(costs.min())


def main() -> None:
    one = SarSensor("sar", math.radians(45.0), math.radians(30.0), math.radians(10.0), ("right",))
    both = replace(one, looks=("right", "left"))
    (wide,) = split_region(Region("wide", box(0, 0, 2600, 6 * one.swath_m(HEIGHT_M) - 200)))
    for radius_m in (60.0, 330.0):
        length_m = tour_m([swept(sweeps(wide, both, HEIGHT_M), radius_m, np.array([0.0, math.pi]))], radius_m)
        print(f"six lanes, turn radius {radius_m:.0f} m: {length_m / 1000:.1f} km")
    arms = Polygon([(0, 0), (5600, 0), (5600, 550), (550, 550), (550, 4600), (0, 4600)])
    axis = LineString([(0, 0), (3600, 500), (4600, 3000), (7500, 3400)])
    corridor = axis.buffer(130.0, cap_style="flat")
    assert isinstance(corridor, Polygon)
    for region, radius_m in ((Region("L", arms), 120.0), (Region("corridor", corridor, axis=axis), 150.0)):
        (part,) = split_region(region)
        whole_m = tour_m([swept(sweeps(part, one, HEIGHT_M), radius_m)], radius_m)
        found = targets(part, one, HEIGHT_M, around(radius_m))
        stops = [stop.coarse(math.radians(5.0), ETAS) for stop in found]
        print(f"{region.name}: whole {whole_m / 1000:.1f} km, in {len(stops)} parts "
              f"{tour_m(stops, radius_m) / 1000:.1f} km")  # fmt: skip


if __name__ == "__main__":
    main()
