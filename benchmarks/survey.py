"""Camera surveys: ours beside what other programs make of them, and every photo of random ones looked at.

Parts, each with rows of its own:

``fields``
    Three fields of the kind of Fields2Cover's own (convex, L, U; swaths 40 m apart, turns of 30 m) by ours
    and by its method in both of its orders, from the first swath to the last; swaths and turns apart.
``items``
    Random polygons as survey items of QGroundControl: at the item's heading and spacing, and with the heading
    free; its lines alone, and with the 10 m that it flies on beyond each for a multirotor; ours with overlaps
    kept up to the edges, and there as such items leave them.
``convex``
    Random convex regions: metres from the first lane to the last over area / spacing and the least turns,
    and what of the rest is longer lanes, and slanted edges that turns go along; and over what no order of
    lanes comes below, see ``survey_bound``.
``photos``
    Random regions in winds up to 60 % of the speed: how often each place of a grid of 1 m is seen, by how
    many lanes, and what neighbouring photos share at least; by a geometry of the benchmark's own.
``overlap``
    Random surveys through ``make_plan``, see ``survey_overlap``: overlaps reached over what is asked for.
``scale``
    40 km² at 3 cm a pixel with 24 megapixels, through ``make_plan``.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.affinity import rotate
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from benchmarks.photos import photos, places, seen_by
from benchmarks.survey_baselines import (
    QGC_TURNAROUND_M,
    fields2cover,
    flown_m,
    qgc_item_m,
    qgc_transects,
    with_turnaround,
)
from benchmarks.survey_bound import least_order_m
from benchmarks.survey_overlap import overlap
from benchmarks.survey_scale import scale
from benchmarks.survey_shapes import random_convex, random_star
from planner.airspace.surroundings import Surroundings
from planner.airspace.values import Wind
from planner.coverage.merge import split_region
from planner.coverage.survey.family import Surveys
from planner.coverage.survey.targets import LaneTarget
from planner.dubins.estimate_kernels import transit_costs
from planner.dubins.kernels import dubins_lengths
from planner.orders_kernels import best_orders
from planner.progress import never
from planner.route import CollectPass
from planner.sensors.camera import CameraSensor
from planner.sensors.optics import Optics
from planner.wishes import Region

Floats = NDArray[np.float64]
Row = dict[str, Any]

HEIGHT_M = 100.0
#: Less than this is all of an area.
LEAST_M2 = 1.0
NOTHING = np.empty((0, 3))
PARTS = ("fields", "items", "convex", "photos", "overlap", "scale")
#: Total lengths published by Fields2Cover for its own fields, which are not published themselves.
PUBLISHED_M = {"convex": 23_937, "L": 23_449, "U": 25_774}
FIELDS = {
    "convex": Polygon([(0, 0), (820, -60), (1010, 420), (760, 900), (150, 860), (-80, 380)]),
    "L": Polygon([(0, 0), (1130, 0), (1130, 410), (450, 410), (450, 1130), (0, 1130)]),
    "U": Polygon([(0, 0), (1150, 0), (1150, 880), (790, 880), (790, 350), (350, 350), (350, 880), (0, 880)]),
}
CONVEX_RADII_M = (10.0, 20.0, 30.0, 60.0)
FIELD_SPACING_M, FIELD_RADIUS_M, FIELD_TURNED_DEG = 40.0, 30.0, 17.0


def camera_for(spacing_m: float, side: float = 0.65, forward: float = 0.75) -> CameraSensor:
    """A camera of 3 : 2 that has lanes a spacing apart from ``HEIGHT_M``."""
    focal_m, columns = 0.02, 6000
    wide_m = spacing_m / (1.0 - side) / HEIGHT_M * focal_m
    return CameraSensor("eye", Optics(focal_m, wide_m / columns, columns, columns * 2 // 3), forward, side)


def surveyed(
    area: Polygon, camera: CameraSensor, radius_m: float, approach_rad: tuple[float, ...] | None = None
) -> tuple[CollectPass, ...]:
    """Passes that see a region alone on open ground, the shortest from the first to the last."""
    (region,) = split_region(Region("R", area, approach_rad=approach_rad))
    around = Surroundings(None, None, NOTHING, NOTHING, (), radius_m, 0.0)
    targets = Surveys().targets(region, camera, HEIGHT_M, around, wide=True, division="auto", enough=never)
    options = [target.coarse(math.radians(10.0), np.array([0.0, 0.5, 1.0])) for target in targets]
    order, picked, cost_m = _shortest(options, radius_m)
    step_rad, step_eta = math.radians(5.0), 0.25
    for _ in range(5):
        near = [targets[k].near(one, step_rad, step_eta) for k, one in zip(order, picked, strict=True)]
        moved, better, better_m = _shortest(near, radius_m)
        if better_m < cost_m:
            order, picked, cost_m = [order[k] for k in moved], better, better_m
        step_rad, step_eta = step_rad / 2.0, step_eta / 2.0
    return tuple(one for k, row in zip(order, picked, strict=True) for one in _passes(targets[k], row))


def _passes(target: LaneTarget, row: Any) -> tuple[CollectPass, ...]:
    return target.passes(row, 0)


def _shortest(options: Sequence[Any], radius_m: float) -> tuple[list[int], list[Any], float]:
    """The cheapest tour of one option of each: which in order, the options, and the cost."""
    entries, exits, inner_m = (
        np.concatenate([getattr(each, name) for each in options]) for name in ("entries", "exits", "inner_m")
    )
    offsets = np.cumsum([0, *(len(each.inner_m) for each in options)]).astype(np.int64)
    between = transit_costs(exits, entries, radius_m, np.empty((0, 9))) + inner_m
    costs, orders = best_orders(inner_m, between, np.zeros(len(inner_m)), offsets)
    found = orders[int(np.argmin(costs))].tolist()
    order = [int(np.searchsorted(offsets, option, side="right")) - 1 for option in found]
    rows = zip(found, order, strict=True)
    picked = [options[k].rows(np.array([option - offsets[k]])) for option, k in rows]
    return order, picked, float(costs.min())


def lines_of(passes: Sequence[CollectPass]) -> Floats:
    """Their lines, (N, 2, 2)."""
    return np.array([[one.start, one.end] for one in passes])


def fields() -> Iterator[Row]:
    """See the module."""
    camera = camera_for(FIELD_SPACING_M)
    for name, drawn in FIELDS.items():
        area = rotate(drawn, FIELD_TURNED_DEG)
        head = {"bench": "survey-field", "field": name, "area_m2": round(area.area)}
        for order, (count, swaths_m, turns_m) in fields2cover(area, FIELD_SPACING_M, FIELD_RADIUS_M).items():
            yield head | _measured(f"fields2cover {order}", count, swaths_m, turns_m, PUBLISHED_M[name])
        began = time.perf_counter()
        lines = lines_of(surveyed(area, camera, FIELD_RADIUS_M))
        took_s = time.perf_counter() - began
        row = _measured("ours", len(lines), *flown_m(lines, FIELD_RADIUS_M), PUBLISHED_M[name])
        yield head | row | {"planning_s": round(took_s, 3)}


def _measured(planner: str, count: int, lanes_m: float, turns_m: float, published_m: int) -> Row:
    return {
        "planner": planner,
        "lanes": count,
        "lanes_m": round(lanes_m),
        "turns_m": round(turns_m),
        "total_m": round(lanes_m + turns_m),
        "published_m": published_m,
    }


def items(count: int, seed: int) -> Iterator[Row]:
    """See the module."""
    for edge_overlap in (True, False):
        told = {"same": _Items(), "free": _Items()}
        for k in range(count):
            rng = np.random.default_rng([seed, k])
            spacing_m, radius_m = float(rng.uniform(20.0, 60.0)), 5.0
            side = float(rng.choice([0.6, 0.65, 0.7, 0.75]))
            area = (random_convex, random_star)[k % 2](rng, float(rng.uniform(8.0, 30.0) * spacing_m) ** 2)
            azimuth_deg = float(rng.uniform(-90.0, 90.0))
            transects = qgc_transects(area, azimuth_deg, spacing_m)
            camera = replace(camera_for(spacing_m, side), edge_overlap=edge_overlap)
            along_rad = math.radians(90.0 - azimuth_deg)
            for name, approach_rad in (("same", (along_rad, along_rad + math.pi)), ("free", None)):
                passes = surveyed(area, camera, radius_m, approach_rad)
                told[name].add(passes, transects, along_rad, radius_m)
                told[name].missed_m2.append(area.difference(seen_from(transects, camera)).area)
        for name, of in told.items():
            yield {
                "bench": "survey-items",
                "heading": "the item's" if name == "same" else "free",
                "edge_overlap": edge_overlap,
                "items": count,
            } | of.row(lanes=name == "same")


def seen_from(lines: Sequence[Floats], camera: CameraSensor) -> BaseGeometry:
    """Ground in some photo of those taken all along lines, (2, 2) each, in still air."""
    beside_m = camera.swath_m(HEIGHT_M) / 2.0
    ahead_m = HEIGHT_M * math.tan(camera.optics.half_height_rad)
    return shapely.union_all([_strip(line, ahead_m, beside_m) for line in lines])


def _strip(line: Floats, ahead_m: float, beside_m: float) -> Polygon:
    ahead = (line[1] - line[0]) / np.hypot(*(line[1] - line[0]))
    left = np.array([-ahead[1], ahead[0]])
    first, last = line[0] - ahead_m * ahead, line[1] + ahead_m * ahead
    right, left = -beside_m * left, beside_m * left
    return Polygon([first + right, last + right, last + left, first + left])


@dataclass(slots=True)
class _Items:
    """Lengths of ours over those of items, also with these flown on for a multirotor, and lanes."""

    ratios: list[float] = field(default_factory=list)
    whole: list[float] = field(default_factory=list)
    lanes: list[int] = field(default_factory=list)
    missed_m2: list[float] = field(default_factory=list)

    def add(
        self, passes: Sequence[CollectPass], transects: list[Floats], along_rad: float, radius_m: float
    ) -> None:
        """One more."""
        ours_m = math.fsum(flown_m(lines_of(passes), radius_m))
        self.ratios.append(ours_m / math.fsum(qgc_item_m(transects, radius_m)))
        flown = with_turnaround(transects, QGC_TURNAROUND_M)
        self.whole.append(ours_m / math.fsum(qgc_item_m(flown, radius_m)))
        count = len({round(float(np.dot(one.start, _left(along_rad))), 3) for one in passes})
        self.lanes.append(count - len(transects))

    def row(self, *, lanes: bool) -> Row:
        """What is told of all."""
        longer = [k for k, ratio in enumerate(self.ratios) if ratio > 1.0]
        told: Row = {
            "mean_ratio": round(float(np.mean(self.ratios)), 4),
            "worst_ratio": round(max(self.ratios), 4),
            "longer": len(longer),
            "longer_where_the_item_sees_all": sum(self.missed_m2[k] < LEAST_M2 for k in longer),
            "mean_ratio_with_its_turnaround": round(float(np.mean(self.whole)), 4),
            "longer_than_with_it": sum(ratio > 1.0 for ratio in self.whole),
        }
        if lanes:
            told |= {
                "lanes_same": self.lanes.count(0),
                "lanes_fewer": sum(more < 0 for more in self.lanes),
                "lanes_more": sum(more > 0 for more in self.lanes),
            }
        return told


def _left(angle_rad: float) -> Floats:
    return np.array([-math.sin(angle_rad), math.cos(angle_rad)])


def convex(count: int, seed: int) -> Iterator[Row]:
    """See the module."""
    for edge_overlap, radius_m in itertools.product((True, False), CONVEX_RADII_M):
        over, lanes_over, slants_over, order_over, bounds_over = [], [], [], [], []
        camera = replace(camera_for(40.0), edge_overlap=edge_overlap)
        for k in range(count):
            rng = np.random.default_rng([seed, k])
            area = random_convex(rng, (float(rng.uniform(8.0, 40.0)) * 40.0) ** 2)
            lines = lines_of(surveyed(area, camera, radius_m))
            least_m = area.area / 40.0 + (len(lines) - 1) * least_turn_m(40.0, radius_m)
            lanes_m, turns_m = flown_m(lines, radius_m)
            over.append((lanes_m + turns_m) / least_m)
            lanes_over.append((lanes_m - area.area / 40.0) / least_m)
            slants_over.append(slants_m(lines) / least_m)
            bound_m = least_order_m(area, camera, HEIGHT_M, radius_m)
            order_over.append((lanes_m + turns_m) / bound_m)
            bounds_over.append(bound_m / least_m)
        yield {
            "bench": "survey-convex",
            "radius_m": radius_m,
            "edge_overlap": edge_overlap,
            "regions": count,
            "mean_over_bound": round(float(np.mean(over)), 4),
            "worst_over_bound": round(max(over), 4),
            "past_3_percent": sum(each > 1.03 for each in over),
            "of_that_lanes": round(float(np.mean(lanes_over)), 4),
            "of_that_slants": round(float(np.mean(slants_over)), 4),
            "mean_over_least_order": round(float(np.mean(order_over)), 4),
            "worst_over_least_order": round(max(order_over), 4),
            "least_orders_past_3_percent": sum(each > 1.03 for each in bounds_over),
        }


def slants_m(lines: Floats) -> float:
    """How far along them lanes begin before or behind the ends of those flown before: of slanted edges."""
    ahead = (lines[0, 1] - lines[0, 0]) / np.hypot(*(lines[0, 1] - lines[0, 0]))
    return float(np.abs((lines[1:, 0] - lines[:-1, 1]) @ ahead).sum())


def least_turn_m(spacing_m: float, radius_m: float) -> float:
    """The shortest Dubins turn from a lane into one flown the other way, next to it or so many lanes on."""
    away_m = spacing_m * np.arange(1.0, 2.0 + math.ceil(2.0 * radius_m / spacing_m))
    there = np.column_stack([np.zeros(len(away_m)), away_m, np.full(len(away_m), math.pi)])
    return float(dubins_lengths(np.zeros_like(there), there, radius_m).min())


def overlaps(count: int, seed: int, step_m: float = 1.0) -> Iterator[Row]:
    """See the module: ``photos``."""
    least = {"photos_of_a_lane": 99, "lanes": 99, "forward_kept": math.inf, "side_kept": math.inf}
    unseen = once = 0
    for k in range(count):
        rng = np.random.default_rng([seed, k])
        drift, toward_rad = float(rng.uniform(0.0, 0.6)), float(rng.uniform(0.0, math.tau))
        spacing_m, speed_m_s = float(rng.uniform(15.0, 40.0)), 15.0
        area = (random_convex, random_star)[k % 2](rng, float(rng.uniform(3.0, 10.0) * spacing_m) ** 2)
        camera = camera_for(spacing_m).in_wind(drift, toward_rad)
        passes = surveyed(area, camera, float(rng.uniform(5.0, 60.0)))
        taken = photos(passes, camera, HEIGHT_M, speed_m_s, Wind(drift * speed_m_s, toward_rad))
        seen = seen_by(taken, places(area, step_m))
        unseen += int((seen.max(axis=0) < 1).sum())
        once += int((seen.max(axis=0) < 2).sum())
        least["photos_of_a_lane"] = min(least["photos_of_a_lane"], int(seen.max(axis=0).min()))
        if len(passes) > 1:
            least["lanes"] = min(least["lanes"], int((seen > 0).sum(axis=0).min()))
        for one, other in itertools.pairwise(taken):
            if one.lane == other.lane:
                shared = one.ground.intersection(other.ground).area / one.ground.area
                least["forward_kept"] = min(least["forward_kept"], shared)
        least["side_kept"] = min(least["side_kept"], side_kept(passes, camera))
    yield {
        "bench": "survey-photos",
        "regions": count,
        "grid_m": step_m,
        "places_unseen": unseen,
        "places_in_one_photo": once,
    } | {f"least_{name}": round(value, 4) for name, value in least.items()}


def side_kept(passes: Sequence[CollectPass], camera: CameraSensor) -> float:
    """The least part of a lane's strip that the next parallel one sees again."""
    by_heading: dict[float, list[CollectPass]] = {}
    for one in passes:
        by_heading.setdefault(round(math.degrees(one.angle_rad) % 180.0, 3) % 180.0, []).append(one)
    least = math.inf
    for together in by_heading.values():
        left = _left(together[0].angle_rad)
        offsets_m = np.unique(np.round([float(np.dot(one.start, left)) for one in together], 3))
        width_m = 2.0 * min(
            camera.half_width_m(HEIGHT_M, one.angle_rad + turn) for one in together for turn in (0.0, math.pi)
        )
        if len(offsets_m) > 1:
            least = min(least, 1.0 - float(np.diff(offsets_m).max()) / width_m)
    return least


def run(
    parts: Sequence[str] = PARTS, count: int = 60, regions: int = 300, grid_m: float = 1.0, seed: int = 1
) -> Iterator[Row]:
    """Rows of the parts asked for.

    Parameters
    ----------
    count
        Items, and convex regions.
    regions, grid_m
        Whose photos are looked at, and on which grid.
    """
    asked: dict[str, Callable[[], Iterator[Row]]] = {
        "fields": fields,
        "items": lambda: items(count, seed),
        "convex": lambda: convex(count, seed),
        "photos": lambda: overlaps(regions, seed, grid_m),
        "overlap": lambda: overlap(regions, seed, grid_m),
        "scale": scale,
    }
    for part in (parts,) if isinstance(parts, str) else parts:
        yield from asked[part]()
