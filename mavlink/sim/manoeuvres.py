"""What a fixed wing does at one time: take off, circle, go somewhere and circle, land."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Protocol

from mavlink.sim.dynamics import AircraftState, FlightCommand
from mavlink.sim.geodesy import Place, moved, offset_m, wrap_rad
from mavlink.sim.guidance import CircleFollower, PolylineFollower, Tuning, climb_towards_m_s

_LEVEL_BELOW_M = 10.0
_ALTITUDE_REACHED_M = 2.0
_ALIGNED_RAD = math.radians(10.0)
_FLARE_M = 4.0
_LOWEST_CIRCLE_M = 25.0
_TOUCHDOWN_SINK_M_S = 0.5
_STOPPED_M_S = 0.05
_APPROACH_SPEED = 0.85


class Manoeuvre(Protocol):
    """One thing to do."""

    @property
    def lands(self) -> bool:
        """Whether it ends on the ground."""

    @property
    def done(self) -> bool:
        """Whether it has ended."""

    def command(self, state: AircraftState, airspeed_m_s: float) -> FlightCommand:
        """What to do at this instant."""


class Takeoff:
    """Runs, lifts off and climbs.

    Parameters
    ----------
    towards
        Where to climb to, circling over it until high enough (PX4); None: straight on along the run
        (ArduPlane).
    pointed_at
        Where the aircraft is turned to before its run; None: as it stands.
    """

    lands = False

    def __init__(
        self,
        tuning: Tuning,
        start: AircraftState,
        altitude_m: float,
        climb_m_s: float,
        *,
        radius_m: float,
        towards: Place | None = None,
        pointed_at: Place | None = None,
    ) -> None:
        self._altitude_m = altitude_m
        self._climb_m_s = climb_m_s
        self.done = not start.on_ground and start.altitude_m >= altitude_m - _ALTITUDE_REACHED_M
        self._launch_rad = start.heading_rad
        if pointed_at is not None and start.on_ground:
            north_m, east_m = offset_m(start.lat_deg, start.lon_deg, pointed_at.lat_deg, pointed_at.lon_deg)
            self._launch_rad = math.atan2(east_m, north_m)
        end = towards
        if end is None:
            far_n, far_e = 1e4 * math.cos(self._launch_rad), 1e4 * math.sin(self._launch_rad)
            end = Place(*moved(start.lat_deg, start.lon_deg, far_n, far_e), altitude_m)
        self._line = PolylineFollower(tuning, [start.place, end])
        self._circle = CircleFollower(tuning, end, radius_m)
        self._ground_m = start.altitude_m if start.on_ground else -math.inf

    def command(self, state: AircraftState, airspeed_m_s: float) -> FlightCommand:
        """Wings level until 10 m up, then along the line or round its end."""
        if not state.on_ground and state.altitude_m >= self._altitude_m - _ALTITUDE_REACHED_M:
            self.done = True
        bank_rad = 0.0
        if state.altitude_m > self._ground_m + _LEVEL_BELOW_M:
            if not self._line.finished:
                self._line.passed(state)
            follower = self._circle if self._line.finished else self._line
            bank_rad = follower.bank_rad(state)
        climb_m_s = min(self._climb_m_s, max(self._altitude_m - state.altitude_m, 0.5))
        return FlightCommand(bank_rad, airspeed_m_s, climb_m_s, True, self._launch_rad)


class Loiter:
    """Circles until its condition holds, then, where asked, until the nose points at what comes next.

    Parameters
    ----------
    turns, seconds
        How long; both None: for ever, unless ``until_altitude``.
    exit_towards
        Leave only when flying towards this place, or after one more turn.
    by_circle
        Whether that is told by the circle's own course, as ArduPlane does, which also leaves for places
        inside; else by the aircraft's.
    """

    lands = False

    def __init__(
        self, tuning: Tuning, centre: Place, radius_m: float, *, turns: float | None = None,
        seconds: float | None = None, until_altitude: bool = False, exit_towards: Place | None = None,
        by_circle: bool = False,
    ) -> None:  # fmt: skip
        self._tuning = tuning
        self._centre = centre
        self._by_circle = by_circle
        self._circle = CircleFollower(tuning, centre, radius_m)
        self._turns = turns
        self._seconds = seconds
        self._until_altitude = until_altitude
        self._exit_towards = exit_towards
        self._established_s: float | None = None
        self._ready_at_rad: float | None = None
        self.done = False

    def command(self, state: AircraftState, airspeed_m_s: float) -> FlightCommand:
        """Bank for the circle, climb for its altitude."""
        bank_rad = self._circle.bank_rad(state)
        if self._circle.established and self._established_s is None:
            self._established_s = state.time_s
        if self._ready_at_rad is None and self._ready(state):
            self._ready_at_rad = self._circle.turned_rad
        if self._ready_at_rad is not None:
            extra_rad = self._circle.turned_rad - self._ready_at_rad
            self.done = extra_rad >= 2.0 * math.pi or self._aligned(state)
        climb_m_s = climb_towards_m_s(self._tuning, state.altitude_m, self._centre.altitude_m)
        return FlightCommand(bank_rad, airspeed_m_s, climb_m_s)

    def _ready(self, state: AircraftState) -> bool:
        if self._turns is not None:
            return self._circle.turned_rad >= 2.0 * math.pi * self._turns
        if self._seconds is not None:
            return self._established_s is not None and state.time_s - self._established_s >= self._seconds
        off_m = abs(state.altitude_m - self._centre.altitude_m)
        return self._until_altitude and off_m < _ALTITUDE_REACHED_M

    def _aligned(self, state: AircraftState) -> bool:
        if self._exit_towards is None:
            return True
        course_error_rad = self._circle.course_error_rad if self._by_circle else _course_error_rad
        return course_error_rad(state, self._exit_towards) < _ALIGNED_RAD


class GoTo:
    """Flies straight to a place and circles there for ever."""

    lands = False

    def __init__(self, tuning: Tuning, start: Place, place: Place, radius_m: float) -> None:
        self._tuning = tuning
        # The altitude is flown to at once, not spread over the way.
        self._line = PolylineFollower(tuning, [replace(start, altitude_m=place.altitude_m), place])
        self._circle = Loiter(tuning, place, radius_m)
        self._radius_m = abs(radius_m)
        self._altitude_m = place.altitude_m
        self.arrived = False

    @property
    def done(self) -> bool:
        """Never: it circles until told otherwise."""
        return False

    def command(self, state: AircraftState, airspeed_m_s: float) -> FlightCommand:
        """Along the line until near, then the circle."""
        if not self.arrived:
            self.arrived = self._line.distance_to_target_m(state) < 2.0 * self._radius_m
        if self.arrived:
            return self._circle.command(state, airspeed_m_s)
        climb_m_s = climb_towards_m_s(self._tuning, state.altitude_m, self._altitude_m)
        return FlightCommand(self._line.bank_rad(state), airspeed_m_s, climb_m_s)


class Landing:
    """Loses height in circles where the way is too short, then glides to the place, flares and stops.

    Parameters
    ----------
    start
        Where the final leg begins.
    sink_m_s
        Steepest sink rate of the approach.
    """

    lands = True

    def __init__(
        self, tuning: Tuning, start: Place, place: Place, *, ground_m: float, sink_m_s: float, radius_m: float
    ) -> None:
        self._tuning = tuning
        self._place = place
        self._ground_m = max(ground_m, place.altitude_m)
        self._field_m = ground_m
        self._sink_m_s = sink_m_s
        self._radius_m = abs(radius_m)
        self._line = PolylineFollower(tuning, [start, place])
        self._spiral: CircleFollower | None = None
        self._final = False
        self.done = False

    def command(self, state: AircraftState, airspeed_m_s: float) -> FlightCommand:
        """Spiral, final, flare or roll-out."""
        if state.on_ground:
            self.done = state.airspeed_m_s < _STOPPED_M_S
            return FlightCommand()
        airspeed_m_s *= _APPROACH_SPEED
        height_m = state.altitude_m - self._ground_m
        to_go_m = self._line.distance_to_target_m(state)
        if not self._line.finished and self._line.passed(state):
            # Past the place: straight on and down, at whatever height is left.
            self._final = True
        if not self._final and not self._too_high(state, height_m, to_go_m):
            self._final = self._spiral is None or _course_error_rad(state, self._place) < _ALIGNED_RAD
        if not self._final:
            return self._spiral_down(state, airspeed_m_s)
        if self._line.finished or height_m < _FLARE_M:
            sink_m_s = min(max(_TOUCHDOWN_SINK_M_S, 0.4 * (state.altitude_m - self._field_m)), self._sink_m_s)
            limit_rad = math.radians(10.0) if height_m > _TOUCHDOWN_SINK_M_S else 0.0
            bank_rad = 0.0
            if not self._line.finished:
                bank_rad = min(max(self._line.bank_rad(state), -limit_rad), limit_rad)
            return FlightCommand(bank_rad, airspeed_m_s, -sink_m_s)
        seconds = to_go_m / max(state.ground_speed_m_s, 1.0)
        return FlightCommand(self._line.bank_rad(state), airspeed_m_s, -height_m / max(seconds, 1.0))

    def _too_high(self, state: AircraftState, height_m: float, to_go_m: float) -> bool:
        return height_m > 0.75 * self._sink_m_s * to_go_m / max(state.ground_speed_m_s, 1.0)

    def _spiral_down(self, state: AircraftState, airspeed_m_s: float) -> FlightCommand:
        if self._spiral is None:
            # To the right of where it is: the circle begins without a detour.
            across = state.heading_rad + 0.5 * math.pi
            lat_deg, lon_deg = moved(
                state.lat_deg,
                state.lon_deg,
                self._radius_m * math.cos(across),
                self._radius_m * math.sin(across),
            )
            self._spiral = CircleFollower(
                self._tuning, Place(lat_deg, lon_deg, state.altitude_m), self._radius_m
            )
        sink_m_s = 0.0 if state.altitude_m < self._ground_m + _LOWEST_CIRCLE_M else self._sink_m_s
        return FlightCommand(self._spiral.bank_rad(state), airspeed_m_s, -sink_m_s)


def _course_error_rad(state: AircraftState, place: Place) -> float:
    """Angle between the course over the ground and the bearing of a place."""
    north_m, east_m = offset_m(state.lat_deg, state.lon_deg, place.lat_deg, place.lon_deg)
    course_rad = math.atan2(state.east_m_s, state.north_m_s)
    return abs(wrap_rad(math.atan2(east_m, north_m) - course_rad))
