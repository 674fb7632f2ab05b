"""What a search is asked: which ground, what it is worth, and what of a scenario it cannot keep to."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry import MultiPolygon, Point, Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.terrain import Terrain
from planner.frames import LocalFrame
from planner.geojson import geometry as shapes
from planner.geojson.equipment import as_object
from planner.geojson.features import DISC_QUADRANT, RawFeature
from planner.geojson.fields import REQUIRED, Fields, Findings
from planner.geojson.outlines import few_cornered
from planner.geojson.seen import read_seen, unseen_of
from planner.scenario import Scenario
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.energy import FlightState
from planner.wishes import (
    Drift,
    Importance,
    ImportancePatch,
    ImportancePoint,
    ImportanceRaster,
    Method,
    Region,
)

#: A raster's local cells are no finer than this, and of the ground's longer side no fewer and no more.
LEAST_CELL_M, LEAST_CELLS, MOST_CELLS = 1.0, 100, 1_000
#: A local cell of a finer raster is the mean of so many values to a side of it at most.
MOST_WITHIN = 8
#: How uncertain a place is, what drifts and for how long: beyond these is a slip of the pen.
LEAST_SPREAD_M, MOST_SPREAD_M, MOST_DRIFT_M_S, MOST_ELAPSED_S = 1.0, 1e5, 20.0, 7 * 86_400.0
#: What methods of search know drift, walk over importance, or begin as the published horizon does.
DRIFTED, WALKS = (
    ("parallel", "creeping", "spiral", "square", "sector", "refined"),
    ("importance", "snyder2021"),
)
HORIZON = "energy-horizon"
#: So many standard deviations round a point are searched where nothing says what is.
SPREADS = 3.0
#: A square metre is hardly worth more, and sums of what is are exact no longer.
MOST_SCORE = 1e12


def read_worth(
    raw: RawFeature, frame: LocalFrame, findings: Findings
) -> ImportancePatch | ImportancePoint | None:
    """Role ``importance``."""
    score = raw.fields.number("score", minimum=0.0, maximum=MOST_SCORE)
    if raw.geometry["type"] == "Point":
        spread_m = raw.fields.number("spread_m", minimum=LEAST_SPREAD_M, maximum=MOST_SPREAD_M)
        position = shapes.point(raw.name, raw.geometry, frame, findings)
        raw.fields.refuse_unknown()
        if score is None or spread_m is None or position is None:
            return None
        return ImportancePoint(raw.name, position, spread_m, score)
    drawn = shapes.area(raw.name, raw.geometry, frame, findings)
    area = few_cornered(raw.name, drawn, findings)
    raw.fields.refuse_unknown()
    return None if score is None or area is None else ImportancePatch(raw.name, area, score)


def read_search(raw: Any, frame: LocalFrame, findings: Findings) -> Importance:
    """Member ``search``: how a look finds, how what is looked for drifts, what has been looked at already."""
    if raw is None:
        return Importance()
    fields = Fields("search", as_object("search", raw, findings), findings)
    detection = fields.number("detection", 1.0, above=0.0, maximum=1.0)
    drift = fields.raw("drift")
    seen = read_seen(fields, frame, findings)
    fields.refuse_unknown()
    return Importance(
        detection=detection or 1.0,
        drift=None if drift is None else _read_drift(drift, frame, findings),
        seen=seen,
    )


def _read_drift(raw: Any, frame: LocalFrame, findings: Findings) -> Drift | None:
    """Its member ``drift``."""
    fields = Fields("drift", as_object("drift", raw, findings), findings)
    speed_m_s = fields.number("speed_m_s", minimum=0.0, maximum=MOST_DRIFT_M_S)
    toward_deg = fields.number(
        "toward_deg", 0.0 if speed_m_s == 0.0 else REQUIRED, minimum=0.0, maximum=360.0
    )
    spread_m_s = fields.number("spread_m_s", 0.0, minimum=0.0, maximum=MOST_DRIFT_M_S)
    elapsed_s = fields.number("elapsed_s", 0.0, minimum=0.0, maximum=MOST_ELAPSED_S)
    fields.refuse_unknown()
    if speed_m_s is None or toward_deg is None or spread_m_s is None or elapsed_s is None:
        return None
    angle_rad = frame.direction_rad(toward_deg)
    return Drift(speed_m_s * math.cos(angle_rad), speed_m_s * math.sin(angle_rad), spread_m_s, elapsed_s)


def tell_unsearched(
    patches: Sequence[ImportancePatch | ImportancePoint], top: Fields, findings: Findings
) -> None:
    """Importance is what searches are for: elsewhere it is told that nothing reads it."""
    for patch in patches:
        said = f"is not used by the collect task, nor its score of {patch.score:g}"
        findings.warning(patch.name, "not-used", said, "Remove it, or set task to search.")
    top.unused("importance_raster", "is what a search is worth, and nothing is searched")
    top.unused("search", "says how a search finds, and nothing is searched")


def importance_of(worth: Sequence[ImportancePatch | ImportancePoint], told: Importance) -> Importance:
    """Importance as its features and the member ``search`` tell it."""
    patches = tuple(one for one in worth if isinstance(one, ImportancePatch))
    points = tuple(one for one in worth if isinstance(one, ImportancePoint))
    return replace(told, patches=patches, points=points)


def longest_s(aircraft: Sequence[Aircraft | None]) -> float | None:
    """How long the longest flight lasts, about; None where nothing limits one of them."""
    found = []
    for one in aircraft:
        if one is None:
            continue
        limits_s = [one.max_flight_time_s]
        if one.max_range_m is not None:
            limits_s.append(one.max_range_m / one.airspeed_m_s)
        if one.usable_wh is not None and one.power is not None:
            limits_s.append(one.usable_wh * 3600.0 / one.power.power_w(FlightState(one.airspeed_m_s)))
        known = [limit_s for limit_s in limits_s if limit_s is not None]
        if not known:
            return None
        found.append(min(known))
    return max(found, default=None)


def searched(
    regions: Sequence[Region],
    areas: Sequence[Polygon],
    area_names: Sequence[str],
    importance: Importance,
    lasting_s: float | None,
    findings: Findings,
) -> list[Region]:
    """The ground of a search: the regions where there are some, else the area, else what is important.

    Parameters
    ----------
    lasting_s
        How long the longest flight lasts, for what drifts; None where nothing says.
    """
    if regions:
        asked = [replace(region, required=False) for region in regions]
        return unseen_of(asked, importance, findings)
    if areas:
        return unseen_of([Region(area_names[0], areas[0], required=False)], importance, findings)
    drift = importance.drift
    if drift is not None and lasting_s is None:
        findings.error(
            "scenario",
            "no-ground",
            "looks for what drifts, and neither says where nor how long it flies",
            "Add a Polygon of role area or roi, or energy, range or flight time of the vehicle.",
        )
        return []
    most = [_drifted_over(one, drift, lasting_s or 0.0) for one in _worth_most(importance)]
    whole = shapely.union_all(most)
    if isinstance(whole, Polygon | MultiPolygon) and not whole.is_empty:
        return unseen_of([Region("importance", whole, required=False)], importance, findings)
    findings.error(
        "scenario",
        "no-ground",
        "has nothing to be searched: no area, no region, and no importance above 0",
        "Add a Polygon of role area, or of role roi or importance.",
    )
    return []


def _worth_most(importance: Importance) -> Iterator[Polygon | MultiPolygon]:
    """Ground of what is worth anything, of points the disc round them."""
    for patch in importance.patches:
        if patch.score > 0.0:
            yield patch.area
    for point in importance.points:
        if point.score > 0.0:
            yield _round(point)


def _round(point: ImportancePoint) -> Polygon:
    """The disc that nearly all of its worth lies in."""
    disc: Polygon = Point(point.position).buffer(SPREADS * point.spread_m, quad_segs=DISC_QUADRANT)
    return disc


def _drifted_over(ground: Polygon | MultiPolygon, drift: Drift | None, lasting_s: float) -> BaseGeometry:
    """Ground that something on it drifts over in a flight."""
    if drift is None:
        return ground
    places: list[BaseGeometry] = []
    for since_s in (drift.elapsed_s, drift.elapsed_s + lasting_s):
        moved = affinity.translate(ground, since_s * drift.east_m_s, since_s * drift.north_m_s)
        places.append(moved.buffer(SPREADS * since_s * drift.spread_m_s))
    hull: BaseGeometry = shapely.union_all(places).convex_hull
    return hull


def with_importance(
    scenario: Scenario,
    asked: Importance,
    raster_name: str | None,
    raster: Terrain | None,
    findings: Findings,
) -> Scenario:
    """The scenario with what its ground is worth."""
    ground = shapely.union_all([region.area for region in scenario.regions])
    reached: list[tuple[str, float, Polygon | MultiPolygon]] = [
        *((one.name, one.score, one.area) for one in asked.patches),
        *((one.name, one.score, _round(one)) for one in asked.points),
    ]
    for name, _, area in reached:
        if asked.drift is None and area.intersection(ground).area <= 0.0:
            findings.warning(
                name, "outside-ground", "lies outside what is searched", "Move it, or remove it."
            )
    local = None
    if raster_name is not None:
        local = _local(scenario, raster_name, raster, ground, findings)
    importance = replace(asked, raster=local)
    worth = math.fsum(score * area.intersection(ground).area for _, score, area in reached)
    if asked.drift is not None:
        worth = math.fsum(score for _, score, _ in reached)
        if not importance.given:
            findings.error(
                "drift",
                "nothing-drifts",
                "says how what is looked for moves on, and nothing says where it was",
                "Add importance: a Point with score and spread_m where it was last known.",
            )
    if local is not None:
        worth += float(local.scores.sum())
    if importance.given and worth <= 0.0 and not findings.errors:
        findings.error(
            "scenario",
            "nothing-important",
            "searches ground of no importance: all scores on it are 0",
            "Raise a score, or leave importance out: all ground is then worth the same.",
        )
    return replace(scenario, importance=importance)


def _local(
    scenario: Scenario,
    name: str,
    raster: Terrain | None,
    ground: BaseGeometry,
    findings: Findings,
) -> ImportanceRaster | None:
    """A raster on local cells over the ground; None after a finding."""
    if raster is None:
        findings.error(
            "scenario",
            "unknown-raster",
            f"names the importance_raster {name!r}, which is not here",
            "Send the raster first (as terrain is sent) and name it by its id.",
        )
        return None
    west_m, south_m, east_m, north_m = ground.bounds
    side_m = max(east_m - west_m, north_m - south_m)
    cell_m = max(LEAST_CELL_M, min(raster.resolution_m / 2.0, side_m / LEAST_CELLS), side_m / MOST_CELLS)
    columns = max(1, math.ceil((east_m - west_m) / cell_m - 1e-9))
    rows = max(1, math.ceil((north_m - south_m) / cell_m - 1e-9))
    east = west_m + (np.arange(columns) + 0.5) * cell_m
    north = south_m + (np.arange(rows) + 0.5) * cell_m
    places = np.stack(np.meshgrid(east, north), axis=-1)
    within = min(MOST_WITHIN, math.ceil(cell_m / raster.resolution_m - 1e-9))
    scores = np.zeros(places.shape[:2])
    for north_part, east_part in np.ndindex(within, within):
        off_m = cell_m * ((np.array([east_part, north_part]) + 0.5) / within - 0.5)
        lonlats = scenario.frame.to_wgs84((places + off_m).reshape(-1, 2)).reshape(places.shape)
        scores += raster.heights_at(lonlats) / within**2
    shapely.prepare(ground)
    inside = shapely.contains_xy(ground, places[..., 0], places[..., 1])
    known = np.isfinite(scores) & inside
    if not known.any():
        findings.error(
            "scenario",
            "raster-outside",
            f"has the importance_raster {name!r}, which has no value anywhere on the ground searched",
            "Check its georeference, or name one that covers the ground.",
        )
        return None
    least = min(float(scores[known].min()), _least_within(raster, ground, scenario.frame))
    if least < 0.0 or np.isinf(raster.heights_m).any():
        said = f"down to {least:g}" if least < 0.0 else "of infinity"
        findings.error(
            "scenario",
            "bad-score",
            f"has an importance_raster {name!r} with values {said}; importance is finite, 0 or more",
            "Correct the raster, or mark such cells as nodata.",
        )
        return None
    if known.sum() < 0.5 * inside.sum():
        findings.warning(
            "scenario",
            "raster-in-part",
            f"has an importance_raster {name!r} with values on {known.sum() / inside.sum():.0%} of the "
            "ground; the rest counts as 0",
            "Name a raster that covers the ground.",
        )
    return ImportanceRaster(name, np.where(known, scores, 0.0), west_m, south_m, cell_m)


def _least_within(raster: Terrain, ground: BaseGeometry, frame: LocalFrame) -> float:
    """The least of a raster's own values on the ground, where that is below 0; else 0.

    One finer than the cells is not seen in their means.
    """
    rows, columns = np.nonzero(raster.known() & (raster.heights_m < 0.0))
    a, b, c, d, e, f = raster.affine
    places = frame.to_local(np.stack([a * columns + b * rows + c, d * columns + e * rows + f], axis=-1))
    inside = shapely.contains_xy(ground, places[:, 0], places[:, 1])
    return float(raster.heights_m[rows[inside], columns[inside]].min(initial=0.0))


def check_search(scenario: Scenario, findings: Findings) -> None:
    """Rules of searches: one sensor, one height; nothing asked that they ignore."""
    regions = scenario.regions
    check_methods(scenario, findings)
    for region in regions:
        wishes = {
            "approach_deg": region.approach_rad is not None,
            "revisits": region.revisits > 1,
            "pattern": region.pattern != "auto",
            "time_window_s": region.time_window_s is not None,
            "revisit_after_s": region.revisit_after_s > 0.0,
        }
        for wish in (wish for wish, asked in wishes.items() if asked):
            findings.error(
                region.name,
                "not-supported",
                f"has {wish}; a search sees ground once, when and in directions as it comes",
                f"Leave {wish} out, or collect it.",
            )
        if region.sensor != regions[0].sensor or region.altitude_m != regions[0].altitude_m:
            findings.error(
                region.name,
                "several-ways",
                f"has another sensor or altitude than {regions[0].name}; a search is flown at one height "
                "with one sensor",
                "Give all its regions the same, or search them one by one.",
            )


def check_methods(scenario: Scenario, findings: Findings) -> None:
    """Methods that a search has no use for, or that know less than it asks."""
    method, importance = scenario.method, scenario.importance
    for stage, said in (("coverage", "how regions are covered"), ("routing", "in which order, or by whom")):
        name = getattr(method, stage)
        if name != "auto":
            findings.error(
                "method",
                "not-supported",
                f"asks for the {stage} {name}, which says {said}; a search sees ground by method.search",
                f"Leave method.{stage} out.",
            )
    known = {
        "what misses": (importance.detection < 1.0, not method.search.startswith(HORIZON)),
        "what drifts": (importance.drift is not None, method.search in (*DRIFTED, "auto")),
        "importance": (importance.given, not method.search.startswith(HORIZON)),
    }
    missing = [what for what, (asked, able) in known.items() if asked and not able]
    if missing:
        every = ("auto", *DRIFTED) if importance.drift is not None else ("auto", *DRIFTED, *WALKS)
        findings.error(
            "method",
            "not-supported",
            f"asks for the search {method.search}, which knows nothing of {', nor of '.join(missing)}",
            f"Use one of: {', '.join(every)}.",
        )


def tell_collected(method: Method, findings: Findings) -> None:
    """A way to search is refused where nothing is searched."""
    if method.search != "auto":
        findings.error(
            "method",
            "not-supported",
            f"asks for the search {method.search}, and the task is collect",
            "Leave method.search out, or set task to search.",
        )
