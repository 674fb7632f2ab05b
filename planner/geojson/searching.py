"""What a search is asked: which ground, what it is worth, and what of a scenario it cannot keep to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.terrain import Terrain
from planner.frames import LocalFrame
from planner.geojson import geometry as shapes
from planner.geojson.features import RawFeature
from planner.geojson.fields import Fields, Findings
from planner.geojson.outlines import few_cornered
from planner.scenario import Scenario
from planner.wishes import Importance, ImportancePatch, ImportanceRaster, Region

#: A raster's local cells are no finer than this, and of the ground's longer side no fewer and no more.
LEAST_CELL_M, LEAST_CELLS, MOST_CELLS = 1.0, 100, 500
#: A square metre is hardly worth more, and sums of what is are exact no longer.
MOST_SCORE = 1e12


def read_patch(raw: RawFeature, frame: LocalFrame, findings: Findings) -> ImportancePatch | None:
    """Role ``importance``."""
    score = raw.fields.number("score", minimum=0.0, maximum=MOST_SCORE)
    drawn = shapes.area(raw.name, raw.geometry, frame, findings)
    area = few_cornered(raw.name, drawn, findings)
    raw.fields.refuse_unknown()
    return None if score is None or area is None else ImportancePatch(raw.name, area, score)


def tell_unsearched(patches: Sequence[ImportancePatch], top: Fields, findings: Findings) -> None:
    """Importance is what searches are for: elsewhere it is told that nothing reads it."""
    for patch in patches:
        said = f"is not used by the collect task, nor its score of {patch.score:g}"
        findings.warning(patch.name, "not-used", said, "Remove it, or set task to search.")
    top.unused("importance_raster", "is what a search is worth, and nothing is searched")


def searched(
    regions: Sequence[Region],
    areas: Sequence[Polygon],
    area_names: Sequence[str],
    patches: Sequence[ImportancePatch],
    findings: Findings,
) -> list[Region]:
    """The ground of a search: the regions where there are some, else the area, else what is important."""
    if regions:
        return [replace(region, required=False) for region in regions]
    if areas:
        return [Region(area_names[0], areas[0], required=False)]
    whole = shapely.union_all([patch.area for patch in patches if patch.score > 0.0])
    if isinstance(whole, Polygon | MultiPolygon) and not whole.is_empty:
        return [Region("importance", whole, required=False)]
    findings.error(
        "scenario",
        "no-ground",
        "has nothing to be searched: no area, no region, and no importance above 0",
        "Add a Polygon of role area, or of role roi or importance.",
    )
    return []


def with_importance(
    scenario: Scenario,
    patches: Sequence[ImportancePatch],
    raster_name: str | None,
    raster: Terrain | None,
    findings: Findings,
) -> Scenario:
    """The scenario with what its ground is worth."""
    ground = shapely.union_all([region.area for region in scenario.regions])
    for patch in patches:
        if patch.area.intersection(ground).area <= 0.0:
            findings.warning(
                patch.name, "outside-ground", "lies outside what is searched", "Move it, or remove it."
            )
    local = None
    if raster_name is not None:
        local = _local(scenario, raster_name, raster, ground, findings)
    importance = Importance(tuple(patches), local)
    worth = math.fsum(patch.score * patch.area.intersection(ground).area for patch in patches)
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
    scores = raster.heights_at(scenario.frame.to_wgs84(places.reshape(-1, 2)).reshape(places.shape))
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
    least = float(scores[known].min())
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


def check_search(scenario: Scenario, findings: Findings) -> None:
    """Rules of searches: one sensor, one height; nothing asked that they ignore."""
    regions = scenario.regions
    if scenario.method.routing == "stecz2020":
        findings.error(
            "scenario",
            "not-supported",
            "asks for the routing stecz2020, which assigns regions; a search shares its ground out",
            "Leave method.routing out.",
        )
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
