"""What is seen, and how well: photos, footprints, what of the regions remains unseen."""

from __future__ import annotations

from dataclasses import dataclass

from planner.plan.words import LonLatAlt, Ring


@dataclass(frozen=True, slots=True)
class Photos:
    """Where the photos of one collect are taken, in order: the first at its start, the last at its end.

    Parameters
    ----------
    seq
        That of the collect.
    interval_m, interval_s
        Between two of them, over the ground and as flown; ``interval_s`` None where not timed.
    """

    vehicle: str
    seq: int
    sensor: str
    places: tuple[LonLatAlt, ...]
    interval_m: float
    interval_s: float | None = None


@dataclass(frozen=True, slots=True)
class Footprint:
    """Ground seen at full quality during one collect; on terrain a collect may have several.

    ``shadow_m2`` and ``layover_m2`` are the ground in the beam that terrain hides, of the whole collect.
    ``gsd_m`` and ``niirs`` are the worst inside it, ``gsd_mean_m`` and ``niirs_mean`` the means.
    """

    vehicle: str
    seq: int
    roi: str
    sensor: str
    ring: Ring
    resolution_m: float | None = None
    niirs: float | None = None
    holes: tuple[Ring, ...] = ()
    shadow_m2: float | None = None
    layover_m2: float | None = None
    gsd_m: float | None = None
    gsd_mean_m: float | None = None
    niirs_mean: float | None = None


@dataclass(frozen=True, slots=True)
class Uncovered:
    """What of a region no footprint sees: polygons as (outer ring, holes …)."""

    roi: str
    polygons: tuple[tuple[Ring, ...], ...]
    area_m2: float
    reason: str


@dataclass(frozen=True, slots=True)
class Surveyed:
    """What photos give of one region, as the judge measures it photo by photo.

    Parameters
    ----------
    forward_overlap, side_overlap
        Parts of a photo that the next one, and that of the next lane, see again: the least of any place.
    photos_least, photos_mean
        How many photos see a place.
    gsd_m, niirs
        The worst of any photo of a place of it; the means are those of the photos nearest to each place.
    """

    forward_overlap: float
    side_overlap: float
    photos_least: int
    photos_mean: float
    gsd_m: float | None = None
    gsd_mean_m: float | None = None
    niirs: float | None = None
    niirs_mean: float | None = None
