"""Slots between hard things that what is kept from them closes: told by name, with what would open them.

Nothing is wrong with such a scenario; but whoever drew the slot may have meant it to be flown through.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import shapely
from shapely.geometry.base import BaseGeometry

from planner.airspace.shapes import DiscShape, banded_shapes
from planner.airspace.zones import TRANSIT_MARGIN_M
from planner.geojson.fields import Findings
from planner.scenario import Scenario

#: Of many slots the narrowest are told one by one.
MOST_TOLD = 5
#: A slot is to be so much wider than what is kept from its sides.
ROOM_M = 0.5


@dataclass(frozen=True, slots=True)
class Slot:
    """A gap between two hard things, or between one and the edge of the operating area.

    Parameters
    ----------
    width_m
        At its narrowest.
    other
        The other thing; None for the area's edge, which is kept at the lines' own margin.
    """

    width_m: float
    one: str
    other: str | None = None

    @property
    def sides(self) -> int:
        """Of how many of its sides ``clearance_m`` is kept."""
        return 1 if self.other is None else 2

    @property
    def kept_from(self) -> str:
        """What ``clearance_m`` is kept from, in words."""
        return "it" if self.other is None else "both"

    @property
    def flyable(self) -> bool:
        """Whether lines with their own margin alone would fit through."""
        return self.opening_m > 0.0

    @property
    def opening_m(self) -> float:
        """The most that may be kept for lines to fit through, metres, or tenths of one below."""
        most_m = (self.width_m - 2.0 * TRANSIT_MARGIN_M - ROOM_M) / self.sides
        return math.floor(most_m) if most_m >= 1.0 else max(0.0, math.floor(10.0 * most_m) / 10.0)


def check_slots(scenario: Scenario, findings: Findings) -> None:
    """A warning for each slot that could be flown through if nothing were kept from its sides."""
    found = closed_slots(scenario)
    for slot in found[:MOST_TOLD]:
        other = slot.other or "the edge of the operating area"
        findings.warning(
            slot.one,
            "slot-too-narrow",
            f"leaves {slot.width_m:.1f} m to {other}, too narrow for the clearance_m of "
            f"{scenario.clearance_m:g} m from {slot.kept_from} and {TRANSIT_MARGIN_M:g} m that lines keep "
            "besides: nothing is flown there",
            f"Set clearance_m to {slot.opening_m:g} at most where that is to be flown through.",
        )
    if len(found) > MOST_TOLD:
        findings.warning(
            "scenario",
            "slot-too-narrow",
            f"has {len(found) - MOST_TOLD} wider slots that clearance_m closes, too",
            "Set clearance_m lower where they are to be flown through.",
        )


def closed_slots(scenario: Scenario) -> list[Slot]:
    """The slots that what is kept closes at the level flown, the narrowest first."""
    kept_m, level = scenario.clearance_m, scenario.level
    shapes = [
        banded.shape
        for banded in banded_shapes(scenario.airspace, level.amsl_m - level.height_m)
        if banded.hard and banded.kept_m > 0.0 and banded.counts(*level.counted_m)
    ]
    # Discs by their centres and radii: a polygon would be off by its chords.
    cores: list[BaseGeometry] = [
        shapely.Point(s.centre) if isinstance(s, DiscShape) else s.area for s in shapes
    ]
    radii_m = [s.radius_m if isinstance(s, DiscShape) else 0.0 for s in shapes]
    tree, widest_m = shapely.STRtree(cores), max(radii_m, default=0.0)
    found = []
    for k, shape in enumerate(shapes):
        near_m = radii_m[k] + widest_m + 2.0 * (kept_m + TRANSIT_MARGIN_M) + ROOM_M
        for other in tree.query(cores[k], predicate="dwithin", distance=near_m):
            if other <= k:
                continue
            width_m = cores[k].distance(cores[other]) - radii_m[k] - radii_m[other]
            found.append(Slot(float(width_m), shape.name, shapes[other].name))
        if scenario.area is not None and scenario.area.covers(cores[k]):
            width_m = scenario.area.exterior.distance(cores[k]) - radii_m[k]
            found.append(Slot(float(width_m), shape.name))
    closed = [slot for slot in found if slot.flyable and slot.opening_m < kept_m]
    return sorted(closed, key=lambda slot: slot.width_m)
