"""What a flight's photos saw, for answers: photos for the judge, its figures, triggers of camera passes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from shapely import box, union_all

from app.services.flights.as_flown import MISSED_PART, Trigger, TriggerState
from app.services.records import FlightEvent, TrackSample
from planner.as_flown.coverage import FlownCoverage
from planner.as_flown.photo import Photo
from planner.as_flown.photo_judge import RegionPhotos
from planner.as_flown.photo_pass import PhotoPass
from planner.as_flown.unknown import UnknownPart
from planner.plan import Collect, Plan
from planner.scenario import Scenario


def taken_of(photos: Sequence[FlightEvent], samples: Sequence[TrackSample]) -> tuple[Photo, ...]:
    """The photos of a flight as the judge takes them; heights are over home, by the track where untold."""
    bases_m = [
        sample.altitude_amsl_m - sample.altitude_home_m
        for sample in samples
        if sample.altitude_amsl_m is not None and sample.altitude_home_m is not None
    ]
    home_m = bases_m[0] if bases_m else math.nan
    return tuple(
        Photo(
            photo.time_s,
            photo.lon_deg,
            photo.lat_deg,
            _height_m(photo, home_m),
            photo.roll_deg,
            photo.pitch_deg,
            photo.heading_deg,
            "camera" if photo.attitude_of == "camera" else "airframe",
            photo.index,
        )
        for photo in photos
        if photo.lon_deg is not None and photo.lat_deg is not None
    )


def _height_m(photo: FlightEvent, home_m: float) -> float:
    if photo.altitude_home_m is not None:
        return photo.altitude_home_m
    return math.nan if photo.altitude_amsl_m is None else photo.altitude_amsl_m - home_m


def photos_json(
    scenario: Scenario, result: FlownCoverage, flown_for: Sequence[Collect]
) -> dict[str, Any] | None:
    """Photos taken, counted and lost, and what they saw of each region; None where no camera was planned.

    Passes are those that were flown for.
    """
    photos = result.photos
    if photos is None:
        return None
    own = {(collect.vehicle, collect.seq) for collect in flown_for}
    return {
        "taken": photos.taken,
        "counted": photos.counted,
        "not_counted": photos.not_counted,
        "assumed": photos.assumed,
        "passes": [
            asdict(each) | {"lost": [list(gap) for gap in each.lost], "missing": each.missing}
            for each in photos.passes
            if (each.vehicle, each.seq) in own
        ],
        "regions": [
            {"roi": region.name, **_region(photos.regions[region.name], region.area.area)}
            for region in scenario.regions
            if region.name in photos.regions
        ],
    }


def _region(seen: RegionPhotos, area_m2: float) -> dict[str, Any]:
    return {
        "gsd_limit_m": seen.limit_m if math.isfinite(seen.limit_m) else None,
        "gsd_worst_m": seen.gsd_worst_m,
        "gsd_mean_m": seen.gsd_mean_m,
        "assumed_fraction": min(float(seen.assumed.area) / area_m2, 1.0) if area_m2 > 0.0 else 0.0,
        "overlap_photos": seen.asked,
        "overlap_fraction": seen.overlap_fraction,
        "planned_overlap_fraction": seen.planned_overlap_fraction,
        "forward_overlap": {"least": seen.forward.least, "mean": seen.forward.mean},
        "side_overlap": {"least": seen.side.least, "mean": seen.side.mean},
        "cell_m": seen.grid.step_m,
    }


def photo_triggers(plan: Plan, result: FlownCoverage, flown_for: Sequence[Collect]) -> tuple[Trigger, ...]:
    """How the camera was released over each collect that was flown for; those of videos aside."""
    if result.photos is None:
        return ()
    collects = {(collect.vehicle, collect.seq): collect for collect in flown_for}
    found = []
    for told in result.photos.passes:
        if (told.vehicle, told.seq) not in collects:
            continue
        photos = next(p for p in plan.photos if (p.vehicle, p.seq) == (told.vehicle, told.seq))
        length_m = photos.interval_m * max(told.planned - 1, 0)
        late_m, early_m = _ends_m(told, length_m)
        parts = [p for p in result.unknown_parts if (p.vehicle, p.seq) == (told.vehicle, told.seq)]
        found.append(
            Trigger(
                told.vehicle,
                told.seq,
                collects[told.vehicle, told.seq].roi,
                _state(told, length_m, _unclear(told, parts, photos.interval_m, result.photos.taken > 0)),
                length_m,
                length_m * min(told.taken / max(told.planned, 1), 1.0),
                late_m,
                early_m,
                told.taken,
                told.planned,
                tuple((from_m, to_m) for from_m, to_m, _ in told.lost),
                min(sum(part.end_m - part.start_m for part in parts), length_m),
            )
        )
    return tuple(found)


def _ends_m(told: PhotoPass, length_m: float) -> tuple[float | None, float | None]:
    if told.taken == 0:
        return None, None
    late = [to_m for from_m, to_m, _ in told.lost if from_m <= 0.0]
    early = [length_m - from_m for from_m, to_m, _ in told.lost if to_m >= length_m - 1e-6]
    return max(late, default=0.0), max(early, default=0.0)


def _unclear(told: PhotoPass, parts: Sequence[UnknownPart], interval_m: float, reported: bool) -> bool | None:
    """Whether all photos that are missing may have been taken where nobody heard of them; None for none."""
    if not reported:
        return bool(parts)
    if not told.lost:
        return None
    dark = union_all([box(p.start_m - interval_m, 0.0, p.end_m + interval_m, 1.0) for p in parts])
    return all(dark.buffer(1e-6).covers(box(from_m, 0.0, to_m, 1.0)) for from_m, to_m, _ in told.lost)


def _state(told: PhotoPass, length_m: float, unclear: bool | None) -> TriggerState:
    if unclear is None:
        return "ok"
    if unclear or (told.lost and told.untold >= told.missing):
        return "unknown"
    if told.taken < MISSED_PART * told.planned:
        return "missed"
    if told.lost[0][0] <= 0.0:
        return "late"
    return "early" if told.lost[-1][1] >= length_m - 1e-6 else "interrupted"
