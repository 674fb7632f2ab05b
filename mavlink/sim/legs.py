"""How a multirotor flies straight lines between waypoints: corners rounded, stops where it has to stop.

A corner of angle theta is flown as the parabola that a constant acceleration makes of it, from ``b`` before
the vertex to ``b`` behind: with the unit vectors u1, u2 of the legs its points are
``-b (1 - t)^2 u1 + b t^2 u2``, and at ``t = 1/2`` it passes the vertex at ``b/2 sin(theta/2)``. How large b
is and how fast the corner is flown differs:

ArduCopter blends the braking of one leg with the acceleration of the next (``SCurve``), as long as the
vertex is passed within WPNAV_RADIUS r: ``b = 2 r / sin(theta/2)`` at most, the speed ``sqrt(2 a b)``. Each
leg is laid out from rest to rest, so no corner is faster than the middle of the shorter leg beside it: half a
leg of c takes a jerk j to v with ``c / 2 = sqrt(v^3 / j)``. A waypoint is reached abeam.

PX4 takes the corner where the next waypoint is taken up, at the acceptance radius: ``b = r``, at the speed of
the circle tangent to both legs there with half of its acceleration, ``sqrt(a r / tan(theta/2))``
(``computeMaxSpeedInWaypoint``, MPC_XY_TRAJ_P), and no faster than it could stop from at the next waypoint
(``computeMaxSpeedFromDistance``). A waypoint is reached within the radius.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from mavlink.sim.dynamics import AircraftState, FlightCommand, HoverCommand
from mavlink.sim.geodesy import Place, offset_m

#: Corners sharper than this (their bisector's length, 2 cos(theta/2)) are stopped at.
_SHARPEST = 1.0
#: Cross-track and position errors are flown away at this rate.
_POSITION_GAIN_PER_S = 0.8
_ALTITUDE_GAIN_PER_S = 0.7
#: Braking is planned with a part of the acceleration there is, the rest steers.
_BRAKING = 0.6
#: PX4's share for corners (MPC_XY_TRAJ_P), and its jerk (MPC_JERK_AUTO).
_PX4_CORNERS, _PX4_JERK_M_S3 = 0.5, 4.0
#: ArduCopter's (WPNAV_JERK).
_COPTER_JERK_M_S3 = 1.0
#: What a leg begins with must not be waited for.
_FROM_REST_M = 0.05
_ALTITUDE_REACHED_M = 2.0
#: With less way to go than this the nose stays where it points.
_YAW_FROM_M = 3.0
Vector = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Agility:
    """How a multirotor's autopilot takes its corners.

    Parameters
    ----------
    speed_m_s
        Fastest speed its corners are laid out for.
    reached_abeam
        Waypoints are reached abeam (ArduCopter), else within their radius (PX4).
    """

    speed_m_s: float
    acceleration_m_s2: float
    climb_m_s: float
    sink_m_s: float
    reached_abeam: bool


def speed_to_stop_m_s(distance_m: float, braking_m_s2: float, end_m_s: float = 0.0) -> float:
    """Fastest speed from which ``end_m_s`` is reached in a distance: proportional when near a stop."""
    distance_m = max(distance_m, 0.0)
    near_m = braking_m_s2 / _POSITION_GAIN_PER_S**2
    stop_m_s = (
        _POSITION_GAIN_PER_S * distance_m
        if distance_m < near_m
        else math.sqrt(2.0 * braking_m_s2 * (distance_m - 0.5 * near_m))
    )
    return max(stop_m_s, math.sqrt(end_m_s**2 + 2.0 * braking_m_s2 * distance_m)) if end_m_s else stop_m_s


def velocity_to(state: AircraftState, place: Place, speed_m_s: float, braking_m_s2: float) -> Vector:
    """North and east velocity straight to a place and to a stop there."""
    north_m, east_m = offset_m(state.lat_deg, state.lon_deg, place.lat_deg, place.lon_deg)
    distance_m = math.hypot(north_m, east_m)
    if distance_m < 1e-6:
        return 0.0, 0.0
    speed = min(speed_m_s, speed_to_stop_m_s(distance_m, braking_m_s2)) / distance_m
    return north_m * speed, east_m * speed


def climb_to_m_s(state: AircraftState, altitude_m: float) -> float:
    """Climb rate that closes an altitude error."""
    return _ALTITUDE_GAIN_PER_S * (altitude_m - state.altitude_m)


class LegFollower:
    """Flies legs one after the other, to a stop at the last vertex.

    Parameters
    ----------
    vertices
        The first is where the first leg starts.
    radius_m
        Acceptance radius of every vertex; the first counts for nothing.
    """

    def __init__(self, agility: Agility, vertices: Sequence[Place], radius_m: Sequence[float]) -> None:
        self._agility = agility
        self._vertices = list(vertices)
        self._radius_m = list(radius_m)
        self._directions = [_direction(a, b) for a, b in pairwise(self._vertices)]
        self._braking_m_s2 = _BRAKING * agility.acceleration_m_s2
        self._reach_m = [self._corner_reach_m(vertex) for vertex in range(len(self._vertices))]
        self._corner_m_s = [self._corner_speed_m_s(vertex) for vertex in range(len(self._vertices))]
        for leg in range(len(self._directions) - 1, 0, -1):
            whole_m = self._directions[leg][2]
            # Two corners may take up all of a short leg: what they leave is no distance to stop in, and none
            # is stood still at.
            length_m = max(whole_m - self._reach_m[leg] - self._reach_m[leg + 1], whole_m / 2.0)
            end_m_s = self._corner_m_s[leg + 1] if agility.reached_abeam else 0.0
            self._corner_m_s[leg] = min(self._corner_m_s[leg], self._most_m_s(length_m, end_m_s))
        self._leg = 0
        self.cross_track_m = 0.0

    @property
    def finished(self) -> bool:
        """Whether the last vertex has been reached."""
        return self._leg + 1 >= len(self._vertices)

    def distance_to_target_m(self, state: AircraftState) -> float:
        """Straight distance to the vertex being flown to; to the last one once that is reached."""
        return math.hypot(*self._to(state, min(self._leg + 1, len(self._vertices) - 1)))

    def passed(self, state: AircraftState, acceptance_m: float = 0.0) -> bool:
        """Whether the vertex being flown to is reached; steps on to the next leg if so.

        Parameters
        ----------
        acceptance_m
            Not looked at: every vertex has its radius.
        """
        if not self._reached(state):
            return False
        self._leg += 1
        return True

    def _reached(self, state: AircraftState) -> bool:
        vertex = self._leg + 1
        to_n, to_e = self._to(state, vertex)
        u_n, u_e, _ = self._directions[self._leg]
        if self._agility.reached_abeam and self._reach_m[vertex] > 0.0:
            v_n, v_e, _ = self._directions[vertex]
            return to_n * (u_n + v_n) + to_e * (u_e + v_e) <= 0.0
        off_m = abs(state.altitude_m - self._vertices[vertex].altitude_m)
        return math.hypot(to_n, to_e) <= self._radius_m[vertex] and off_m < _ALTITUDE_REACHED_M

    def command(self, state: AircraftState, speed_m_s: float) -> FlightCommand:
        """Velocity for this instant; updates the cross-track error."""
        leg = min(self._leg, len(self._directions) - 1)
        for vertex in (leg, leg + 1):
            hover = self._round_corner(state, vertex, speed_m_s)
            if hover is not None:
                break
        else:
            hover = self._along_leg(state, leg, speed_m_s)
        return FlightCommand(0.0, speed_m_s, self._climb_m_s(state, leg), True, None, hover)

    def _along_leg(self, state: AircraftState, leg: int, speed_m_s: float) -> HoverCommand:
        a_n, a_e = self._to(state, leg)
        b_n, b_e = self._to(state, leg + 1)
        u_n, u_e, length_m = self._directions[leg]
        self.cross_track_m = a_n * u_e - a_e * u_n
        left_m = b_n * u_n + b_e * u_e
        end = self._vertices[leg + 1]
        if left_m <= 0.0 or length_m <= 0.0:
            north, east = velocity_to(state, end, speed_m_s, self._braking_m_s2)
            return HoverCommand(north, east)
        end_m_s = self._corner_m_s[leg + 1]
        free_m = left_m - self._reach_m[leg + 1]
        speed_m_s = min(speed_m_s, self._most_m_s(free_m, end_m_s))
        speed_m_s = min(speed_m_s, self._speed_on_slope_m_s(leg))
        if self._agility.reached_abeam and self._corner_m_s[leg] == 0.0:
            # From rest: d = j t^3 / 6, v = j t^2 / 2.
            since_m = max(length_m - left_m, _FROM_REST_M)
            speed_m_s = min(speed_m_s, (4.5 * since_m**2 * _COPTER_JERK_M_S3) ** (1.0 / 3.0))
        across = _POSITION_GAIN_PER_S * self.cross_track_m
        across = min(max(across, -0.7 * speed_m_s), 0.7 * speed_m_s)
        along = math.sqrt(speed_m_s**2 - across**2)
        heading_rad = math.atan2(u_e, u_n) if length_m > _YAW_FROM_M else None
        # To the right of the leg is (-u_e, u_n).
        return HoverCommand(along * u_n + across * u_e, along * u_e - across * u_n, heading_rad=heading_rad)

    def _round_corner(self, state: AircraftState, vertex: int, speed_m_s: float) -> HoverCommand | None:
        """Velocity on the parabola of a corner; None away from it."""
        reach_m = self._reach_m[vertex]
        if reach_m <= 0.0:
            return None
        (u_n, u_e, _), (v_n, v_e, _) = self._directions[vertex - 1], self._directions[vertex]
        to_n, to_e = self._to(state, vertex)
        p_n, p_e = -to_n, -to_e
        length = math.hypot(u_n + v_n, u_e + v_e)
        bisector = ((u_n + v_n) / length, (u_e + v_e) / length)
        ahead_m = p_n * bisector[0] + p_e * bisector[1]
        t = 0.5 * (2.0 * ahead_m / (reach_m * length) + 1.0)
        if not 0.0 <= t <= 1.0:
            return None
        before, behind = 1.0 - t, t
        off_n = p_n + reach_m * (before**2 * u_n - behind**2 * v_n)
        off_e = p_e + reach_m * (before**2 * u_e - behind**2 * v_e)
        self.cross_track_m = off_e * bisector[0] - off_n * bisector[1]
        speed_m_s = min(speed_m_s, self._corner_m_s[vertex])
        if vertex + 1 == len(self._vertices) - 1 or self._corner_m_s[vertex + 1] < speed_m_s:
            free_m = self._directions[vertex][2] - behind * reach_m - self._reach_m[vertex + 1]
            speed_m_s = min(speed_m_s, self._most_m_s(free_m, self._corner_m_s[vertex + 1]))
        known = speed_m_s**2 / (2.0 * reach_m)
        back = _POSITION_GAIN_PER_S * min(1.0, speed_m_s / max(math.hypot(off_n, off_e), 1e-6))
        heading = (before * u_n + behind * v_n, before * u_e + behind * v_e)
        return HoverCommand(
            speed_m_s * heading[0] - back * off_n,
            speed_m_s * heading[1] - back * off_e,
            known * (v_n - u_n),
            known * (v_e - u_e),
            math.atan2(heading[1], heading[0]),
        )

    def _climb_m_s(self, state: AircraftState, leg: int) -> float:
        u_n, u_e, length_m = self._directions[leg]
        start_m, end_m = self._vertices[leg].altitude_m, self._vertices[leg + 1].altitude_m
        if length_m <= 0.0:
            return climb_to_m_s(state, end_m)
        to_n, to_e = self._to(state, leg + 1)
        share = 1.0 - (to_n * u_n + to_e * u_e) / length_m
        wanted_m = start_m + (end_m - start_m) * min(max(share, 0.0), 1.0)
        slope = (end_m - start_m) / length_m if 0.0 <= share <= 1.0 else 0.0
        return slope * (state.north_m_s * u_n + state.east_m_s * u_e) + climb_to_m_s(state, wanted_m)

    def _speed_on_slope_m_s(self, leg: int) -> float:
        """Fastest speed at which the leg's slope can be climbed or descended."""
        rise_m = self._vertices[leg + 1].altitude_m - self._vertices[leg].altitude_m
        vertical_m_s = self._agility.climb_m_s if rise_m > 0.0 else self._agility.sink_m_s
        return vertical_m_s * self._directions[leg][2] / abs(rise_m) if rise_m else math.inf

    def _corner_reach_m(self, vertex: int) -> float:
        """b of a vertex; 0 where it is stopped at."""
        if not 0 < vertex < len(self._vertices) - 1:
            return 0.0
        half_angle = self._half_angle_rad(vertex)
        lengths_m = (self._directions[vertex - 1][2], self._directions[vertex][2])
        if half_angle is None or min(lengths_m) <= 0.0:
            return 0.0
        radius_m, agility = self._radius_m[vertex], self._agility
        if not agility.reached_abeam:
            return min(radius_m, *(0.5 * length for length in lengths_m))
        needed_m = agility.speed_m_s**2 / (2.0 * agility.acceleration_m_s2)
        within_m = 2.0 * radius_m / max(math.sin(half_angle), 1e-9)
        return min(needed_m, within_m, *(0.5 * length for length in lengths_m))

    def _corner_speed_m_s(self, vertex: int) -> float:
        reach_m = self._reach_m[vertex]
        if reach_m <= 0.0:
            return 0.0
        a_m_s2 = self._agility.acceleration_m_s2
        if self._agility.reached_abeam:
            shortest_m = min(self._directions[vertex - 1][2], self._directions[vertex][2])
            by_jerk_m_s = (0.25 * shortest_m**2 * _COPTER_JERK_M_S3) ** (1.0 / 3.0)
            return min(math.sqrt(2.0 * a_m_s2 * reach_m), float(by_jerk_m_s))
        half_angle = self._half_angle_rad(vertex) or 0.0
        return math.sqrt(_PX4_CORNERS * a_m_s2 * reach_m / max(math.tan(half_angle), 1e-9))

    def _most_m_s(self, distance_m: float, end_m_s: float) -> float:
        """Fastest speed from which an end's speed is reached in a distance."""
        if self._agility.reached_abeam:
            return speed_to_stop_m_s(distance_m, self._braking_m_s2, end_m_s)
        # PX4 counts on its acceleration changing from one limit to the other before it brakes.
        a_m_s2 = self._agility.acceleration_m_s2
        delay_m_s = 2.0 * a_m_s2**2 / _PX4_JERK_M_S3
        most = math.sqrt(delay_m_s**2 + 2.0 * a_m_s2 * max(distance_m, 0.0) + end_m_s**2) - delay_m_s
        return max(most, end_m_s)

    def _half_angle_rad(self, vertex: int) -> float | None:
        """Half the angle turned at a vertex; None where it is sharp or a leg has no length."""
        (u_n, u_e, _), (v_n, v_e, _) = self._directions[vertex - 1], self._directions[vertex]
        bisector = math.hypot(u_n + v_n, u_e + v_e)
        return None if bisector < _SHARPEST else math.atan2(math.hypot(v_n - u_n, v_e - u_e), bisector)

    def _to(self, state: AircraftState, vertex: int) -> Vector:
        place = self._vertices[vertex]
        return offset_m(state.lat_deg, state.lon_deg, place.lat_deg, place.lon_deg)


def _direction(a: Place, b: Place) -> tuple[float, float, float]:
    """Unit vector (north, east) and length of a leg; zero for vertices on one spot."""
    north_m, east_m = offset_m(a.lat_deg, a.lon_deg, b.lat_deg, b.lon_deg)
    length_m = math.hypot(north_m, east_m)
    if length_m < 0.01:
        return 0.0, 0.0, 0.0
    return north_m / length_m, east_m / length_m, length_m
