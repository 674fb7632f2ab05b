"""A point-mass multirotor: it tilts to accelerate, within limits of tilt and jerk; drag and wind push it."""

from __future__ import annotations

import math

from mavlink.sim.dynamics import GRAVITY_M_S2, AircraftState, FlightCommand, HoverCommand, Limits, Wind
from mavlink.sim.geodesy import Place, moved, radii_m, wrap_rad

#: Proportional gain of the velocity loop, 1/s.
_VELOCITY_GAIN = 2.5
#: From wanted to flown tilt, as a first-order lag.
_TILT_LAG_S = 0.15
_JERK_M_S3 = 15.0
#: How fast the controller's integrator learns drag and wind.
_OBSERVER_S = 0.5
_CLIMB_LAG_S = 0.4
_CLIMB_ACCELERATION_M_S2 = 2.5
_YAW_RATE_RAD_S = math.radians(60.0)
_YAW_LAG_S = 0.5
#: Tilt that holds the airframe's fastest airspeed against its drag, as a share of the largest tilt.
_TILT_AT_FASTEST = 0.8
_DRIVE_EFFICIENCY = 0.6
_LEAST_POWER = 0.3


class MultirotorModel:
    """Flight of a point mass under a thrust that tilts.

    The horizontal acceleration is ``a = g tan(tilt) - k (v - wind)``: thrust less linear drag, k such that
    the fastest airspeed takes 0.8 of the largest tilt. Against a wind it flies no faster through the air than
    the limits' airspeed, or than it is told over the ground, as autopilots do whose tilt is limited. The
    controller wants ``2.5 (v_wanted - v) + a_known`` plus what it has learnt of drag and wind, which lags by
    half a second, so gusts are felt. The thrust follows as a first-order lag under limits of tilt and jerk.
    Climb is a lag under an acceleration limit; the yaw rate is limited. On the ground it stands still until
    launched; wind does not push it there.

    Parameters
    ----------
    ground_m
        Altitude of the ground above mean sea level: flat.
    cruise_power_w, mass_kg
        Battery power at the limits' airspeed, most of which hovering takes as well; climbing adds
        ``m g climb / 0.6``.
    """

    def __init__(
        self,
        limits: Limits,
        start: Place,
        heading_deg: float,
        *,
        wind: Wind,
        ground_m: float,
        cruise_power_w: float = 250.0,
        mass_kg: float = 8.0,
        step_s: float = 0.025,
    ) -> None:
        self._limits = limits
        self._wind = wind
        self._ground_m = ground_m
        self._cruise_power_w = cruise_power_w
        self._mass_kg = mass_kg
        self.step_s = step_s
        self._most_m_s2 = GRAVITY_M_S2 * math.tan(limits.max_bank_rad)
        self._drag_per_s = _TILT_AT_FASTEST * self._most_m_s2 / limits.fastest_m_s
        self._thrust = (0.0, 0.0)
        self._learnt = (0.0, 0.0)
        heading_rad = math.radians(heading_deg % 360.0)
        place = (start.lat_deg, start.lon_deg, start.altitude_m)
        self._state = _on_ground(0.0, place, heading_rad, wind.step(0.0))

    @property
    def state(self) -> AircraftState:
        """The state after the last step."""
        return self._state

    def step(self, dt_s: float, command: FlightCommand) -> AircraftState:
        """Advance by ``dt_s`` seconds."""
        wind = self._wind.step(dt_s)
        if self._state.on_ground and not (command.launch and command.climb_m_s > 0.0):
            self._state = self._standing(dt_s, wind)
        else:
            self._state = self._flown(dt_s, command, wind)
        return self._state

    def _standing(self, dt_s: float, wind: tuple[float, float]) -> AircraftState:
        old = self._state
        self._thrust = self._learnt = (0.0, 0.0)
        place = (old.lat_deg, old.lon_deg, self._ground_m)
        return _on_ground(old.time_s + dt_s, place, old.heading_rad, wind)

    def _flown(self, dt_s: float, command: FlightCommand, wind: tuple[float, float]) -> AircraftState:
        old, limits = self._state, self._limits
        hover = command.hover or HoverCommand()
        north_m_s, east_m_s = self._accelerated(dt_s, hover, wind)
        wanted_m_s = min(max(command.climb_m_s, -limits.sink_m_s), limits.climb_m_s)
        change = (wanted_m_s - old.climb_m_s) * (1.0 - math.exp(-dt_s / _CLIMB_LAG_S))
        most = _CLIMB_ACCELERATION_M_S2 * dt_s
        climb_m_s = old.climb_m_s + min(max(change, -most), most)

        _, normal_m = radii_m(old.lat_deg)
        # At altitude h the same ground track is longer by 1 + h/R.
        scale = dt_s / (1.0 + old.altitude_m / normal_m)
        lat_deg, lon_deg = moved(
            old.lat_deg,
            old.lon_deg,
            0.5 * (old.north_m_s + north_m_s) * scale,
            0.5 * (old.east_m_s + east_m_s) * scale,
        )
        altitude_m = old.altitude_m + 0.5 * (old.climb_m_s + climb_m_s) * dt_s
        down = altitude_m <= self._ground_m and climb_m_s <= 0.0
        turn_rad_s = self._turn_rate_rad_s(dt_s, hover.heading_rad)
        heading_rad = (old.heading_rad + turn_rad_s * dt_s) % (2.0 * math.pi)
        ahead = self._thrust[0] * math.cos(heading_rad) + self._thrust[1] * math.sin(heading_rad)
        right = self._thrust[1] * math.cos(heading_rad) - self._thrust[0] * math.sin(heading_rad)
        airspeed_m_s = math.hypot(north_m_s - wind[0], east_m_s - wind[1])
        throttle, power_w = self._effort(airspeed_m_s, climb_m_s)
        return AircraftState(
            time_s=old.time_s + dt_s,
            lat_deg=lat_deg,
            lon_deg=lon_deg,
            altitude_m=self._ground_m if down else altitude_m,
            heading_rad=heading_rad,
            bank_rad=0.0 if down else math.atan(right / GRAVITY_M_S2),
            pitch_rad=0.0 if down else -math.atan(ahead / GRAVITY_M_S2),
            airspeed_m_s=0.0 if down else airspeed_m_s,
            climb_m_s=0.0 if down else climb_m_s,
            north_m_s=0.0 if down else north_m_s,
            east_m_s=0.0 if down else east_m_s,
            wind_north_m_s=wind[0],
            wind_east_m_s=wind[1],
            turn_rate_rad_s=turn_rad_s,
            throttle=throttle,
            power_w=power_w,
            on_ground=down,
        )

    def _accelerated(
        self, dt_s: float, hover: HoverCommand, wind: tuple[float, float]
    ) -> tuple[float, float]:
        """North and east velocity after a step; thrust and what is learnt of drag move on."""
        old = self._state
        velocity = (old.north_m_s, old.east_m_s)
        drag = (-self._drag_per_s * (velocity[0] - wind[0]), -self._drag_per_s * (velocity[1] - wind[1]))
        known = (hover.north_m_s2, hover.east_m_s2)
        wanted = _shortened((hover.north_m_s, hover.east_m_s), self._limits.fastest_m_s)
        wanted = _against(wanted, wind, self._limits.airspeed_m_s)
        asked = _shortened(
            (
                _VELOCITY_GAIN * (wanted[0] - velocity[0]) + known[0] - self._learnt[0],
                _VELOCITY_GAIN * (wanted[1] - velocity[1]) + known[1] - self._learnt[1],
            ),
            self._most_m_s2,
        )
        share = 1.0 - math.exp(-dt_s / _TILT_LAG_S)
        change = _shortened(
            (share * (asked[0] - self._thrust[0]), share * (asked[1] - self._thrust[1])), _JERK_M_S3 * dt_s
        )
        self._thrust = (self._thrust[0] + change[0], self._thrust[1] + change[1])
        share = 1.0 - math.exp(-dt_s / _OBSERVER_S)
        self._learnt = (
            self._learnt[0] + share * (drag[0] - self._learnt[0]),
            self._learnt[1] + share * (drag[1] - self._learnt[1]),
        )
        return (
            velocity[0] + (self._thrust[0] + drag[0]) * dt_s,
            velocity[1] + (self._thrust[1] + drag[1]) * dt_s,
        )

    def _turn_rate_rad_s(self, dt_s: float, heading_rad: float | None) -> float:
        if heading_rad is None:
            return 0.0
        off_rad = wrap_rad(heading_rad - self._state.heading_rad)
        rate = off_rad * (1.0 - math.exp(-dt_s / _YAW_LAG_S)) / dt_s
        return min(max(rate, -_YAW_RATE_RAD_S), _YAW_RATE_RAD_S)

    def _effort(self, airspeed_m_s: float, climb_m_s: float) -> tuple[float, float]:
        """Throttle and battery power: mostly what hovering takes, a part grows with the cube of airspeed."""
        level_w = self._cruise_power_w * (0.85 + 0.15 * (airspeed_m_s / self._limits.airspeed_m_s) ** 3)
        climb_w = self._mass_kg * GRAVITY_M_S2 * climb_m_s / _DRIVE_EFFICIENCY
        power_w = max(level_w + climb_w, _LEAST_POWER * self._cruise_power_w)
        full_w = 2.0 * self._cruise_power_w + self._mass_kg * GRAVITY_M_S2 * self._limits.climb_m_s
        return min(power_w / full_w, 1.0), power_w


def _against(
    wanted: tuple[float, float], wind: tuple[float, float], airspeed_m_s: float
) -> tuple[float, float]:
    """A velocity over the ground, on its course no faster than the airspeed lets it in a wind."""
    speed = math.hypot(*wanted)
    if speed == 0.0:
        return wanted
    along = (wind[0] * wanted[0] + wind[1] * wanted[1]) / speed
    across_2 = wind[0] ** 2 + wind[1] ** 2 - along**2
    return _shortened(wanted, max(along + math.sqrt(max(max(airspeed_m_s, speed) ** 2 - across_2, 0.0)), 0.0))


def _shortened(vector: tuple[float, float], most: float) -> tuple[float, float]:
    """The vector, no longer than ``most``."""
    length = math.hypot(*vector)
    if length <= most:
        return vector
    return vector[0] * most / length, vector[1] * most / length


def _on_ground(
    time_s: float, place: tuple[float, float, float], heading_rad: float, wind: tuple[float, float]
) -> AircraftState:
    """Standing, motors off: latitude, longitude and altitude; the wind's north and east."""
    lat_deg, lon_deg, altitude_m = place
    return AircraftState(
        time_s=time_s,
        lat_deg=lat_deg,
        lon_deg=lon_deg,
        altitude_m=altitude_m,
        heading_rad=heading_rad,
        bank_rad=0.0,
        pitch_rad=0.0,
        airspeed_m_s=0.0,
        climb_m_s=0.0,
        north_m_s=0.0,
        east_m_s=0.0,
        wind_north_m_s=wind[0],
        wind_east_m_s=wind[1],
        turn_rate_rad_s=0.0,
        throttle=0.0,
        power_w=0.0,
        on_ground=True,
    )
