"""What a multirotor does at one time: rise, stay, go somewhere, circle, return, come down."""

from __future__ import annotations

import math
from dataclasses import replace

from mavlink.sim.dynamics import AircraftState, FlightCommand, HoverCommand
from mavlink.sim.geodesy import Place, distance_m, moved, offset_m, wrap_rad
from mavlink.sim.legs import Agility, Vector, climb_to_m_s, velocity_to

_REACHED_M = 2.0
_ALTITUDE_REACHED_M = 1.0
_BRAKING = 0.6
_CIRCLE_GAIN_PER_S = 0.8
#: Braking from cruise: sooner than this nobody stands still.
_SETTLED_M_S = 0.5
_OVER_HOME_S = 5.0


def held(
    state: AircraftState, agility: Agility, place: Place, speed_m_s: float, heading_rad: float | None = None
) -> FlightCommand:
    """Go to a place, or stay there."""
    braking_m_s2 = _BRAKING * agility.acceleration_m_s2
    north, east = velocity_to(state, place, speed_m_s, braking_m_s2)
    climb_m_s = climb_to_m_s(state, place.altitude_m)
    return FlightCommand(
        0.0, speed_m_s, climb_m_s, True, None, HoverCommand(north, east, 0.0, 0.0, heading_rad)
    )


def stopping_place(state: AircraftState, agility: Agility) -> Place:
    """Where the aircraft comes to a stop when it brakes now."""
    seconds = 0.5 * state.ground_speed_m_s / agility.acceleration_m_s2
    lat_deg, lon_deg = moved(
        state.lat_deg, state.lon_deg, state.north_m_s * seconds, state.east_m_s * seconds
    )
    return Place(lat_deg, lon_deg, state.altitude_m)


class Rise:
    """Climbs straight up from where it stands; already up there, it is done."""

    lands = False

    def __init__(self, agility: Agility, start: AircraftState, altitude_m: float) -> None:
        self._agility = agility
        self._place = replace(start.place, altitude_m=altitude_m)
        self._missing_m = altitude_m - start.altitude_m
        self.done = False

    def command(self, state: AircraftState, airspeed_m_s: float) -> FlightCommand:
        """Up, over the same place."""
        off_m = self._place.altitude_m - state.altitude_m
        self.done = not state.on_ground and off_m < _ALTITUDE_REACHED_M
        command = held(state, self._agility, self._place, airspeed_m_s)
        return replace(command, climb_m_s=max(command.climb_m_s, 0.5)) if off_m > 0.0 else command


class Stay:
    """Stays at a place, for a time or for good.

    Parameters
    ----------
    seconds
        Counted from the arrival; None: until told otherwise.
    until_altitude
        It ends when as high as the place.
    """

    lands = False

    def __init__(
        self, agility: Agility, place: Place, *, seconds: float | None = None, until_altitude: bool = False
    ) -> None:
        self._agility = agility
        self._place = place
        self._seconds = seconds
        self._until_altitude = until_altitude
        self._arrived_s: float | None = None
        self.done = False

    @property
    def arrived(self) -> bool:
        """Whether it is there."""
        return self._arrived_s is not None

    def command(self, state: AircraftState, airspeed_m_s: float) -> FlightCommand:
        """To the place at the speed wanted, then over it."""
        off_m = distance_m(state.place, self._place)
        high = abs(state.altitude_m - self._place.altitude_m) < _ALTITUDE_REACHED_M
        if self._arrived_s is None and off_m < _REACHED_M and high:
            self._arrived_s = state.time_s
        if self._arrived_s is not None:
            waited_s = state.time_s - self._arrived_s
            self.done = self._until_altitude or (self._seconds is not None and waited_s >= self._seconds)
        heading_rad = bearing_rad(state, self._place) if off_m > 2.0 * _REACHED_M else None
        return held(state, self._agility, self._place, airspeed_m_s, heading_rad)


class Circle:
    """Flies turns round a place, the nose along the way.

    Parameters
    ----------
    radius_m
        Positive is clockwise seen from above.
    """

    lands = False

    def __init__(self, agility: Agility, centre: Place, radius_m: float, turns: float) -> None:
        self._agility = agility
        self._centre = centre
        self._radius_m = abs(radius_m)
        self._turning = 1.0 if radius_m >= 0.0 else -1.0
        self._turns_rad = 2.0 * math.pi * turns
        self._bearing_rad: float | None = None
        self._turned_rad = 0.0
        self.done = False

    def command(self, state: AircraftState, airspeed_m_s: float) -> FlightCommand:
        """Along the tangent, back onto the circle; the angle counts from when the circle is reached."""
        c_n, c_e = offset_m(state.lat_deg, state.lon_deg, self._centre.lat_deg, self._centre.lon_deg)
        from_centre_m = max(math.hypot(c_n, c_e), 1e-3)
        outward = (-c_n / from_centre_m, -c_e / from_centre_m)
        off_m = from_centre_m - self._radius_m
        bearing_rad = math.atan2(outward[1], outward[0])
        if abs(off_m) < _REACHED_M and self._bearing_rad is not None:
            self._turned_rad += self._turning * wrap_rad(bearing_rad - self._bearing_rad)
        self._bearing_rad = bearing_rad
        self.done = self._turned_rad >= self._turns_rad
        speed_m_s = min(airspeed_m_s, math.sqrt(self._agility.acceleration_m_s2 * self._radius_m))
        back = min(max(-_CIRCLE_GAIN_PER_S * off_m, -speed_m_s), speed_m_s)
        along = math.sqrt(max(speed_m_s**2 - back**2, 0.0))
        tangent: Vector = (-self._turning * outward[1], self._turning * outward[0])
        inward_m_s2 = along**2 / self._radius_m
        hover = HoverCommand(
            along * tangent[0] + back * outward[0],
            along * tangent[1] + back * outward[1],
            -inward_m_s2 * outward[0],
            -inward_m_s2 * outward[1],
            math.atan2(tangent[1], tangent[0]),
        )
        climb_m_s = climb_to_m_s(state, self._centre.altitude_m)
        return FlightCommand(0.0, speed_m_s, climb_m_s, True, None, hover)


class Descent:
    """Goes over a place at its height, then straight down to the ground, slower near it.

    Parameters
    ----------
    slow_below_m, slow_m_s
        Height over the ground from which it comes down slowly, and how slowly.
    """

    lands = True

    def __init__(
        self,
        agility: Agility,
        place: Place,
        *,
        ground_m: float,
        slow_below_m: float,
        slow_m_s: float,
        seconds_before: float = 0.0,
    ) -> None:
        self._agility = agility
        self._stay = Stay(agility, place, seconds=seconds_before)
        self._place = place
        self._ground_m = ground_m
        self._slow_below_m = slow_below_m
        self._slow_m_s = slow_m_s
        self.done = False

    def command(self, state: AircraftState, airspeed_m_s: float) -> FlightCommand:
        """There, and down."""
        if state.on_ground:
            self.done = True
            return FlightCommand()
        if not self._stay.done:
            return self._stay.command(state, airspeed_m_s)
        height_m = state.altitude_m - self._ground_m
        # From the slow height on, the speed changes smoothly from fast to slow.
        sink_m_s = min(self._agility.sink_m_s, self._slow_m_s + 0.5 * max(height_m - self._slow_below_m, 0.0))
        command = held(state, self._agility, self._place, airspeed_m_s)
        return replace(command, climb_m_s=-sink_m_s)


class Return:
    """Climbs to the return altitude where it is lower, goes home, waits there, and lands."""

    lands = True

    def __init__(
        self,
        agility: Agility,
        start: AircraftState,
        home: Place,
        *,
        altitude_m: float,
        ground_m: float,
        slow_below_m: float,
        slow_m_s: float,
    ) -> None:
        high_m = max(altitude_m, start.altitude_m)
        stop = stopping_place(start, agility)
        self._climb = Stay(agility, replace(stop, altitude_m=high_m), until_altitude=True)
        self._down = Descent(
            agility,
            replace(home, altitude_m=high_m),
            ground_m=ground_m,
            slow_below_m=slow_below_m,
            slow_m_s=slow_m_s,
            seconds_before=_OVER_HOME_S,
        )

    @property
    def done(self) -> bool:
        """Whether it stands at home."""
        return self._down.done

    def command(self, state: AircraftState, airspeed_m_s: float) -> FlightCommand:
        """Up, home, down."""
        part = self._down if self._climb.done or state.on_ground else self._climb
        return part.command(state, airspeed_m_s)


def bearing_rad(state: AircraftState, place: Place) -> float:
    """Bearing of a place, clockwise from true north."""
    north_m, east_m = offset_m(state.lat_deg, state.lon_deg, place.lat_deg, place.lon_deg)
    return math.atan2(east_m, north_m)
