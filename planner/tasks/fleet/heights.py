"""Legs of a flight flown at another height than the passes that they lie between.

The line over the ground stays, and so do passes with the level run before them. A leg is left as it is where
it is too short to go up and down in, where it has circles, where the height is not within the scenario's
band, or where anything, hard or soft, reaches what is changed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from planner.airspace.zones import TRANSIT_MARGIN_M, keep_out
from planner.metrics import used
from planner.profile.change import SPOT_M, STRAIGHT_UP_RAD
from planner.profile.compose import Composed, times_of
from planner.profile.ends import LEVEL_OFF_S, climb_slope_rad, sink_slope_rad
from planner.profile.flight import whole_flight
from planner.profile.heights import SAME_M, Heights, tidy
from planner.profile.lines import cut
from planner.tasks.fleet.crews import Crew
from planner.tasks.fleet.flown import Flown
from planner.vehicle.manners import LIFT_OFF_HEIGHT_M
from planner.vehicle.model import FlightModel

#: Legs with whole circles are not changed: what is flown for height, or to wait, stays where it is.
CIRCLE_RAD = math.tau - 1e-6
#: A height is in a band, and clear of the ground, if it is out of it by no more than this.
ROUNDING_M = 1e-6

Knots = tuple[tuple[float, float], ...]


def at_heights(crew: Crew, flown: Flown, legs_m: Mapping[int, float]) -> Flown | None:
    """A flight with some of its legs at other altitudes; None where one of them cannot be.

    Parameters
    ----------
    flown
        With all of its legs as they are flown without.
    legs_m
        By the number of a leg, its altitude over the flight's datum.
    """
    flight, composed = flown.composed.flight, flown.composed
    model, level = crew.setting.model, crew.setting.level
    if crew.alone.band is None or crew.setting.following is not None:
        return None
    # From the last to the first: what is before a leg stays where it is.
    knots = flight.heights.knots
    for number in sorted(legs_m, reverse=True):
        leg = _Leg.of(composed, number, model)
        changed = None if leg is None else leg.at(legs_m[number])
        if leg is None or changed is None:
            return None
        before = tuple(knot for knot in knots if knot[0] < leg.first_m - SAME_M)
        if leg.from_ground:
            before = knots[:1]
        behind = tuple(knot for knot in knots if knot[0] > leg.last_m + SAME_M)
        if leg.to_ground:
            behind = knots[-1:]
        knots = (*before, *changed, *behind)
        if not _allowed(leg, changed, composed, crew):
            return None
    times = times_of(model, level.amsl_m - level.altitude_m)
    passes_m, heights = composed.passes_m, Heights(tidy(knots))
    new = whole_flight(
        flight.path, heights, flight.bounds_m, passes_m, flight.inserted_m, times, LIFT_OFF_HEIGHT_M
    )
    return _with(flown, replace(composed, flight=new), crew)


def _with(flown: Flown, composed: Composed, crew: Crew) -> Flown:
    """The same flight, its times and what it uses by another line."""
    old, new = flown.composed.flight, composed.flight
    marks_m = [mark_m for span in composed.passes_m for mark_m in span]
    before_s = [old.along(mark_m)[1] for mark_m in marks_m]
    now_s = [new.along(mark_m)[1] for mark_m in marks_m]
    spans_s = tuple(
        (float(np.interp(begin_s, before_s, now_s)), float(np.interp(end_s, before_s, now_s)))
        for begin_s, end_s in flown.spans_s
    )
    setting = crew.setting
    return replace(flown, composed=composed, spans_s=spans_s, use=used(new, setting.model, setting.level))


def _bounds(crew: Crew) -> tuple[float, float]:
    """Heights over ground that legs may have: those of a band, or of the passes where it leaves one open."""
    band, level = crew.alone.band, crew.setting.level
    low_m = level.lowest.height_m if band is None or band.low_m is None else band.low_m
    high_m = level.height_m if band is None or band.high_m is None else band.high_m
    return max(low_m, crew.setting.airspace.over_ground_m), high_m


@dataclass(frozen=True, slots=True)
class _Leg:
    """What of a leg may be flown at another height.

    Parameters
    ----------
    first_m, last_m
        Distances over the ground along the whole flight, between which it may go up and down.
    begin_m, end_m
        Altitudes there.
    up, down
        Metres of height by metres over the ground; infinity on the spot.
    from_ground, to_ground
        Whether it begins with a climb on the spot from the ground, or ends with a descent there.
    """

    first_m: float
    last_m: float
    begin_m: float
    end_m: float
    up: float
    down: float
    from_ground: bool
    to_ground: bool

    @classmethod
    def of(cls, composed: Composed, number: int, model: FlightModel) -> _Leg | None:
        """That of a flight; None of one with circles, or one that is short."""
        flight, hovers = composed.flight, model.aircraft.type == "multirotor"
        first_m, last_m = composed.legs_m[number]
        knots = flight.heights.knots
        from_ground = hovers and number == 0 and knots[1][0] <= SAME_M
        to_ground = hovers and number == len(composed.legs_m) - 1 and _on_the_spot(knots)
        up, down = math.tan(climb_slope_rad(model)), math.tan(sink_slope_rad(model))
        if hovers:
            slope_rad = math.radians(model.max_climb_deg)
            up = down = math.inf if slope_rad >= STRAIGHT_UP_RAD else math.tan(slope_rad)
            near_m = SPOT_M if math.isinf(up) else 0.0
            first_m += 0.0 if from_ground else near_m
            last_m -= 0.0 if to_ground else near_m
        if number < len(composed.passes_m):
            last_m -= model.settle_m + (0.0 if hovers else LEVEL_OFF_S * model.airspeed_m_s)
        if last_m - first_m <= SAME_M:
            return None
        circles = any(abs(s.turn_rad) >= CIRCLE_RAD for s in cut(flight.path, first_m, last_m).segments)
        if circles:
            return None
        begin_m, end_m = flight.heights.at([first_m + 2.0 * SAME_M, last_m - 2.0 * SAME_M]).tolist()
        return cls(first_m, last_m, begin_m, end_m, up, down, from_ground, to_ground)

    def at(self, altitude_m: float) -> Knots | None:
        """Its altitudes where it goes to one at once, and leaves it late; None where it is too short."""
        to_m = 0.0 if self.from_ground else self._run_m(self.begin_m, altitude_m)
        back_m = 0.0 if self.to_ground else self._run_m(altitude_m, self.end_m)
        if self.first_m + to_m >= self.last_m - back_m - SAME_M:
            return None
        begin_m = altitude_m if self.from_ground else self.begin_m
        end_m = altitude_m if self.to_ground else self.end_m
        return (
            (self.first_m, begin_m),
            (self.first_m + to_m, altitude_m),
            (self.last_m - back_m, altitude_m),
            (self.last_m, end_m),
        )

    def _run_m(self, from_m: float, to_m: float) -> float:
        return abs(to_m - from_m) / (self.up if to_m > from_m else self.down)


def _on_the_spot(knots: Knots) -> bool:
    return knots[-1][0] - knots[-2][0] <= SAME_M


def _allowed(leg: _Leg, new: Knots, composed: Composed, crew: Crew) -> bool:
    """Whether a leg with new heights is clear of everything, and in the band where it is level."""
    airspace, level = crew.setting.airspace, crew.setting.level
    path = composed.flight.path
    # What goes up or down on the spot at an end comes there from the height flown before.
    ways = [((leg.first_m, leg.begin_m), new[1]), (new[1], new[2]), (new[2], (leg.last_m, leg.end_m))]
    for (from_m, one_m), (until_m, other_m) in ways:
        low, high = (level.at(altitude_m) for altitude_m in sorted((one_m, other_m)))
        zones = keep_out(airspace, high, TRANSIT_MARGIN_M, lowest=low)
        if not zones.clear(cut(path, from_m, max(until_m, from_m + SAME_M))):
            return False
    altitude_m, (low_m, high_m) = new[1][1], _bounds(crew)
    ground = airspace.terrain
    if ground is None:
        height_m = altitude_m - (level.altitude_m - level.height_m)
        return low_m - ROUNDING_M <= height_m <= high_m + ROUNDING_M
    points = cut(path, leg.first_m, leg.last_m).sample(ground.step_m / 2.0, ground.step_m / 2.0)
    along_m = leg.first_m + points[:, 3]
    grounds_m = ground.at(points[:, :2]) - (level.amsl_m - level.altitude_m)
    flat = (new[1][0] <= along_m) & (along_m <= new[2][0])
    over_m = altitude_m - grounds_m[flat]
    # Nearer to the ground than is kept over it only where, and as far as, it is without.
    before_m, now_m = (each.at(along_m) - grounds_m for each in (composed.flight.heights, Heights(new)))
    clear = np.all(now_m >= np.minimum(airspace.over_ground_m, before_m) - ROUNDING_M)
    return bool(clear and np.all((low_m - ROUNDING_M <= over_m) & (over_m <= high_m + ROUNDING_M)))
