"""The looks that flights had: ground seen pass by pass, and when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.as_flown.coverage import GRID_M, Asked, flown_coverage
from planner.as_flown.passes import FlownPass, PlannedPass
from planner.as_flown.track import LONGEST_AT_ALL_S, Record
from planner.plan import Collect, Plan

#: So much farther than planned, in parts of the footprint's size, ground is looked for that a pass has seen.
ROUND = 0.25
#: So far before its ends a pass is flown already, and still: places are samples of a second or less.
SLACK_M = 1.0


@dataclass(frozen=True, slots=True)
class FlownLook:
    """Ground seen in one pass of one flight.

    Parameters
    ----------
    record
        Which of the records, from 0.
    ground
        In the local frame, within the regions asked for.
    start_s, end_s
        By the record's clock.
    course_rad
        That of the planned pass, which the flown one keeps to.
    """

    record: int
    ground: BaseGeometry
    start_s: float
    end_s: float
    course_rad: float


def flown_looks(asked: Asked, plan: Plan, records: Sequence[Record]) -> tuple[FlownLook, ...]:
    """Every pass of every flight that saw something, as often as it was flown.

    Each is judged by itself, as ``flown_coverage`` does.
    """
    collects = {(collect.vehicle, collect.seq): collect for collect in plan.collects}
    found = []
    for number, record in enumerate(records):
        for flown in flown_coverage(asked, plan, (record,)).passes:
            own = _Own.of(asked, plan, collects[flown.vehicle, flown.seq])
            if own is None:
                continue
            for start_s, end_s in own.times_s(asked, record, flown):
                ground = own.seen(record, start_s, end_s)
                if not ground.is_empty:
                    found.append(FlownLook(number, ground, start_s, end_s, own.course_rad))
    return tuple(found)


@dataclass(frozen=True, slots=True)
class _Own:
    """One pass of a plan as if it were the only one, and what of the regions it may see."""

    asked: Asked
    plan: Plan
    planned: PlannedPass

    @classmethod
    def of(cls, asked: Asked, plan: Plan, collect: Collect) -> _Own | None:
        """Of one collect; None where its plan has no ground for it."""
        key = (collect.vehicle, collect.seq)
        prints = tuple(each for each in plan.footprints if (each.vehicle, each.seq) == key)
        if not prints:
            return None
        west, south, east, north = shapely.union_all(
            [Polygon(asked.frame.to_local(each.ring)) for each in prints]
        ).bounds
        reach_m = max(east - west, north - south)
        near = shapely.box(west, south, east, north).buffer(ROUND * reach_m)
        regions = []
        for region in asked.regions:
            parts = shapely.get_parts(shapely.intersection(region.area, near, grid_size=GRID_M))
            areas = [part for part in parts if isinstance(part, Polygon)]
            if areas:
                area = areas[0] if len(areas) == 1 else MultiPolygon(areas)
                regions.append(replace(region, area=area))
        photos = tuple(each for each in plan.photos if (each.vehicle, each.seq) == key)
        alone = replace(plan, collects=(collect,), footprints=prints, photos=photos)
        planned = PlannedPass.of(collect, asked.frame, reach_m)
        return cls(replace(asked, regions=tuple(regions)), alone, planned)

    @property
    def course_rad(self) -> float:
        """Of the planned line."""
        return float(np.arctan2(self.planned.ahead[1], self.planned.ahead[0]))

    def times_s(self, asked: Asked, record: Record, flown: FlownPass) -> list[tuple[float, float]]:
        """When it was flown, from its start to its end, each time by itself."""
        during = [s for s in record.samples if flown.start_s <= s.time_s <= flown.end_s]
        places = asked.frame.to_local(np.array([(s.lon_deg, s.lat_deg) for s in during]))
        along_m, across_m = self.planned.along_m(places), self.planned.across_m(places)
        on = (along_m >= -SLACK_M) & (along_m <= self.planned.length_m + SLACK_M)
        rows = np.flatnonzero(on & (across_m <= self.planned.beside_m))
        times_s = np.array([s.time_s for s in during])
        breaks = (np.diff(rows) > 1) | (np.diff(times_s[rows]) > LONGEST_AT_ALL_S)
        runs = np.split(rows, np.flatnonzero(breaks) + 1)
        return [
            (float(times_s[run[0]]), float(times_s[run[-1]]))
            for run in runs
            if len(run) > 1 and along_m[run[-1]] > along_m[run[0]]
        ]

    def seen(self, record: Record, start_s: float, end_s: float) -> BaseGeometry:
        """What it saw in a time of a record."""
        during = Record(
            tuple(s for s in record.samples if start_s <= s.time_s <= end_s),
            record.vehicle,
            sortie=record.sortie,
            photos=tuple(p for p in record.photos if start_s <= p.time_s <= end_s),
        )
        judged = flown_coverage(self.asked, self.plan, (during,))
        return shapely.union_all(list(judged.seen.values()), grid_size=GRID_M)
