"""Random scenarios of every kind: the gap of their plans, and other plans that must not be below the bound.

Kinds are points, corridors, fields (each seen in one pass, as a rule), wide regions, clusters of small ones
side by side, bent ones (L and U), and a mixture. Rows of ``bench: bound`` are scenarios; ``least_m`` is the
shortest plan known of each, by whatever method, heading, merging or division of its regions.
"""

from __future__ import annotations

import itertools
import json
import math
import statistics
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry import Polygon

from planner.errors import PlannerError
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.pipeline import make_plan, with_bound
from planner.warm import warm_up

KINDS = ("points", "corridors", "fields", "wide", "clusters", "bent", "mixed")
METHODS: tuple[dict[str, str], ...] = ({"routing": "li2018"}, {"coverage": "li2018", "routing": "joint"})
FRAME = LocalFrame(8.5, 47.0)

Feature = dict[str, Any]


def scenario_document(kind: str, seed: int) -> dict[str, Any]:
    """A scenario of a kind; the same for the same seed."""
    rng = np.random.default_rng([KINDS.index(kind), seed])
    height_m = float(rng.choice([300.0, 500.0, 1000.0, 2000.0]))
    swath_m = height_m * (math.tan(math.radians(60.0)) - math.tan(math.radians(30.0)))
    radius_m = float(rng.uniform(0.1, 0.6)) * swath_m
    side_m = float(rng.uniform(6.0, 16.0)) * swath_m
    sensor = {
        "name": "sar", "type": "sar", "incidence_deg": 45, "elevation_beamwidth_deg": 30,
        "azimuth_beamwidth_deg": 10, "look": str(rng.choice(["left", "right", "both"])),
    }  # fmt: skip
    start = rng.uniform(-0.5, 0.5, 2) * side_m
    features = [_point("start", "start", start)]
    if rng.random() < 0.4:
        features.append(_point("end", "end", rng.uniform(-0.5, 0.5, 2) * side_m))
    features += list(_regions(rng, kind, swath_m, side_m))
    return {
        "type": "FeatureCollection",
        "name": f"{kind}-{seed}",
        "features": features,
        "vehicles": [{"name": "uav", "airspeed_m_s": 30.0, "min_turn_radius_m": round(radius_m, 1)}],
        "sensors": [sensor],
        "altitude_m": height_m,
    }


def others(document: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """The same task put otherwise, so that a plan of it is one of the scenario: its name and document."""
    for method in METHODS:
        yield "+".join(method.values()), document | {"method": method}
    rois = [f for f in document["features"] if f["properties"]["role"] == "roi"]
    rest = [f for f in document["features"] if f["properties"]["role"] != "roi"]
    for heading_deg in (0.0, 60.0, 120.0):
        along = [heading_deg, heading_deg + 180.0]
        turned = [f | {"properties": f["properties"] | {"approach_deg": along}} for f in rois]
        yield f"along {heading_deg:g}", document | {"features": rest + turned}
    areas = _areas(document)
    if len(areas) > 1:
        hull = shapely.union_all(areas).convex_hull
        yield "one hull", document | {"features": [*rest, _polygon("hull", hull)]}
        nearest = min(
            ((a, b) for a in range(len(areas)) for b in range(a)),
            key=lambda p: areas[p[0]].distance(areas[p[1]]),
        )
        both = shapely.union_all([areas[k] for k in nearest]).convex_hull
        kept = [f for k, f in enumerate(rois) if k not in nearest]
        yield "nearest two", document | {"features": [*rest, *kept, _polygon("both", both)]}
    halves = [
        _polygon(f"{k} {m}", half) for k, area in enumerate(areas) for m, half in enumerate(_halves(area))
    ]
    yield "halved", document | {"features": rest + halves}


def run(
    seeds: Any = 3,
    kinds: Any = KINDS,
    compared: bool = False,
    first: int = 0,
    seconds: float = math.inf,
) -> Iterator[dict[str, Any]]:
    """One row a scenario, then one a kind, and the last of them all.

    Parameters
    ----------
    seeds, first
        How many scenarios of each kind, and the seed of the first.
    compared
        Whether plans of the same task put otherwise are made as well.
    seconds
        Of processor time: once they are over no scenario is begun. There is one of each kind before there are
        two of any, so that what is told then is of a sample, by ``scenarios``.
    """
    warm_up()
    end_s = time.process_time() + seconds
    each = [kinds] if isinstance(kinds, str) else list(kinds)
    rows: list[dict[str, Any]] = []
    for seed, kind in itertools.product(range(first, first + seeds), each):
        if rows and time.process_time() > end_s:
            break
        rows.append(_row(kind, seed, compared))
        yield rows[-1]
    yield from summaries(rows)


def summaries(rows: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """What rows say together, of each kind and of all."""
    for kind in dict.fromkeys(row["kind"] for row in rows):
        yield _together(kind, [row for row in rows if row["kind"] == kind])
    yield _together("all", rows)


def _together(kind: str, rows: list[dict[str, Any]]) -> dict[str, Any]:
    parts = [row["share_s"] / (row["planned_s"] + row["share_s"]) for row in rows]
    return {
        "bench": "bound",
        "kind": kind,
        "scenarios": len(rows),
        "gap": statistics.median(row["gap"] for row in rows),
        "most_gap": max(row["gap"] for row in rows),
        "gap_in_a_third": statistics.median(row["gap_in_a_third"] for row in rows),
        "most_in_a_third": max(row["gap_in_a_third"] for row in rows),
        "over_half": sum(row["gap"] > 0.5 for row in rows),
        "over_half_in_a_third": sum(row["gap_in_a_third"] > 0.5 for row in rows),
        "below_collection": sum(row["below_collection"] for row in rows),
        "are_bounds": all(row["is_a_bound"] for row in rows),
        "part_of_time": statistics.median(parts),
        "most_of_time": max(parts),
    }


def _row(kind: str, seed: int, compared: bool) -> dict[str, Any]:
    document = scenario_document(kind, seed)
    scenario = read_scenario(document)
    # Of the processor: what others take of the machine is neither planning nor bound.
    began_s = time.process_time()
    plan = make_plan(scenario, clock=time.process_time)
    planned_s = time.process_time() - began_s
    bounded = with_bound(scenario, plan, clock=time.process_time).metrics
    shared = with_bound(scenario, plan, clock=time.process_time, share=True).metrics
    lengths = {"auto": plan.metrics.length_m}
    for name, other in others(document) if compared else ():
        try:
            found = make_plan(read_scenario(other))
        except PlannerError:
            continue
        if not found.hard_violations and min(found.metrics.coverage.values()) > 0.99999:
            lengths[name] = found.metrics.length_m
    least = min(lengths, key=lambda name: lengths[name])
    assert bounded.lower_bound_m is not None
    return {
        "bench": "bound",
        "kind": kind,
        "seed": seed,
        "regions": len(scenario.regions),
        "length_m": lengths["auto"],
        "collection_m": plan.metrics.collection_length_m,
        "lower_bound_m": bounded.lower_bound_m,
        "gap": bounded.gap,
        "gap_in_a_third": shared.gap,
        "share_s": shared.planning_time_s["bound"],
        "below_collection": bounded.lower_bound_m < plan.metrics.collection_length_m,
        "least_m": lengths[least],
        "least_by": least,
        "is_a_bound": bounded.lower_bound_m <= lengths[least] + 1e-6,
        "planned_s": planned_s,
        "bound_s": bounded.planning_time_s["bound"],
    }


def _regions(rng: np.random.Generator, kind: str, swath_m: float, side_m: float) -> Iterator[Feature]:
    count = int(rng.integers(1, 9))
    if kind == "clusters":
        middle = rng.uniform(-0.5, 0.5, 2) * side_m
        size_m = float(rng.choice([0.0, rng.uniform(0.1, 0.7) * swath_m]))
        across_m = float(rng.uniform(0.5, 2.5)) * swath_m
        for k in range(int(rng.integers(3, 13))):
            at = middle + rng.uniform(-0.5, 0.5, 2) * across_m
            yield _point(f"R{k}", "roi", at) if size_m == 0.0 else _polygon(f"R{k}", _field(rng, at, size_m))
        return
    for k in range(count):
        at = rng.uniform(-0.5, 0.5, 2) * side_m
        which = str(rng.choice(KINDS[:4])) if kind == "mixed" else kind
        if which == "points":
            yield _point(f"R{k}", "roi", at)
        elif which == "corridors":
            yield _corridor(rng, f"R{k}", at, swath_m)
        elif which == "fields":
            yield _polygon(f"R{k}", _field(rng, at, float(rng.uniform(0.2, 1.3)) * swath_m))
        elif which == "wide" and k < 3:
            yield _polygon(f"R{k}", _field(rng, at, float(rng.uniform(1.5, 6.0)) * swath_m))
        elif which == "bent" and k < 2:
            yield _polygon(f"R{k}", _bent(rng, at, float(rng.uniform(1.5, 5.0)) * swath_m))


def _field(rng: np.random.Generator, at: Any, size_m: float) -> Polygon:
    angles = np.sort(rng.uniform(0.0, math.tau, int(rng.integers(5, 12))))
    angles = np.concatenate([angles, [0.0, math.tau / 3.0, 2.0 * math.tau / 3.0]])
    ring = np.stack([np.cos(angles), float(rng.uniform(0.3, 1.0)) * np.sin(angles)], axis=1)
    hull = shapely.MultiPoint(0.5 * size_m * ring).convex_hull
    return affinity.translate(affinity.rotate(hull, float(rng.uniform(0.0, 360.0))), *at)


def _bent(rng: np.random.Generator, at: Any, size_m: float) -> Polygon:
    thick = float(rng.uniform(0.25, 0.5))
    ring = [(0, 0), (1, 0), (1, thick), (thick, thick), (thick, 1), (0, 1)]
    if rng.random() < 0.5:
        ring = [
            (0, 0),
            (1.5, 0),
            (1.5, 1),
            (1.5 - thick, 1),
            (1.5 - thick, thick),
            (thick, thick),
            (thick, 1),
            (0, 1),
        ]
    whole = affinity.scale(Polygon(ring), size_m, size_m, origin=(0.0, 0.0))
    return affinity.translate(affinity.rotate(whole, float(rng.uniform(0.0, 360.0))), *at)


def _corridor(rng: np.random.Generator, name: str, at: Any, swath_m: float) -> Feature:
    heading, points = float(rng.uniform(0.0, math.tau)), [np.asarray(at, dtype=np.float64)]
    for _ in range(int(rng.integers(1, 5))):
        step_m = float(rng.uniform(1.0, 6.0)) * swath_m
        points.append(points[-1] + step_m * np.array([math.cos(heading), math.sin(heading)]))
        heading += float(rng.uniform(-1.2, 1.2))
    width_m = round(float(rng.uniform(0.05, 0.5)) * swath_m, 1)
    return _feature(name, "roi", "LineString", _lonlats(points), width_m=width_m)


def _halves(area: Polygon) -> list[Polygon]:
    west, south, east, north = area.bounds
    middle = 0.5 * (west + east)
    cut = [
        shapely.box(west - 1.0, south - 1.0, middle, north + 1.0),
        shapely.box(middle, south - 1.0, east + 1.0, north + 1.0),
    ]
    pieces = [part for half in cut for part in shapely.get_parts(area.intersection(half)) if part.area > 1.0]
    return [piece for piece in pieces if isinstance(piece, Polygon)] or [area]


def _areas(document: dict[str, Any]) -> list[Polygon]:
    """The regions in metres, a millimetre larger, so that a plan that sees these sees the regions."""
    scenario = read_scenario(document)
    grown = [region.area.buffer(0.001, join_style="mitre") for region in scenario.regions]
    return [shapely.transform(area, lambda at: FRAME.to_local(scenario.frame.to_wgs84(at))) for area in grown]


def _point(name: str, role: str, at: Any) -> Feature:
    return _feature(name, role, "Point", _lonlats(at))


def _polygon(name: str, area: Polygon) -> Feature:
    return _feature(name, "roi", "Polygon", [_lonlats(shapely.get_coordinates(area.exterior))])


def _feature(name: str, role: str, kind: str, coordinates: Any, **properties: Any) -> Feature:
    return {
        "type": "Feature",
        "id": name,
        "geometry": {"type": kind, "coordinates": coordinates},
        "properties": {"role": role} | properties,
    }


def _lonlats(places_m: Any) -> Any:
    return np.round(FRAME.to_wgs84(places_m), 9).tolist()


if __name__ == "__main__":
    for row in run():
        print(json.dumps(row))
