"""What a flight missed: triggers, and ground of the regions large enough to be flown again for."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from app.services.records import TrackSample
from planner.coverage.flown import FlownCoverage
from planner.plan import Collect, Plan
from planner.scenario import Scenario

TriggerState = Literal["ok", "missed", "late", "early", "interrupted"]

#: On and off may come this far from the collect's ends: telemetry tells of them several times a second.
TRIGGER_M = 25.0
#: A collect of which less than this part was flown with the sensor on was missed.
MISSED_PART = 0.1
#: The sensor counts for a collect when the aircraft is this near to its line, in its direction.
BESIDE_M = 60.0
ALONG_COSINE = math.cos(math.radians(45.0))
#: Ground narrower than twice this, or smaller, is a sliver at the edge of a footprint: a track of a few
#: places a second does not tell better where the sensor was switched.
SLIVER_M = 5.0
SLIVER_M2 = 100.0
#: A region is seen when no more than this is missing.
SEEN_FRACTION = 0.995


@dataclass(frozen=True, slots=True)
class Trigger:
    """How the sensor was switched over one collect.

    Parameters
    ----------
    on_m
        Flown along the collect with the sensor on.
    late_m, early_m
        Of the collect's beginning and end, flown with the sensor off; None when it was missed.
    """

    seq: int
    roi: str
    state: TriggerState
    length_m: float
    on_m: float
    late_m: float | None
    early_m: float | None


@dataclass(frozen=True, slots=True)
class Gap:
    """A part of a region that was not seen, in the scenario's local frame."""

    roi: str
    area: Polygon


def triggers(
    scenario: Scenario, plan: Plan, vehicle: str | None, samples: tuple[TrackSample, ...]
) -> tuple[Trigger, ...]:
    """How the sensor was switched, collect by collect of one vehicle (all when None)."""
    lonlat = np.array([(s.lon_deg, s.lat_deg) for s in samples], dtype=np.float64).reshape(-1, 2)
    places = scenario.frame.to_local(lonlat)
    switched = np.array([sample.sensor_on for sample in samples], dtype=bool)
    on = np.stack([places[:-1], places[1:]], axis=1)[switched[:-1] & switched[1:]]
    wanted = [collect for collect in plan.collects if vehicle is None or collect.vehicle == vehicle]
    return tuple(_trigger(scenario, collect, on) for collect in wanted)


def _trigger(scenario: Scenario, collect: Collect, on: NDArray[np.float64]) -> Trigger:
    """``on``: pieces of track with the sensor on, shape (N, 2, 2): ends, east and north in metres."""
    first, last = scenario.frame.to_local([place[:2] for place in collect.line])
    length_m = float(np.hypot(*(last - first)))
    ahead = (last - first) / length_m
    moved = on[:, 1] - on[:, 0]
    offset = on - first
    along_m = offset @ ahead
    across_m = np.abs(offset[:, :, 0] * ahead[1] - offset[:, :, 1] * ahead[0]).max(axis=1)
    forward = moved @ ahead >= ALONG_COSINE * np.hypot(moved[:, 0], moved[:, 1])
    beside = forward & (across_m <= BESIDE_M) & (along_m[:, 1] > 0.0) & (along_m[:, 0] < length_m)
    along_m = np.clip(along_m[beside], 0.0, length_m)
    on_m = float((along_m[:, 1] - along_m[:, 0]).sum())
    if on_m < MISSED_PART * length_m:
        return Trigger(collect.seq, collect.roi, "missed", length_m, on_m, None, None)
    late_m, early_m = float(along_m.min()), length_m - float(along_m.max())
    state: TriggerState = "ok"
    if late_m > TRIGGER_M:
        state = "late"
    elif early_m > TRIGGER_M:
        state = "early"
    elif on_m < length_m - late_m - early_m - TRIGGER_M:
        state = "interrupted"
    return Trigger(collect.seq, collect.roi, state, length_m, on_m, late_m, early_m)


def regions_json(scenario: Scenario, plan: Plan, result: FlownCoverage) -> list[dict[str, Any]]:
    """Each region: what was seen of it to full quality, planned and flown, and what was wanted."""
    return [
        {
            "roi": region.name,
            "required": region.required,
            "seen": result.fraction[region.name] >= SEEN_FRACTION,
            "fraction": result.fraction[region.name],
            "planned_fraction": plan.metrics.coverage.get(region.name),
            "unseen_m2": float(result.unseen[region.name].area),
            "min_resolution_m": region.min_resolution_m,
        }
        for region in scenario.regions
    ]


def gaps(scenario: Scenario, result: FlownCoverage) -> tuple[Gap, ...]:
    """Parts of the regions worth a pass: slivers left out, outlines made simple, the largest first.

    A part becomes its convex hull within the region, so that all of it is seen and its outline stays short.
    """
    found = []
    for region in scenario.regions:
        for part in _polygons(result.unseen[region.name]):
            if part.area < SLIVER_M2 or part.buffer(-SLIVER_M).is_empty:
                continue
            hull = part.convex_hull.buffer(SLIVER_M, join_style="mitre").intersection(region.area)
            found += [Gap(region.name, whole) for whole in _polygons(hull) if whole.intersects(part)]
    merged = sorted(found, key=lambda gap: -gap.area.area)
    kept: list[Gap] = []
    for gap in merged:
        if not any(gap.roi == other.roi and other.area.covers(gap.area) for other in kept):
            kept.append(gap)
    return tuple(kept)


def _polygons(shape: BaseGeometry) -> Iterator[Polygon]:
    for part in getattr(shape, "geoms", [shape]):
        if isinstance(part, Polygon) and not part.is_empty:
            yield part
