"""An area among obstacles as it is swept: its axes pointing so that those mirrored, and turned, are the same.

Sweeps are laid from below upwards, and from one end on: the same area mirrored would be swept otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import shapely
from shapely.geometry import Polygon

from planner.coverage.urban.area import Building, Place, UrbanArea
from planner.coverage.urban.measures import Sweep

#: What lies nearer to the first axis than this part of the area's size is on it.
ON_AXIS = 1e-3


@dataclass(frozen=True, slots=True)
class Hand:
    """Which way the second axis points, 1 or -1."""

    sign: float

    @classmethod
    def of(cls, urban: UrbanArea) -> Hand:
        """That by which more of what lies in it is above its middle."""
        return cls(-1.0 if _below(urban) else 1.0)

    def there(self, urban: UrbanArea) -> UrbanArea:
        """The area by those axes."""
        return replace(
            urban,
            area=self._outline(urban.area),
            buildings=tuple(Building(self._outline(each.outline), each.height_m) for each in urban.buildings),
            start=self._place(urban.start),
            end=self._place(urban.end),
        )

    def back(self, sweep: Sweep) -> Sweep:
        """A sweep of that area as it lies in the one asked for."""
        return replace(sweep, start=self._place(sweep.start), end=self._place(sweep.end))

    def _place(self, place: Place) -> Place:
        return (place[0], self.sign * place[1])

    def _outline(self, outline: Polygon) -> Polygon:
        if self.sign == 1.0:
            return outline
        moved: Polygon = shapely.transform(outline, lambda places: places * (1.0, self.sign))
        return shapely.normalize(moved)


def _below(urban: UrbanArea) -> bool:
    """Whether what tells the sides of the first axis apart is more on that to the right.

    In turn: obstacles, the start, the end, and the area itself.
    """
    west, south, east, north = urban.area.bounds
    middle_m, size_m = 0.5 * (south + north), max(north - south, east - west)
    outlines = [building.outline for building in urban.buildings]
    standing = shapely.union_all([each.intersection(urban.area) for each in outlines])
    aside_m = [
        (standing.centroid.y - middle_m) * min(1.0, standing.area / urban.area.area)
        if standing.area
        else 0.0,
        urban.start[1] - middle_m,
        urban.end[1] - middle_m,
        urban.area.centroid.y - middle_m,
    ]
    return next((each < 0.0 for each in aside_m if abs(each) > ON_AXIS * size_m), False)
