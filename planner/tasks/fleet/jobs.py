"""What is shared out among aircraft: a region, or a part of one that is too large for one flight."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from types import MappingProxyType

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry import MultiPolygon, Polygon, box
from shapely.geometry.base import BaseGeometry

from planner.route import CollectPass
from planner.wishes import Region

NOTHING_SHARED: Mapping[str, float] = MappingProxyType({})
#: A part is cut where so many halvings have put the line.
_HALVINGS = 40


@dataclass(frozen=True, slots=True)
class Job:
    """What one aircraft does in one go.

    Parameters
    ----------
    region
        What is to be seen, by a name of its own.
    of
        Name of the region that was asked for.
    share
        Of that region's priority.
    """

    region: Region
    of: str
    share: float = 1.0

    @property
    def is_timed(self) -> bool:
        """Whether something binds when it is done."""
        return self.region.time_window_s is not None or self.region.revisit_after_s > 0.0

    @property
    def visits(self) -> int:
        """How often it is to be done, by whomever; visits that need not lie apart are done in one go."""
        return self.region.revisits if self.region.revisit_after_s > 0.0 else 1

    @property
    def asked(self) -> Region:
        """The region as one go sees it."""
        return replace(self.region, required=True, revisits=1 if self.visits > 1 else self.region.revisits)


def jobs_of(
    regions: Iterable[Region], parts: dict[str, int], shared_m: Mapping[str, float] = NOTHING_SHARED
) -> tuple[Job, ...]:
    """The jobs of some regions, those cut that are named in ``parts``.

    ``shared_m`` is how far two parts of a region reach into each other: what photos of both have to see.
    """
    found: list[Job] = []
    for region in regions:
        pieces = cut(region, parts.get(region.name, 1), shared_m.get(region.name, 0.0))
        if len(pieces) == 1:
            found.append(Job(region, region.name))
            continue
        # Lanes beside the cuts, so that those of two parts lie side by side.
        angle_rad = along_rad(region)
        along = region.approach_rad or (angle_rad, angle_rad + math.pi)
        for number, piece in enumerate(pieces, start=1):
            name = f"{region.name} {number}/{len(pieces)}"
            part = replace(region, name=name, area=piece, axis=None, approach_rad=along)
            found.append(Job(part, region.name, 1.0 / len(pieces)))
    return tuple(found)


def cut(region: Region, count: int, shared_m: float = 0.0) -> list[Polygon | MultiPolygon]:
    """A region in so many parts of equal area, cut along its length or along the headings it allows.

    Each reaches into its neighbours by half of what is shared.
    """
    if count <= 1:
        return [region.area]
    angle_rad = along_rad(region)
    turned = affinity.rotate(region.area, -angle_rad, origin=(0.0, 0.0), use_radians=True)
    west, south, east, north = turned.bounds
    marks = [south, *(_mark(turned, k / count) for k in range(1, count)), north]
    pieces = []
    for low, high in pairwise(marks):
        first, last = low - shared_m / 2.0, high + shared_m / 2.0
        band = turned.intersection(box(west - 1.0, first, east + 1.0, last))
        ground = _ground(affinity.rotate(band, angle_rad, origin=(0.0, 0.0), use_radians=True))
        if not ground.is_empty:
            pieces.append(ground)
    return pieces


def along_rad(region: Region) -> float:
    """Along a region's length, or the first heading that it allows."""
    if region.approach_rad:
        return region.approach_rad[0]
    rectangle = shapely.minimum_rotated_rectangle(region.area)
    corners = shapely.get_coordinates(rectangle)[:3]
    sides = np.diff(corners, axis=0)
    longest = sides[int(np.argmax(np.hypot(*sides.T)))]
    return math.atan2(longest[1], longest[0])


def _mark(area: BaseGeometry, part: float) -> float:
    """The northing below which this part of an area lies."""
    west, south, east, north = area.bounds
    low, high, wanted_m2 = south, north, part * area.area
    for _ in range(_HALVINGS):
        middle = (low + high) / 2.0
        below_m2 = area.intersection(box(west - 1.0, south - 1.0, east + 1.0, middle)).area
        low, high = (middle, high) if below_m2 < wanted_m2 else (low, middle)
    return (low + high) / 2.0


def _ground(geometry: BaseGeometry) -> Polygon | MultiPolygon:
    parts = [p for p in shapely.get_parts(geometry).tolist() if isinstance(p, Polygon) and p.area > 0.0]
    return parts[0] if len(parts) == 1 else MultiPolygon(parts)


def as_asked(passes: Sequence[CollectPass], jobs: Sequence[Job]) -> tuple[CollectPass, ...]:
    """Passes that name the regions asked for, not parts of them."""
    names = {job.region.name: job.of for job in jobs}
    return tuple(
        replace(each, regions=tuple(dict.fromkeys(names.get(name, name) for name in each.regions)))
        for each in passes
    )


def renamed(name: str, jobs: Sequence[Job]) -> str:
    """What a leg leads from or to, by the names that were asked for."""
    names = {job.region.name: job.of for job in jobs}
    return "+".join(dict.fromkeys(names.get(part, part) for part in name.split("+")))
