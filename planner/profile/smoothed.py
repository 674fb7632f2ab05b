"""How long the stretches of a flight take what hovers under PX4, which smooths its way from place to place.

Its speed over the ground is held under what lets it brake for the place ahead, and for the next one as if it
had to stop there; a corner is passed on the circle that touches both lines where it takes up the next place.
Sources: PX4 v1.16, ``TrajectoryConstraints.hpp``, ``TrajMath.hpp`` (``computeMaxSpeedFromDistance``,
``computeMaxSpeedInWaypoint``) and ``FlightTaskAuto.cpp``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby, pairwise

from planner.airspace.values import STILL_AIR, Wind
from planner.profile.flight import Stretch
from planner.profile.times import spots_s
from planner.vehicle.jerks import HALVINGS, change_m, change_s, chords_of, corners_of, is_corner
from planner.vehicle.manners import ONE_PLACE_M, Manners
from planner.vehicle.wind import held_speed_m_s

#: Straights are one where they differ by no more.
SAME_WAY_RAD = 1e-6
#: Up to this angle off its way it does not hold its speed in for turning (its cosine is 0.98).
NO_TURN_RAD = math.acos(0.98)


@dataclass(frozen=True, slots=True)
class _Leg:
    """A straight between two places of a mission.

    Parameters
    ----------
    number, corner
        Of its stretch, and of that which is the corner before it.
    joins
        Whether it is what a corner adds to the straight beside it.
    """

    number: int
    length_m: float
    angle_rad: float
    most_m_s: float
    corner: int | None = None
    joins: bool = False


@dataclass(frozen=True, slots=True)
class Braking:
    """What a speed is limited by on the way to a place; it counts as reached from ``short_m`` on."""

    accel_m_s2: float
    jerk_m_s3: float
    short_m: float

    @property
    def slack_m_s(self) -> float:
        """It counts on braking no sooner than the acceleration has changed from one limit to the other."""
        return 4.0 * self.accel_m_s2**2 / self.jerk_m_s3

    def most_m_s(self, distance_m: float, end_m_s: float) -> float:
        """Fastest at a distance from a place to be passed at a speed: v² + slack v = 2 a d + end²."""
        b, c = self.slack_m_s, 2.0 * self.accel_m_s2 * distance_m + end_m_s**2
        return max(0.5 * (math.sqrt(b**2 + 4.0 * c) - b), end_m_s)

    def distance_m(self, speed_m_s: float, end_m_s: float) -> float:
        """From where on a speed is too fast, until the place counts as reached."""
        if speed_m_s <= end_m_s:
            return 0.0
        over = speed_m_s**2 + self.slack_m_s * speed_m_s - end_m_s**2
        return max(over / (2.0 * self.accel_m_s2) - self.short_m, 0.0)

    def time_s(self, speed_m_s: float, end_m_s: float) -> float:
        """Seconds for that distance: dt = (2 + slack / v) dv / (2 a), then at the end's speed."""
        if speed_m_s <= end_m_s:
            return 0.0
        last_m_s = min(self.most_m_s(self.short_m, end_m_s), speed_m_s)
        slowing_s = (speed_m_s - last_m_s) / self.accel_m_s2
        slowing_s += self.slack_m_s / (2.0 * self.accel_m_s2) * math.log(speed_m_s / last_m_s)
        if last_m_s > end_m_s:
            return slowing_s
        return slowing_s + max(self.slack_m_s / (2.0 * self.accel_m_s2) - self.short_m / end_m_s, 0.0)


def smoothed_times(
    stretches: Sequence[Stretch], airspeed_m_s: float, manners: Manners, wind: Wind = STILL_AIR
) -> list[float]:
    """Seconds of each stretch: at rest before and behind every climb and descent on the spot."""
    found = spots_s(stretches, partial(_shares_s, manners=manners))
    numbered = enumerate(stretches)
    for on_the_spot, run in groupby(numbered, key=lambda pair: pair[1].segment is None):
        if not on_the_spot:
            legs = _met([leg for k, s in run for leg in _legs(k, s, airspeed_m_s, manners, wind)])
            for leg, (turning_s, straight_s) in zip(legs, _legs_s(legs, manners), strict=True):
                found[leg.number if leg.corner is None else leg.corner] += turning_s
                found[leg.number] += straight_s
    return found


def _legs_s(legs: Sequence[_Leg], manners: Manners) -> list[tuple[float, float]]:
    """Seconds of legs that follow each other, from rest to a stop: turning into each, and along it."""
    braking = Braking(manners.accel_m_s2, manners.jerk_m_s3, manners.corner_m)
    corners = [_corner_m_s(here, behind, braking, manners) for here, behind in pairwise(legs)]
    found: list[tuple[float, float]] = []
    passed_m_s, turn_m = 0.0, 0.0
    for k, leg in enumerate(legs):
        last = k == len(legs) - 1
        end_m_s = 0.0 if last else corners[k]
        # Places are taken up early: only the first leg is the shorter for it.
        length_m = max(leg.length_m - (braking.short_m if k == 0 else 0.0), 0.0)
        turning_s, straight_s, passed_m_s = _leg_s(
            length_m, passed_m_s, end_m_s, turn_m, leg.most_m_s, braking
        )
        found.append((turning_s, straight_s))
        turn_m = 0.0 if last else _turn_m(_turned_rad(leg, legs[k + 1]), braking.short_m)
    return found


def _legs(number: int, stretch: Stretch, airspeed_m_s: float, manners: Manners, wind: Wind) -> list[_Leg]:
    """The straights that a stretch is flown by."""
    segment = stretch.segment
    if segment is None:
        return []
    corner = segment.kind != "straight" and is_corner(segment.radius_m)
    if stretch.ground_m < manners.corner_m + ONE_PLACE_M and not corner:
        return []
    rise_m = stretch.end_altitude_m - stretch.start_altitude_m
    rate = manners.climb_m_s if rise_m > 0.0 else manners.sink_m_s
    steep_m_s = rate * stretch.ground_m / abs(rise_m) if abs(rise_m) > 0.0 else math.inf

    def leg(length_m: float, angle_rad: float) -> _Leg:
        held_m_s = float(held_speed_m_s(angle_rad, airspeed_m_s, wind, manners.sharing))
        return _Leg(number, length_m, angle_rad, min(held_m_s, steep_m_s, stretch.most_m_s))

    if segment.kind == "straight":
        return [leg(segment.length_m, segment.start.angle_rad)]
    if corner:
        count, tangent_m = corners_of(abs(segment.turn_rad), segment.radius_m)
        angles = [segment.start.angle_rad + segment.turn_rad * k / count for k in range(count + 1)]
        between = [replace(leg(2.0 * tangent_m, angle), corner=number) for angle in angles[1:-1]]
        return [
            replace(leg(tangent_m, angles[0]), joins=True),
            *between,
            replace(leg(tangent_m, angles[-1]), joins=True, corner=number),
        ]
    count = chords_of(abs(segment.turn_rad), segment.radius_m)
    step_rad = segment.turn_rad / count
    chord_m = 2.0 * segment.radius_m * math.sin(0.5 * abs(step_rad))
    first_rad = segment.start.angle_rad + 0.5 * step_rad
    return [leg(chord_m, first_rad + k * step_rad) for k in range(count)]


def _met(legs: Sequence[_Leg]) -> list[_Leg]:
    """Legs with what corners add to the straights beside them."""
    found: list[_Leg] = []
    for leg in legs:
        last = found[-1] if found else None
        if last is None or not (last.joins or leg.joins) or _turned_rad(last, leg) > SAME_WAY_RAD:
            found.append(leg)
            continue
        kept = last if last.length_m >= leg.length_m else leg
        found[-1] = replace(
            kept,
            length_m=last.length_m + leg.length_m,
            most_m_s=min(last.most_m_s, leg.most_m_s),
            corner=last.corner,
            joins=leg.joins and last.joins,
        )
    return found


def _turned_rad(leg: _Leg, behind: _Leg) -> float:
    return abs(math.remainder(behind.angle_rad - leg.angle_rad, math.tau))


def _corner_m_s(leg: _Leg, behind: _Leg, braking: Braking, manners: Manners) -> float:
    """Speed at the place between two legs; it stops where the second one is shorter than it is early."""
    if behind.length_m < braking.short_m:
        return 0.0
    accel = manners.corner_share * braking.accel_m_s2
    half_rad = max(0.5 * _turned_rad(leg, behind), 1e-6)
    return min(
        leg.most_m_s,
        behind.most_m_s,
        math.sqrt(accel * braking.short_m / math.tan(half_rad)),
        braking.most_m_s(behind.length_m, 0.0),
    )


def _turn_m(turned_rad: float, early_m: float) -> float:
    """Length of the arc that touches both lines of a corner as far from it as the place is taken up early."""
    return 0.0 if turned_rad < NO_TURN_RAD else early_m * turned_rad / math.tan(0.5 * turned_rad)


def _leg_s(
    length_m: float, from_m_s: float, end_m_s: float, turn_m: float, most_m_s: float, braking: Braking
) -> tuple[float, float, float]:
    """Seconds of a leg turning, no faster than before, and straight; and the speed it is left at."""
    turn_m = min(turn_m, length_m) if from_m_s > 0.0 else 0.0
    turning_s = turn_m / from_m_s if turn_m > 0.0 else 0.0
    free_m = length_m - turn_m
    left_m_s = braking.most_m_s(braking.short_m, end_m_s)

    def needed_m(peak_m_s: float) -> float:
        speeding_m = change_m(from_m_s, peak_m_s, braking.accel_m_s2, braking.jerk_m_s3)
        return speeding_m + braking.distance_m(peak_m_s, end_m_s)

    low, high = from_m_s, most_m_s
    if needed_m(low) >= free_m:
        left_m_s = min(left_m_s, from_m_s) if from_m_s > 0.0 else left_m_s
        return turning_s, free_m / (0.5 * (from_m_s + left_m_s)), left_m_s
    if needed_m(high) > free_m:
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if needed_m(middle) <= free_m else (low, middle)
        high = low
    speeding_s = change_s(from_m_s, high, braking.accel_m_s2, braking.jerk_m_s3)
    cruising_s = (free_m - needed_m(high)) / high
    return turning_s, speeding_s + cruising_s + braking.time_s(high, end_m_s), min(left_m_s, high)


def _shares_s(together: Sequence[Stretch], manners: Manners) -> list[float]:
    """Seconds of climbs on the spot that follow each other."""
    foot_m, top_m = together[0].start_altitude_m, together[-1].end_altitude_m
    if {"take_off", "landing"}.isdisjoint({together[0].phase, together[-1].phase}):
        total_s = change_of_height_s(top_m - foot_m, manners)
    elif top_m < foot_m:
        total_s = descent_s(foot_m - top_m, manners)
    else:
        ends_m = [foot_m, *(s.end_altitude_m for s in together)]
        until_s = [climb_s(end_m - foot_m, top_m - foot_m, manners) for end_m in ends_m]
        return [ended_s - begun_s for begun_s, ended_s in pairwise(until_s)]
    return [total_s * s.length_m / abs(top_m - foot_m) for s in together]


def change_of_height_s(rise_m: float, manners: Manners) -> float:
    """Seconds of a climb or descent on the spot in flight, until the height counts as reached."""
    rate = manners.climb_m_s if rise_m > 0.0 else manners.sink_m_s
    braking = Braking(manners.vertical_accel_m_s2, manners.jerk_m_s3, manners.height_reached_m)
    length_m = max(abs(rise_m) - manners.height_reached_m, 0.0)
    return _leg_s(length_m, 0.0, 0.0, 0.0, rate, braking)[1] if length_m > 0.0 else 0.0


def climb_s(height_m: float, top_m: float, manners: Manners) -> float:
    """Seconds from the ground to a height on the way up to the top: slowly first, braking for the top."""
    slow_m_s, slow_accel = manners.take_off_m_s, manners.take_off_accel_m_s2
    low_m = min(height_m, manners.take_off_below_m)
    ramp_m = slow_m_s**2 / (2.0 * slow_accel)
    if low_m < ramp_m:
        return math.sqrt(2.0 * low_m / slow_accel)
    low_s = slow_m_s / slow_accel + (low_m - ramp_m) / slow_m_s
    if height_m <= manners.take_off_below_m:
        return low_s
    braking = Braking(manners.vertical_accel_m_s2, manners.jerk_m_s3, manners.height_reached_m)
    above_m = max(top_m - manners.take_off_below_m - manners.height_reached_m, 0.0)
    _, above_s, _ = _leg_s(above_m, slow_m_s, 0.0, 0.0, manners.climb_m_s, braking)
    return low_s + above_s * (height_m - manners.take_off_below_m) / (top_m - manners.take_off_below_m)


def descent_s(height_m: float, manners: Manners) -> float:
    """Seconds down to the ground, the speed falling between two heights to that of touching down."""
    slow_m = min(height_m, manners.land_below_m)
    falling_m = min(height_m, manners.land_from_m) - slow_m
    time_s = slow_m / manners.land_m_s + (height_m - slow_m - falling_m) / manners.sink_m_s
    time_s += change_s(0.0, manners.sink_m_s, manners.vertical_accel_m_s2, manners.jerk_m_s3) / 2.0
    if falling_m > 0.0:
        gradient = (manners.sink_m_s - manners.land_m_s) / (manners.land_from_m - manners.land_below_m)
        time_s += math.log(1.0 + gradient * falling_m / manners.land_m_s) / gradient
    return time_s
