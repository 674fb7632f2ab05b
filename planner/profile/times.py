"""How long the stretches of a flight take.

Wings keep their airspeed as the autopilot measures it, the equivalent one, so through thinner air they fly
faster: by the root of the density at sea level over that at their height (standard atmosphere). What hovers
keeps a speed over the ground where its airspeed lets it (``planner.vehicle.wind.held_speed_m_s``), and brakes
before arcs to what it flies their chords with; under PX4 see ``planner.profile.smoothed``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import groupby, pairwise

import numpy as np

from planner.airspace.values import STILL_AIR, Wind
from planner.dubins.path import Path, Segment
from planner.profile.flight import Stretch
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.atmosphere import true_over_equivalent
from planner.vehicle.jerks import HALVINGS, change_m, change_s, chords_of, corners_of, is_corner
from planner.vehicle.manners import ONE_PLACE_M, Manners
from planner.vehicle.wind import duration_s, held_speed_m_s, no_headway

#: Places of an arc at which the wind is asked for.
_ALONG_ARC = (np.arange(16) + 0.5) / 16.0

#: Arcs are timed in pieces that turn by no more.
PIECE_RAD = math.radians(45.0)
#: And over which what the wind leaves of the airspeed grows by no more than this factor.
PIECE_FASTER = 1.5


def wing_times(
    stretches: Sequence[Stretch], aircraft: Aircraft, manners: Manners, wind: Wind, datum_amsl_m: float
) -> list[float]:
    """Seconds of each stretch flown on wings; hover stretches at the hover's rates."""
    on_the_spot_s = spots_s(stretches, partial(_shares_s, manners=manners))
    return [
        spot_s if s.segment is None else _held_s(s, s.segment, aircraft, datum_amsl_m, wind)
        for s, spot_s in zip(stretches, on_the_spot_s, strict=True)
    ]


def _held_s(stretch: Stretch, segment: Segment, aircraft: Aircraft, datum_amsl_m: float, wind: Wind) -> float:
    """Seconds of a stretch at one equivalent airspeed: of its pieces, averaged over their heights (Simpson).

    In a turn wind and air change together: thin where the wind is behind, it is not thin where it is ahead.

    Raises
    ------
    InfeasibleError
        ``"wind"``: in the densest air on the way it is not faster than the wind.
    """
    slope = (stretch.end_altitude_m - stretch.start_altitude_m) / stretch.ground_m
    ends_m_s = [
        aircraft.airspeed_m_s * true_over_equivalent(datum_amsl_m + at_m)
        for at_m in (stretch.start_altitude_m, stretch.end_altitude_m)
    ]
    if 0.0 < wind.speed_m_s >= min(ends_m_s):
        raise no_headway(aircraft.name, wind, min(ends_m_s))
    pieces = max(1, math.ceil(abs(segment.turn_rad) / PIECE_RAD)) if wind.speed_m_s > 0.0 else 1
    # What a wind near its airspeed leaves may be many times as much at one end as at the other.
    left = (max(ends_m_s) - wind.speed_m_s) / (min(ends_m_s) - wind.speed_m_s)
    pieces = max(pieces, math.ceil(math.log(left) / math.log(PIECE_FASTER)))
    edges_m = datum_amsl_m + np.linspace(stretch.start_altitude_m, stretch.end_altitude_m, 2 * pieces + 1)
    speeds_m_s = [aircraft.airspeed_m_s * true_over_equivalent(float(at_m)) for at_m in edges_m]
    part_m = segment.length_m / pieces
    total_s = 0.0
    for k in range(pieces):
        piece = Path((replace(segment, start=segment.at(k * part_m), length_m=part_m),))
        one_s, middle_s, other_s = (
            duration_s(piece, speed, wind, slope) for speed in speeds_m_s[2 * k : 2 * k + 3]
        )
        total_s += (one_s + 4.0 * middle_s + other_s) / 6.0
    return total_s


def spots_s(
    stretches: Sequence[Stretch], shares_s: Callable[[Sequence[Stretch]], list[float]]
) -> list[float]:
    """Seconds of each climb on the spot, 0 for others; those that follow each other are one, and share it."""
    found: list[float] = []
    for on_the_spot, run in groupby(stretches, key=lambda s: s.segment is None):
        together = list(run)
        found += shares_s(together) if on_the_spot else [0.0] * len(together)
    return found


def _shares_s(together: Sequence[Stretch], manners: Manners) -> list[float]:
    rise_m = together[-1].end_altitude_m - together[0].start_altitude_m
    total_s = spot_s(rise_m, manners, lands=together[-1].phase == "landing")
    return [total_s * s.length_m / abs(rise_m) for s in together]


def spot_s(rise_m: float, manners: Manners, *, lands: bool = True) -> float:
    """Seconds of a climb or descent on the spot, from rest to rest; a landing ends at landing speed."""
    if rise_m >= 0.0:
        return rest_to_rest_s(rise_m, manners.climb_m_s, manners.vertical_accel_m_s2)
    slow_m = min(manners.land_below_m, -rise_m) if lands else 0.0
    slow_s = slow_m / manners.land_m_s if manners.land_m_s > 0.0 else 0.0
    return rest_to_rest_s(-rise_m - slow_m, manners.sink_m_s, manners.vertical_accel_m_s2) + slow_s


def rest_to_rest_s(distance_m: float, speed_m_s: float, accel_m_s2: float) -> float:
    """Seconds for a distance from rest to rest at a limited speed and acceleration."""
    if distance_m <= speed_m_s**2 / accel_m_s2:
        return 2.0 * math.sqrt(max(distance_m, 0.0) / accel_m_s2)
    return distance_m / speed_m_s + speed_m_s / accel_m_s2


def rotor_times(
    stretches: Sequence[Stretch], airspeed_m_s: float, manners: Manners, wind: Wind = STILL_AIR
) -> list[float]:
    """Seconds of each stretch flown by what hovers: at rest at both ends of what is flown over the ground."""
    named = [s.collects for s in stretches]
    beside = [any(pair) for pair in zip([False, *named[:-1]], [*named[1:], False], strict=True)]
    limits = [
        min(_allowed_m_s(s, airspeed_m_s, manners, wind, short=short), leg_m_s, s.most_m_s)
        for s, short, leg_m_s in zip(stretches, beside, _leg_speeds_m_s(stretches, manners), strict=True)
    ]
    joints = [0.0, *(min(pair) for pair in pairwise(limits)), 0.0]
    for k, s in enumerate(stretches):
        joints[k + 1] = min(joints[k + 1], _reached_m_s(joints[k], s.ground_m, manners))
    for k in range(len(stretches) - 1, -1, -1):
        joints[k] = min(joints[k], _reached_m_s(joints[k + 1], stretches[k].ground_m, manners))
    on_the_spot_s = spots_s(stretches, partial(_shares_s, manners=manners))
    return [
        spot_s if s.segment is None else _between_s(s.length_m, joints[k], joints[k + 1], limits[k], manners)
        for k, (s, spot_s) in enumerate(zip(stretches, on_the_spot_s, strict=True))
    ]


def _leg_speeds_m_s(stretches: Sequence[Stretch], manners: Manners) -> list[float]:
    """Fastest on each straight: ArduCopter begins the next leg as this one brakes, which adds no speed to it.

    So a leg between two places of the mission is flown no faster than from rest to rest.
    """
    tangents_m = [
        corners_of(abs(s.segment.turn_rad), s.segment.radius_m)[1]
        if s.segment is not None and s.segment.kind != "straight" and is_corner(s.segment.radius_m)
        else 0.0
        for s in stretches
    ]
    beside_m = [sum(pair) for pair in zip([0.0, *tangents_m[:-1]], [*tangents_m[1:], 0.0], strict=True)]
    return [
        _reached_m_s(0.0, 0.5 * (s.ground_m + more_m), manners)
        if s.segment is not None and s.segment.kind == "straight"
        else math.inf
        for s, more_m in zip(stretches, beside_m, strict=True)
    ]


def _allowed_m_s(
    stretch: Stretch, airspeed_m_s: float, manners: Manners, wind: Wind, *, short: bool
) -> float:
    """Fastest on a stretch: what the wind, on arcs what their chords, on slopes what the rates allow.

    Parameters
    ----------
    short
        Whether it begins or ends at a place that the mission names.
    """
    if stretch.segment is None:
        return 0.0
    courses_rad = stretch.segment.start.angle_rad + stretch.segment.turn_rad * _ALONG_ARC
    # On an arc the mean of the slowness: so long it takes.
    allowed = 1.0 / float((1.0 / held_speed_m_s(courses_rad, airspeed_m_s, wind, manners.sharing)).mean())
    if stretch.segment.kind != "straight":
        turn_rad, radius_m = abs(stretch.segment.turn_rad), stretch.segment.radius_m
        arc_m_s = corner_speed_m_s if is_corner(radius_m) else chord_speed_m_s
        allowed = min(allowed, arc_m_s(turn_rad, radius_m, manners, short=short))
    rise_m = stretch.end_altitude_m - stretch.start_altitude_m
    rate = manners.climb_m_s if rise_m > 0.0 else manners.sink_m_s
    return min(allowed, rate * stretch.length_m / abs(rise_m)) if abs(rise_m) > 0.0 else allowed


def chord_speed_m_s(turn_rad: float, radius_m: float, manners: Manners, *, short: bool = False) -> float:
    """Speed along an arc that ArduCopter flies from chord to chord, as missions say it.

    It flies a chord no faster than from rest to rest, which over short ones its jerk decides: half a chord of
    c takes it to v with c / 2 = √(v³ / j).
    """
    corner_rad = turn_rad / chords_of(turn_rad, radius_m)
    chord_m = 2.0 * radius_m * math.sin(0.5 * corner_rad)
    return float((0.25 * chord_m**2 * manners.jerk_m_s3) ** (1.0 / 3.0))


def corner_speed_m_s(turn_rad: float, radius_m: float, manners: Manners, *, short: bool) -> float:
    """Speed round a corner of ArduCopter's.

    It blends the braking of one leg with the acceleration of the next where both are long, from
    b = 2 r / sin(θ / 2) before the place, that it passes within WPNAV_RADIUS, at √(2 a b) cos(θ / 2). What
    lies between such a place and another one as near is flown from rest to rest: half of it, the tangent t,
    takes it to v with t = √(v³ / j).
    """
    count, tangent_m = corners_of(turn_rad, radius_m)
    half_rad = turn_rad / (2.0 * count)
    # Half an arc from the place beside it, a single corner as near as that is that place.
    if count > 1 or (short and 0.5 * turn_rad * radius_m > ONE_PLACE_M):
        return float((tangent_m**2 * manners.jerk_m_s3) ** (1.0 / 3.0))
    blend_m = 2.0 * radius_m / math.sin(half_rad)
    return math.sqrt(2.0 * manners.accel_m_s2 * blend_m) * math.cos(half_rad)


def _change_s(from_m_s: float, to_m_s: float, manners: Manners) -> float:
    return change_s(from_m_s, to_m_s, manners.accel_m_s2, manners.jerk_m_s3)


def _change_m(from_m_s: float, to_m_s: float, manners: Manners) -> float:
    return change_m(from_m_s, to_m_s, manners.accel_m_s2, manners.jerk_m_s3)


def _reached_m_s(from_m_s: float, distance_m: float, manners: Manners) -> float:
    """Fastest at the end of a distance, found by halving."""
    low, high = from_m_s, from_m_s + math.sqrt(2.0 * manners.accel_m_s2 * distance_m) + 1e-9
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _change_m(from_m_s, middle, manners) <= distance_m else (low, middle)
    return low


def _between_s(length_m: float, from_m_s: float, to_m_s: float, most_m_s: float, manners: Manners) -> float:
    """Seconds for a length between two speeds, faster between them as far as there is room."""
    if length_m <= 0.0:
        return 0.0
    low, high = max(from_m_s, to_m_s), max(most_m_s, from_m_s, to_m_s)

    def changing_m(peak: float) -> float:
        return _change_m(from_m_s, peak, manners) + _change_m(peak, to_m_s, manners)

    if changing_m(high) > length_m:
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if changing_m(middle) <= length_m else (low, middle)
        high = low
    changing_s = _change_s(from_m_s, high, manners) + _change_s(high, to_m_s, manners)
    return changing_s + max(length_m - changing_m(high), 0.0) / max(high, 1e-6)
