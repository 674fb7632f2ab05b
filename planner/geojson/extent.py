"""Where a scenario lies: the frame in the middle of everything, and who is to blame where it is too wide."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from planner.frames import MAX_EXTENT_M, WGS84, LocalFrame
from planner.geojson.features import RawFeature, name_of
from planner.geojson.fields import Findings, is_finite
from planner.geojson.geometry import positions_of
from planner.geojson.lying import lying
from planner.geojson.sheet import MOST_LONGITUDE_DEG, LonLat, arc_deg, wrapped_deg

#: From corner to corner of everything.
MOST_M = 2.0 * MAX_EXTENT_M
#: Beyond this latitude a degree of longitude says little about width.
POLAR_DEG = 80.0
KEEP_WITHIN = f"Keep everything within {MOST_M / 1000.0:.0f} km; check the axis order (longitude first)."


@dataclass(frozen=True, slots=True)
class _Box:
    """The positions of one feature, or of all, with the middle and the diagonal of a box round them."""

    name: str
    places: tuple[LonLat, ...]
    middle: LonLat
    reach_m: float

    @classmethod
    def of(cls, name: str, places: Sequence[LonLat]) -> _Box:
        lons, lats = zip(*places, strict=True)
        south, north = min(lats), max(lats)
        west, east = arc_deg(lons)
        if max(-south, north) <= POLAR_DEG and east - west <= 180.0:
            middle = ((west + east) / 2.0, (south + north) / 2.0)
            reach_m = _apart_m((west, south), (east, north))
        else:
            # Near a pole a box of degrees is a ring: there the box is one of metres on a plane at the pole.
            pole = (0.0, math.copysign(90.0, south + north))
            zeros = np.zeros(len(lons))
            azimuths_deg, _, away_m = WGS84.inv(zeros, zeros + pole[1], np.array(lons), np.array(lats))
            turned = np.radians(azimuths_deg)
            x_m, y_m = away_m * np.sin(turned), away_m * np.cos(turned)
            at_m = ((x_m.min() + x_m.max()) / 2.0, (y_m.min() + y_m.max()) / 2.0)
            lon, lat, _ = WGS84.fwd(*pole, math.degrees(math.atan2(*at_m)), math.hypot(*at_m))
            middle, reach_m = (float(lon), float(lat)), math.hypot(np.ptp(x_m), np.ptp(y_m))
        return cls(name, tuple(places), (wrapped_deg(middle[0]), middle[1]), reach_m)

    @property
    def too_wide(self) -> bool:
        return self.reach_m > MOST_M


def middle_of(places: Sequence[LonLat]) -> LonLat:
    """The middle of a box round places, across the antimeridian and near the poles too."""
    return _Box.of("", places).middle


def frame_of(
    raw_features: list[Any], findings: Findings, left_out: Collection[int] = ()
) -> LocalFrame | None:
    """A frame in the middle of everything that is not left out, along it as it lies.

    None after a finding where there are no positions; what is too far off is found, and a frame given for
    the checks that follow.
    """
    by_feature = [
        (name_of(index, feature), list(_places(feature)))
        for index, feature in enumerate(raw_features)
        if index not in left_out
    ]
    boxes = [_Box.of(name, places) for name, places in by_feature if places]
    if not boxes:
        if any(True for feature in raw_features for _ in _places(feature, exchanged=True)):
            findings.error(
                "scenario",
                "axes-swapped",
                "has no valid position, and valid ones with the axes exchanged",
                "This looks like latitude, longitude order: write [longitude, latitude].",
            )
        else:
            findings.error("scenario", "no-positions", "has no valid position", "Add features with geometry.")
        return None
    whole = _Box.of("scenario", [place for box in boxes for place in box.places])
    if whole.too_wide:
        rest = _largest_cluster(boxes)
        _blame(whole, boxes, rest, findings)
        at = rest or boxes[:1]
        boxes = [_Box.of("rest", box.places[:1]) for box in at]
        whole = _Box.of("rest", [place for box in boxes for place in box.places])
    flat = LocalFrame(round(whole.middle[0], 6), round(whole.middle[1], 6))
    return lying(flat, [box.places for box in boxes])


def within(frame: LocalFrame, feature: RawFeature) -> bool:
    """Whether a feature is near enough to the frame's origin to be read in it."""
    origin = (frame.lon_deg, frame.lat_deg)
    return all(_apart_m(origin, place) <= 2.0 * MOST_M for place in _places({"geometry": feature.geometry}))


def _places(feature: Any, exchanged: bool = False) -> Iterator[LonLat]:
    """Those positions of a feature that are places on Earth, as they stand or with the axes exchanged."""
    for value in positions_of(feature.get("geometry") if isinstance(feature, dict) else None):
        if len(value) < 2 or not all(is_finite(v) for v in value[:2]):
            continue
        lon, lat = value[1::-1] if exchanged else value[:2]
        if abs(lon) <= MOST_LONGITUDE_DEG and abs(lat) <= 90.0:
            yield (float(lon), float(lat))


def _largest_cluster(boxes: list[_Box]) -> list[_Box]:
    """The features that are not too wide and near most others."""
    others = [box for box in boxes if not box.too_wide]
    near = [[other for other in others if _apart_m(box.middle, other.middle) <= MOST_M] for box in others]
    return max(near, key=len, default=[])


def _blame(whole: _Box, boxes: list[_Box], rest: list[_Box], findings: Findings) -> None:
    """A finding for each feature too wide or far from most others; for the scenario where none stands out."""
    wide = [box for box in boxes if box.too_wide]
    others = [box for box in boxes if not box.too_wide]
    away = [box for box in others if box not in rest]
    for box in wide:
        findings.error(
            box.name,
            "extent-too-large",
            f"spans {box.reach_m / 1000.0:.0f} km by itself",
            KEEP_WITHIN,
        )
    if wide and len(rest) == len(others):
        return
    if 2 * len(rest) <= len(others) or not away:
        findings.error("scenario", "extent-too-large", f"spans {whole.reach_m / 1000.0:.0f} km", KEEP_WITHIN)
        return
    amid = _Box.of("rest", [place for box in rest for place in box.places]).middle
    for box in away:
        far_m = _apart_m(box.middle, amid)
        lon, lat = box.middle
        if abs(lon) <= 90.0 and _apart_m((lat, lon), amid) <= MOST_M:
            findings.error(
                box.name,
                "axes-swapped",
                f"lies {far_m / 1000.0:.0f} km from the rest, and beside it with the axes exchanged",
                "This looks like latitude, longitude order: write [longitude, latitude].",
            )
        else:
            findings.error(
                box.name, "extent-too-large", f"lies {far_m / 1000.0:.0f} km from the rest", KEEP_WITHIN
            )


def _apart_m(one: LonLat, other: LonLat) -> float:
    return float(WGS84.inv(*one, *other)[2])


def check_bbox(bbox: Any, raw_features: list[Any], findings: Findings) -> None:
    """Add a finding where the member ``bbox`` is none (RFC 7946, 5), or does not hold every position."""
    if bbox is None:
        return
    if not isinstance(bbox, list) or len(bbox) not in (4, 6) or not all(is_finite(value) for value in bbox):
        findings.error(
            "scenario", "bad-value", "bbox is no list of 4 or 6 numbers", "Write [west, south, east, north]."
        )
        return
    half = len(bbox) // 2
    (west, south), (east, north) = bbox[:2], bbox[half : half + 2]
    for feature in raw_features:
        for lon, lat in _places(feature):
            across = west <= lon <= east if west <= east else lon >= west or lon <= east
            if not (across and south <= lat <= north):
                findings.warning(
                    "scenario",
                    "bbox-too-small",
                    f"bbox does not hold {lon:g}, {lat:g}",
                    "Remove it or widen it.",
                )
                return
