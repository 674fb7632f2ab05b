"""Lateral and vertical guidance of the simulated aircraft.

The lateral law is that of S. Park, J. Deyst and J. P. How, "A New Nonlinear Guidance Logic for Trajectory
Tracking" (AIAA GNC 2004): the acceleration across the track that leads on a circle through a reference point
at distance L1 ahead on the path, a = 2 V^2 / L1 sin(eta). About a straight line it behaves as a second-order
system of damping 1/sqrt(2) and natural frequency sqrt(2) V / L1, so a period T fixes L1 = V T / (sqrt(2) pi).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from mavlink.sim.dynamics import GRAVITY_M_S2, AircraftState, FlightCommand
from mavlink.sim.geodesy import Place, offset_m, wrap_rad

_LEAST_L1_M = 15.0


@dataclass(frozen=True, slots=True)
class Tuning:
    """How tightly the aircraft steers.

    Parameters
    ----------
    l1_period_s
        Period of the lateral response; small is tight.
    altitude_lag_s
        An altitude error is flown away at ``error / altitude_lag_s``.
    """

    l1_period_s: float
    max_bank_rad: float
    altitude_lag_s: float = 2.0

    def l1_m(self, ground_speed_m_s: float) -> float:
        """Distance of the reference point."""
        return max(ground_speed_m_s * self.l1_period_s / (math.sqrt(2.0) * math.pi), _LEAST_L1_M)


class Pursuit:
    """Banks towards a reference point; remembers the side it turned to when the point is straight behind."""

    def __init__(self, tuning: Tuning) -> None:
        self._tuning = tuning
        self._side = 1.0

    def bank_rad(self, state: AircraftState, north_m: float, east_m: float) -> float:
        """Bank that leads towards a point given relative to the aircraft."""
        speed_m_s = state.ground_speed_m_s
        course_rad = math.atan2(state.east_m_s, state.north_m_s) if speed_m_s > 3.0 else state.heading_rad
        l1_m = self._tuning.l1_m(speed_m_s)
        eta_rad = wrap_rad(math.atan2(east_m, north_m) - course_rad)
        # Straight behind, the sign of eta is noise: keep turning the way we turn.
        if abs(eta_rad) > 2.6:
            eta_rad = self._side * abs(eta_rad)
        self._side = math.copysign(1.0, eta_rad)
        eta_rad = min(max(eta_rad, -0.5 * math.pi), 0.5 * math.pi)
        reach_m = min(max(math.hypot(north_m, east_m), 0.5 * l1_m), l1_m)
        lateral_m_s2 = 2.0 * speed_m_s**2 / reach_m * math.sin(eta_rad)
        # Lift turns the air velocity; only its share across the ground track counts while crabbing.
        crab = max(math.cos(wrap_rad(state.heading_rad - course_rad)), 0.3)
        limit = self._tuning.max_bank_rad
        return min(max(math.atan(lateral_m_s2 / (GRAVITY_M_S2 * crab)), -limit), limit)


def climb_towards_m_s(
    tuning: Tuning, altitude_m: float, wanted_m: float, slope_climb_m_s: float = 0.0
) -> float:
    """Climb rate that closes an altitude error, on top of the path's own slope."""
    return slope_climb_m_s + (wanted_m - altitude_m) / tuning.altitude_lag_s


class PolylineFollower:
    """Flies a polyline, looking past its corners so that arcs given as waypoints are flown as arcs.

    The reference point lies L1 ahead along the polyline, not along the present leg. A vertex is passed when
    the aircraft crosses the line that bisects its corner, or comes within the vertex's acceptance distance of
    that line.

    Parameters
    ----------
    vertices
        The first is where the first leg starts.
    """

    def __init__(self, tuning: Tuning, vertices: Sequence[Place]) -> None:
        self._tuning = tuning
        self._pursuit = Pursuit(tuning)
        self._vertices = list(vertices)
        self._directions = [_direction(a, b) for a, b in pairwise(self._vertices)]
        self._leg = 0
        self.cross_track_m = 0.0
        self.wanted_altitude_m = self._vertices[0].altitude_m
        self.slope_climb_m_s = 0.0

    @property
    def target(self) -> Place:
        """The vertex being flown to."""
        return self._vertices[self._leg + 1]

    @property
    def finished(self) -> bool:
        """Whether the last vertex has been passed."""
        return self._leg + 1 >= len(self._vertices)

    def passed(self, state: AircraftState, acceptance_m: float = 0.0) -> bool:
        """Whether the vertex being flown to is passed; steps on to the next leg if so."""
        b_n, b_e = self._to(state, self._leg + 1)
        u_n, u_e, _ = self._directions[self._leg]
        if self._leg + 2 < len(self._vertices):
            v_n, v_e, _ = self._directions[self._leg + 1]
            # A reversal has no bisector worth the name: there the end of the inbound leg counts.
            if math.hypot(u_n + v_n, u_e + v_e) > 0.5:
                u_n, u_e = u_n + v_n, u_e + v_e
        scale = math.hypot(u_n, u_e)
        if scale > 0.0 and (b_n * u_n + b_e * u_e) / scale > acceptance_m:
            return False
        self._leg += 1
        return True

    def distance_to_target_m(self, state: AircraftState) -> float:
        """Straight distance to the vertex being flown to; to the last one once that is passed."""
        return math.hypot(*self._to(state, min(self._leg + 1, len(self._vertices) - 1)))

    def bank_rad(self, state: AircraftState) -> float:
        """Bank for this instant; updates cross-track error, wanted altitude and slope."""
        l1_m = self._tuning.l1_m(state.ground_speed_m_s)
        a_n, a_e = self._to(state, self._leg)
        b_n, b_e = self._to(state, self._leg + 1)
        u_n, u_e, length_m = self._directions[self._leg]
        along_m = -(a_n * u_n + a_e * u_e)
        self.cross_track_m = a_n * u_e - a_e * u_n
        off_m = abs(self.cross_track_m)
        # Far off, aim at 45 degrees to the line; near it, at the point of the line at distance L1.
        look_m = max(math.sqrt(max(l1_m**2 - off_m**2, 0.0)), off_m)
        self._set_altitude(state, along_m, length_m)
        beyond_m = along_m + look_m - length_m
        if beyond_m > 0.0:
            north_m, east_m = self._past_corner(state, min(beyond_m, l1_m))
        elif length_m > 0.0:
            north_m, east_m = a_n + (along_m + look_m) * u_n, a_e + (along_m + look_m) * u_e
        else:
            north_m, east_m = b_n, b_e
        return self._pursuit.bank_rad(state, north_m, east_m)

    def command(self, state: AircraftState, airspeed_m_s: float) -> FlightCommand:
        """Bank and climb for this instant."""
        bank_rad = self.bank_rad(state)
        climb_m_s = climb_towards_m_s(
            self._tuning, state.altitude_m, self.wanted_altitude_m, self.slope_climb_m_s
        )
        return FlightCommand(bank_rad, airspeed_m_s, climb_m_s)

    def _past_corner(self, state: AircraftState, beyond_m: float) -> tuple[float, float]:
        leg = self._leg + 1
        while leg + 1 < len(self._vertices):
            u_n, u_e, length_m = self._directions[leg]
            if beyond_m <= length_m:
                n, e = self._to(state, leg)
                return n + beyond_m * u_n, e + beyond_m * u_e
            beyond_m -= length_m
            leg += 1
        u_n, u_e, _ = self._directions[len(self._vertices) - 2]
        n, e = self._to(state, len(self._vertices) - 1)
        return n + beyond_m * u_n, e + beyond_m * u_e

    def _set_altitude(self, state: AircraftState, along_m: float, length_m: float) -> None:
        start_m, end_m = self._vertices[self._leg].altitude_m, self._vertices[self._leg + 1].altitude_m
        if length_m <= 0.0:
            self.wanted_altitude_m, self.slope_climb_m_s = end_m, 0.0
            return
        share = along_m / length_m
        self.wanted_altitude_m = start_m + (end_m - start_m) * min(max(share, 0.0), 1.0)
        inside = 0.0 <= share <= 1.0
        self.slope_climb_m_s = (end_m - start_m) / length_m * state.ground_speed_m_s if inside else 0.0

    def _to(self, state: AircraftState, vertex: int) -> tuple[float, float]:
        place = self._vertices[vertex]
        return offset_m(state.lat_deg, state.lon_deg, place.lat_deg, place.lon_deg)


def _direction(a: Place, b: Place) -> tuple[float, float, float]:
    """Unit vector (north, east) and length of a leg; zero for vertices on one spot."""
    north_m, east_m = offset_m(a.lat_deg, a.lon_deg, b.lat_deg, b.lon_deg)
    length_m = math.hypot(north_m, east_m)
    if length_m < 0.01:
        return 0.0, 0.0, 0.0
    return north_m / length_m, east_m / length_m, length_m


class CircleFollower:
    """Flies a circle: along its tangent from outside, then with the reference point L1 ahead on it.

    Parameters
    ----------
    radius_m
        Positive is clockwise seen from above, as in MAV_CMD_NAV_LOITER_TURNS.
    """

    def __init__(self, tuning: Tuning, centre: Place, radius_m: float) -> None:
        self._tuning = tuning
        self._pursuit = Pursuit(tuning)
        self._centre = centre
        self._radius_m = abs(radius_m)
        self._turning = 1.0 if radius_m >= 0.0 else -1.0
        self._bearing_rad: float | None = None
        self.turned_rad = 0.0
        self.established = False

    def bank_rad(self, state: AircraftState) -> float:
        """Bank for this instant; counts the angle flown since the circle was reached."""
        c_n, c_e = offset_m(state.lat_deg, state.lon_deg, self._centre.lat_deg, self._centre.lon_deg)
        from_centre_m = math.hypot(c_n, c_e)
        l1_m = min(self._tuning.l1_m(state.ground_speed_m_s), self._radius_m)
        bearing_rad = math.atan2(-c_e, -c_n) if from_centre_m > 1.0 else state.heading_rad
        self.established = self.established or abs(from_centre_m - self._radius_m) < 0.5 * l1_m
        if self.established and self._bearing_rad is not None:
            self.turned_rad += self._turning * wrap_rad(bearing_rad - self._bearing_rad)
        self._bearing_rad = bearing_rad
        # The chord to the point L1 ahead spans 2 asin(L1 / 2R) at the centre.
        ahead_rad = 2.0 * math.asin(l1_m / (2.0 * self._radius_m))
        if from_centre_m > self._radius_m:
            ahead_rad = max(ahead_rad, math.acos(self._radius_m / from_centre_m))
        aim_rad = bearing_rad + self._turning * ahead_rad
        north_m = c_n + self._radius_m * math.cos(aim_rad)
        east_m = c_e + self._radius_m * math.sin(aim_rad)
        return self._pursuit.bank_rad(state, north_m, east_m)

    def course_error_rad(self, state: AircraftState, place: Place) -> float:
        """How far the circle's course abeam of the aircraft is from the one that it is left on for a place.

        As ArduPlane reckons: from a point of the circle straight to a place outside it; a place
        inside is left for a little before it is abeam. Source: ``ModeLoiter::isHeadingLinedUp``.
        """
        c_n, c_e = offset_m(state.lat_deg, state.lon_deg, self._centre.lat_deg, self._centre.lon_deg)
        at_rad = math.atan2(-c_e, -c_n)
        p_n, p_e = offset_m(self._centre.lat_deg, self._centre.lon_deg, place.lat_deg, place.lon_deg)
        inside_m = self._radius_m - math.hypot(p_n, p_e)
        if inside_m > 0.0:
            early_rad = 2.0 * math.asin(inside_m / (2.0 * self._radius_m))
            wanted_rad = math.atan2(p_e, p_n) + self._turning * (0.5 * math.pi - early_rad)
        else:
            north_m = p_n - self._radius_m * math.cos(at_rad)
            east_m = p_e - self._radius_m * math.sin(at_rad)
            wanted_rad = math.atan2(east_m, north_m)
        return abs(wrap_rad(at_rad + self._turning * 0.5 * math.pi - wanted_rad))
