"""What a plan's cameras take, in figures for its report."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

#: JPEG as cameras write it, and a raw file of 14 bits a pixel: bytes.
JPEG_A_PIXEL, RAW_A_PIXEL = 0.5, 1.75
GIGABYTE = 1e9

Properties = dict[str, Any]


@dataclass(frozen=True, slots=True)
class CameraFigures:
    """One camera of a plan.

    Parameters
    ----------
    camera
        As the plan has it.
    count
        Of its photos.
    spacing_m, interval_s
        The least between two photos of a pass; None where each pass has one.
    """

    camera: Properties
    count: int
    spacing_m: float | None
    interval_s: float | None

    @property
    def megapixels(self) -> float:
        """Of one photo."""
        return float(self.camera["columns"] * self.camera["rows"]) / 1e6

    @property
    def jpeg_gb(self) -> float:
        """What all photos take as JPEG."""
        return self.count * self.megapixels * 1e6 * JPEG_A_PIXEL / GIGABYTE

    @property
    def raw_gb(self) -> float:
        """The same as raw files."""
        return self.count * self.megapixels * 1e6 * RAW_A_PIXEL / GIGABYTE

    @property
    def too_soon(self) -> bool:
        """Whether photos follow each other sooner than the camera can take them."""
        least_s = float(self.camera["min_interval_s"])
        return self.interval_s is not None and self.interval_s < least_s


@dataclass(frozen=True, slots=True)
class RegionQuality:
    """What the images of one region are worth, the worst and the mean; None where unknown."""

    roi: str
    photos: int
    gsd_m: float | None
    gsd_mean_m: float | None
    niirs: float | None
    niirs_mean: float | None


def camera_figures(plan: dict[str, Any], by_role: dict[str, list[Properties]]) -> list[CameraFigures]:
    """The cameras of a plan that take photos, or a video."""
    collects = {(c["vehicle"], c["seq"]): c for c in by_role.get("collect", [])}
    found = []
    for camera in plan.get("cameras", []):
        mine = [p for p in by_role.get("photos", []) if p["sensor"] == camera["name"]]
        spaced = [p for p in mine if p["count"] > 1]
        times_s = []
        for photos in spaced:
            collect = collects[photos["vehicle"], photos["seq"]]
            speed_m_s = (collect["end_m"] - collect["start_m"]) / (collect["end_s"] - collect["start_s"])
            times_s.append(photos["interval_m"] / speed_m_s)
        found.append(
            CameraFigures(
                camera,
                sum(p["count"] for p in mine),
                min((p["interval_m"] for p in spaced), default=None),
                min(times_s, default=None),
            )
        )
    return found


def region_qualities(by_role: dict[str, list[Properties]]) -> list[RegionQuality]:
    """Regions that footprints tell the worth of, in the order of their first footprint."""
    prints = by_role.get("footprint", [])
    told = [f for f in prints if f.get("gsd_m") is not None or f.get("niirs") is not None]
    count = {(p["vehicle"], p["seq"]): p["count"] for p in by_role.get("photos", [])}
    found = []
    for roi in dict.fromkeys(f["roi"] for f in told):
        mine = [f for f in told if f["roi"] == roi]

        def values(name: str, mine: list[Properties] = mine) -> list[float]:
            return [f[name] for f in mine if f.get(name) is not None]

        def mean(name: str) -> float | None:
            all_of_it = values(name)
            return sum(all_of_it) / len(all_of_it) if all_of_it else None

        passes = {(f["vehicle"], f["seq"]) for f in mine}
        found.append(
            RegionQuality(
                roi,
                sum(count.get(key, 0) for key in passes),
                max(values("gsd_m"), default=None),
                mean("gsd_mean_m"),
                min(values("niirs"), default=None),
                mean("niirs_mean"),
            )
        )
    return found
