"""Where a scenario lies: the frame in the middle of everything, and who is to blame where it is too wide."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from planner.frames import MAX_EXTENT_M, WGS84, LocalFrame
from planner.geojson.features import name_of
from planner.geojson.fields import Findings, is_finite
from planner.geojson.geometry import LonLat, positions_of

#: From corner to corner of everything.
MOST_M = 2.0 * MAX_EXTENT_M
KEEP_WITHIN = f"Keep everything within {MOST_M / 1000.0:.0f} km; check the axis order (longitude first)."


@dataclass(frozen=True, slots=True)
class _Box:
    """The positions of one feature, or of all, by their least and greatest longitude and latitude."""

    name: str
    low: LonLat
    high: LonLat

    @classmethod
    def of(cls, name: str, places: list[LonLat]) -> _Box:
        lons, lats = zip(*places, strict=True)
        return cls(name, (min(lons), min(lats)), (max(lons), max(lats)))

    @property
    def middle(self) -> LonLat:
        return ((self.low[0] + self.high[0]) / 2.0, (self.low[1] + self.high[1]) / 2.0)

    @property
    def reach_m(self) -> float:
        return _apart_m(self.low, self.high)

    @property
    def too_wide(self) -> bool:
        return self.reach_m > MOST_M or self.high[0] - self.low[0] > 180.0


def frame_of(raw_features: list[Any], findings: Findings) -> LocalFrame | None:
    """A frame in the middle of everything.

    None after a finding where there are no positions; what is too far off is found, and a frame given for
    the checks that follow.
    """
    by_feature = [
        (name_of(index, feature), list(_places(feature))) for index, feature in enumerate(raw_features)
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
    whole = _Box.of("scenario", [corner for box in boxes for corner in (box.low, box.high)])
    middle = (round(whole.middle[0], 6), round(whole.middle[1], 6))
    if whole.too_wide:
        _blame(whole, boxes, findings)
        return LocalFrame(0.0, 0.0) if abs(middle[1]) > 85.0 else LocalFrame(*middle)
    return LocalFrame(*middle)


def _places(feature: Any, exchanged: bool = False) -> Iterator[LonLat]:
    """Those positions of a feature that are places on Earth, as they stand or with the axes exchanged."""
    for value in positions_of(feature.get("geometry") if isinstance(feature, dict) else None):
        if len(value) < 2 or not all(is_finite(v) for v in value[:2]):
            continue
        lon, lat = value[1::-1] if exchanged else value[:2]
        if abs(lon) <= 180.0 and abs(lat) <= 90.0:
            yield (float(lon), float(lat))


def _blame(whole: _Box, boxes: list[_Box], findings: Findings) -> None:
    """A finding for each feature too wide or far from most others; for the scenario where none stands out."""
    wide = [box for box in boxes if box.too_wide]
    others = [box for box in boxes if not box.too_wide]
    near = [[other for other in others if _apart_m(box.middle, other.middle) <= MOST_M] for box in others]
    rest = max(near, key=len, default=[])
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
    if 2 * len(rest) <= len(others):
        findings.error("scenario", "extent-too-large", f"spans {whole.reach_m / 1000.0:.0f} km", KEEP_WITHIN)
        return
    amid = _Box.of("rest", [corner for box in rest for corner in (box.low, box.high)]).middle
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
