"""From regions to the stops of a tour: parts and visits, each with the families of passes that see it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.airspace.surroundings import Surroundings
from planner.coverage.estimate import Ends, least_tour_m
from planner.coverage.lines import roomy
from planner.coverage.merge import MergedRegion
from planner.coverage.strips.alternatives import families, legs_of, parts_of, visits
from planner.coverage.strips.headings import grid
from planner.coverage.strips.options import Options, collect_passes, hidden_m, make_options
from planner.coverage.strips.segments import Neighbourhood
from planner.coverage.strips.sweeps import MOST_TELLING, Side, Sweep, telling_headings
from planner.coverage.ways import Between, Division
from planner.errors import InfeasibleError
from planner.progress import Stop, never
from planner.route import CollectPass
from planner.sensors.sar import SarSensor

Floats = NDArray[np.float64]

#: Divisions of a region are compared at these headings, those its shape singles out and offsets,
STEP_RAD = math.radians(15.0)
TELLING_COMPARED = 8
ETAS = np.array([0.0, 0.5, 1.0])
#: by this many of each part's cheapest options.
OPTIONS_COMPARED = 48
#: Finer options: this many headings and offsets to either side.
NEAR_ANGLES, NEAR_ETAS = 5, 2
#: Headings and offsets tried where a coarse grid leaves no room for turns, and those where the first do not;
#: how many options with room are kept.
FINER = ((math.radians(2.5), 9), (math.radians(1.0), 33))
MOST_ROOMY = 100
#: Between the headings tried first where only whether there is a way is asked.
FEW_STEP_RAD = math.radians(15.0)


@dataclass(frozen=True, slots=True)
class StripTarget:
    """A region, part of one or visit to one, with the families of passes that see it.

    Parameters
    ----------
    sides
        All of one sensor at one height: neighbourhoods, one a look side, and sweeps.
    """

    region: MergedRegion
    sides: tuple[Side, ...]
    around: Surroundings

    def options(self, angles_rad: Floats, etas: Floats) -> Options | None:
        """Options at these headings and offsets; None where there are none."""
        return make_options(self.sides, angles_rad, etas, self.around)

    def coarse(self, step_rad: float, etas: Floats) -> Options:
        """The options to choose an order by.

        Where none has room to turn at both ends, those of a finer grid that have it are taken instead.

        Raises
        ------
        InfeasibleError
            Where no option keeps the hard constraints.
        """
        angles_rad = headings(self.region, self.sides, step_rad, self.around)
        options = make_options(self.sides, angles_rad, etas, self.around)
        if options is None:
            options = make_options(
                self.sides, self.sides[0].angles_rad, np.linspace(0.0, 1.0, 9), self.around
            )
        if options is None:
            raise refusal(self.region, self.around)
        if _with_room(options, self.around).any():
            return options
        for finer_rad, count in FINER:
            angles_rad = headings(self.region, self.sides, finer_rad, self.around)
            finer = make_options(self.sides, angles_rad, np.linspace(0.0, 1.0, count), self.around)
            kept = np.empty(0, dtype=np.int64)
            if finer is not None:
                kept = np.flatnonzero(_with_room(finer, self.around))
            if finer is not None and len(kept) > 0:
                return finer.rows(kept[:: math.ceil(len(kept) / MOST_ROOMY)])
        return options

    def key(self, picked: Options) -> tuple[float, ...]:
        """What those near an option are found by."""
        # Where there is no second pass its offset is no number, and no such number is like another.
        second = float(np.nan_to_num(picked.eta_second[0], nan=-1.0))
        return (
            float(picked.side[0]),
            float(picked.angles_rad[0]),
            float(picked.eta_first[0]),
            second,
        )

    def near(
        self, picked: Options, step_rad: float, step_eta: float, between: Between | None = None
    ) -> Options:
        """Options round a single one; that one where there are none.

        They are of its side; of any sweep with as many lanes where what they lie between is known.
        """
        angles_rad = picked.angles_rad[0] + step_rad * np.arange(
            -NEAR_ANGLES, NEAR_ANGLES + 1, dtype=np.float64
        )
        if self.region.approach_rad is not None:
            angles_rad = np.asarray(self.region.approach_rad, dtype=np.float64)
        etas = _near([float(picked.eta_first[0]), float(picked.eta_second[0])], step_eta)
        side = int(picked.side[0])
        alike = np.array([side], dtype=np.int64)
        chosen = self.sides[side]
        if between is not None and isinstance(chosen, Sweep):
            alike = np.flatnonzero(
                [isinstance(each, Sweep) and each.extra == chosen.extra for each in self.sides]
            )
        options = make_options([self.sides[k] for k in alike], angles_rad, etas, self.around, between)
        return picked if options is None else replace(options, side=alike[options.side])

    def passes(self, options: Options, index: int) -> tuple[CollectPass, ...]:
        """The passes of one option."""
        return collect_passes(self.sides, options, index)

    def hidden_m(self, passes: Sequence[CollectPass]) -> float:
        """What passes of one option cost for ground of the region that terrain hides from them."""
        return hidden_m(self.sides[0], passes, self.around)

    def plain(self) -> StripTarget:
        """With pairs of passes alone where there are sweeps too."""
        pairs = tuple(side for side in self.sides if isinstance(side, Neighbourhood))
        return replace(self, sides=pairs) if 0 < len(pairs) < len(self.sides) else self


def targets(
    region: MergedRegion,
    sensor: SarSensor,
    height_m: float,
    around: Surroundings,
    *,
    wide: bool = True,
    division: Division = "auto",
    enough: Stop = never,
) -> tuple[StripTarget, ...]:
    """The stops that see one region; several where it is divided or to be visited again.

    Parameters
    ----------
    wide
        Whether more than two swaths, divisions and sweeps are allowed; without, the paper's neighbourhoods.
    division
        How to divide it.
    enough
        Ends the search for a shorter division.

    Raises
    ------
    InfeasibleError
        Where no pass may be flown that sees it.
    """
    known: dict[bytes, Options | None] = {}

    def options_of(part: MergedRegion) -> Options | None:
        key = part.area.wkb
        if key not in known:
            known[key] = _some(part, sensor, height_m, around, wide=wide)[1]
        return known[key]

    def estimate(parts: tuple[MergedRegion, ...]) -> float:
        options = [options_of(part) for part in parts]
        found = [_cheapest(o) for o in options if o is not None]
        return least_tour_m(found, around) if len(found) == len(options) else math.inf

    undivided = options_of(region)
    parts: tuple[MergedRegion, ...] = (region,)
    if wide and (
        undivided is None
        or (division != "whole" and (bool((_passes(undivided) > 1).all()) or region.axis is not None))
    ):
        legs = legs_of(region) if division == "legs" else None
        parts = legs or parts_of(region, estimate, sensor, height_m, around, enough)
    found = []
    for part in parts:
        for visit in visits(part):
            some = _roomy if division == "roomy" else _some
            sides, options = some(visit, sensor, height_m, around, wide=wide)
            if options is None and visit.visit is not None:
                sides, options = some(part, sensor, height_m, around, wide=wide)
                visit = part
            if options is None:
                raise refusal(region, around)
            found.append(StripTarget(visit, sides, around))
    return tuple(found)


def can_be_flown(
    region: MergedRegion, sensor: SarSensor, height_m: float, around: Surroundings, *, wide: bool = True
) -> bool:
    """Whether some pass, or some sweep of the whole region, may be flown."""
    few = np.linspace(0.0, 1.0, 3)
    for sides in families(region, sensor, height_m, wide=wide):
        # Mostly some heading of the grid does, and is found sooner than what the shape singles out.
        if make_options(sides, headings(region, sides, FEW_STEP_RAD, around, 0), few, around) is not None:
            return True
    return _some(region, sensor, height_m, around, wide=wide)[1] is not None


def headings(
    region: MergedRegion,
    sides: tuple[Side, ...],
    step_rad: float,
    around: Surroundings,
    most: int = MOST_TELLING,
) -> Floats:
    """The allowed headings, else a grid in the region's own axes; for sweeps also what its shape singles out.

    Parameters
    ----------
    most
        Headings besides the grid.
    """
    if region.approach_rad is not None:
        return np.asarray(region.approach_rad, dtype=np.float64)
    own_rad = grid(region.area, step_rad)
    sweep = next((side for side in sides if isinstance(side, Sweep)), None)
    if sweep is None or most == 0:
        return own_rad
    return np.union1d(own_rad, telling_headings(sweep, math.pi * around.radius_m, most))


def refusal(region: MergedRegion, around: Surroundings) -> InfeasibleError:
    """What to say where every pass is forbidden."""
    return InfeasibleError(
        "area",
        region.label,
        "every pass that sees it leaves the operating area"
        if len(around.hard) + len(around.hard_polygons) == 0
        else "every pass that sees it leaves the operating area or enters a hard zone",
        "enlarge the area round it, or allow the other look side",
        region.centroid,
    )


def _some(
    region: MergedRegion, sensor: SarSensor, height_m: float, around: Surroundings, *, wide: bool
) -> tuple[tuple[Side, ...], Options | None]:
    """The first families with an option, and these options."""
    sides: tuple[Side, ...] = ()
    for sides in families(region, sensor, height_m, wide=wide):
        coarse = headings(region, sides, STEP_RAD, around, TELLING_COMPARED)
        for angles_rad, count in ((coarse, 3), (sides[0].angles_rad, 3), (sides[0].angles_rad, 9)):
            options = make_options(sides, angles_rad, np.linspace(0.0, 1.0, count), around)
            if options is not None:
                return sides, options
    return sides, None


def _roomy(
    region: MergedRegion, sensor: SarSensor, height_m: float, around: Surroundings, *, wide: bool
) -> tuple[tuple[Side, ...], Options | None]:
    """The first families with an option that has room to turn at both ends; the first where none has."""
    for sides in families(region, sensor, height_m, wide=wide):
        for step_rad, count in FINER:
            angles_rad = headings(region, sides, step_rad, around)
            options = make_options(sides, angles_rad, np.linspace(0.0, 1.0, count), around)
            if options is not None and _with_room(options, around).any():
                return sides, options
    return _some(region, sensor, height_m, around, wide=wide)


def _with_room(options: Options, around: Surroundings) -> NDArray[np.bool_]:
    """Which options have room for a full turn at both ends."""
    return roomy(options.entries, around) & roomy(options.exits, around)


def _passes(options: Options) -> NDArray[np.int64]:
    """How many passes each option takes."""
    of_sweeps = (options.lanes >= 0).sum(axis=1)
    of_others = np.where(np.isnan(options.eta_second), 1, 2)
    return np.asarray(np.where(of_sweeps > 0, of_sweeps, of_others), dtype=np.int64)


def _cheapest(options: Options) -> Ends:
    kept = np.argsort(options.inner_m, kind="stable")[:OPTIONS_COMPARED]
    return options.entries[kept], options.exits[kept], options.inner_m[kept]


def _near(etas: list[float], step: float) -> Floats:
    steps = step * np.arange(-NEAR_ETAS, NEAR_ETAS + 1)
    around = [np.clip(eta + steps, 0.0, 1.0) for eta in etas if not math.isnan(eta)]
    return np.unique(np.concatenate(around))
