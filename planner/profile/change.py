"""From one height to another on a leg in flight: between passes that are flown at heights of their own."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from planner.airspace.zones import KeepOut
from planner.dubins.path import Path, join
from planner.errors import InfeasibleError
from planner.profile.ends import Surround, terms_of
from planner.profile.heights import SAME_M, Heights, level, tidy
from planner.profile.lines import cut
from planner.profile.rise import Terms, climbed_leg, conflicts, turned
from planner.vehicle.model import FlightModel

#: Slopes steeper than this are straight up.
STRAIGHT_UP_RAD = math.radians(89.0)
#: What hovers changes its height so far behind one pass or before the next, where there is as much room.
SPOT_M = 20.0


@dataclass(frozen=True, slots=True)
class Changed:
    """A leg with its heights, and the length over the ground of turns flown for the sake of height."""

    path: Path
    heights: Heights
    inserted_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Layers:
    """What is kept out of at the lower of two heights, at the higher, and anywhere from one to the other."""

    bottom: KeepOut
    top: KeepOut
    between: KeepOut


def kept(leg: Path, altitude_m: float) -> Changed:
    """A leg at one altitude."""
    return Changed(leg, level(leg.length_m, altitude_m))


def changed(
    line: Callable[[KeepOut], Path],
    from_m: float,
    to_m: float,
    model: FlightModel,
    around: Surround,
    layers: Layers,
) -> Changed:
    """A leg that begins at one altitude and ends, level, at another; clear of all zones where one is found.

    The line keeps out of the zones of all heights, else of those of one, and is flown high as long as it can
    be, else low. Where it is too short wings fly whole turns, placed as those behind a take-off are; what
    hovers changes its height on the spot, near one of its ends.

    Parameters
    ----------
    line
        The leg over the ground that keeps out of zones; raises InfeasibleError.
    around
        Its top is the higher of both; its zones count anywhere between them.

    Raises
    ------
    InfeasibleError
        Where no line leads there, or there is no place for turns.
    """
    climbs = from_m < to_m
    terms = terms_of(around, model, climbs=climbs)
    best: tuple[tuple[int, int, float], Changed] | None = None
    failed: InfeasibleError | None = None
    zones = dict.fromkeys((layers.between, layers.top, layers.bottom))
    for keep_out, late in itertools.product(zones, (not climbs, climbs)):
        try:
            leg = line(keep_out)
            if model.aircraft.type == "multirotor":
                found = _hovered(leg, from_m, to_m, math.radians(model.max_climb_deg), late=late)
            else:
                found = _flown(leg, from_m, to_m, terms, late=late)
        except InfeasibleError as error:
            failed = failed or error
            continue
        hard, soft = _entered(found, layers)
        rank = (hard + terms.too_low(found.path, found.heights), soft, terms.cost_m(found.path))
        if best is None or rank < best[0]:
            best = (rank, found)
        if rank[:2] == (0, 0):
            break
    if best is None:
        raise failed or InfeasibleError("climb", "leg", "no way leads along it", "Give more room.")
    return best[1]


def _entered(found: Changed, layers: Layers) -> tuple[int, int]:
    """Hard and other zones that a leg enters at the heights it has."""
    altitudes_m = [altitude_m for _, altitude_m in found.heights.knots]
    of_height = {min(altitudes_m): layers.bottom, max(altitudes_m): layers.top}
    hard = soft = 0
    for (first_m, one_m), (last_m, other_m) in itertools.pairwise(found.heights.knots):
        zones = of_height.get(one_m, layers.between) if one_m == other_m else layers.between
        # What is climbed on the spot is some place, too.
        piece = cut(found.path, first_m, max(last_m, first_m + SAME_M))
        entered = conflicts(piece, zones)
        hard, soft = hard + entered[0], soft + entered[1]
    return hard, soft


def _flown(leg: Path, from_m: float, to_m: float, terms: Terms, *, late: bool) -> Changed:
    """With wings, as soon or as late as can be.

    All four ways are the climb that begins with the leg: flown backwards where it is late, its heights turned
    over where it then goes down.
    """
    down = (from_m > to_m) != late
    over = _turned_over(from_m, to_m) if down else _as_they_are
    bottom_m = min(from_m, to_m)
    if not late:
        climb = replace(terms, too_low=lambda path, heights: terms.too_low(path, over(heights)))
        path, heights, _ = climbed_leg(bottom_m, leg, climb)
        return Changed(path, over(heights), path.length_m - leg.length_m)
    ahead_m = leg.length_m - terms.level_off_m if leg.length_m > terms.level_off_m else leg.length_m
    climb = replace(
        terms,
        level_off_m=0.0,
        connect=lambda a, b: terms.connect(turned(b), turned(a)).reverse(),
        too_low=lambda path, heights: terms.too_low(path.reverse(), over(heights).reverse()),
    )
    back, heights, _ = climbed_leg(bottom_m, cut(leg, 0.0, ahead_m).reverse(), climb)
    path, heights = back.reverse(), over(heights).reverse()
    if leg.length_m - ahead_m > SAME_M:
        path = join(path, cut(leg, ahead_m, leg.length_m))
        heights = heights.then(level(leg.length_m - ahead_m, to_m))
    return Changed(path, heights, path.length_m - leg.length_m)


def _as_they_are(heights: Heights) -> Heights:
    return heights


def _turned_over(one_m: float, other_m: float) -> Callable[[Heights], Heights]:
    # Both ends exactly: passes are at their altitudes, not near them.
    ends = {one_m: other_m, other_m: one_m}

    def over(heights: Heights) -> Heights:
        return Heights(tuple((at_m, ends.get(up_m, one_m + other_m - up_m)) for at_m, up_m in heights.knots))

    return over


def _hovered(leg: Path, from_m: float, to_m: float, slope_rad: float, *, late: bool) -> Changed:
    """What can stop: along the leg as steeply as it may, else on the spot."""
    run_m = 0.0 if slope_rad >= STRAIGHT_UP_RAD else abs(to_m - from_m) / math.tan(slope_rad)
    if 0.0 < run_m < leg.length_m:
        since_m = leg.length_m - run_m if late else 0.0
    else:
        run_m, near_m = 0.0, min(SPOT_M, 0.5 * leg.length_m)
        since_m = leg.length_m - near_m if late else near_m
    knots = ((0.0, from_m), (since_m, from_m), (since_m + run_m, to_m), (leg.length_m, to_m))
    return Changed(leg, Heights(tidy(knots)))
