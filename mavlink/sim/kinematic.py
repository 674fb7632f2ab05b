"""A point-mass fixed wing: bank, airspeed and climb follow commands with lags and limits; wind carries it."""

from __future__ import annotations

import math

from mavlink.sim.atmosphere import true_over_equivalent
from mavlink.sim.dynamics import GRAVITY_M_S2, AircraftState, FlightCommand, Limits, Wind
from mavlink.sim.geodesy import Place, moved, radii_m

_ROLL_LAG_S = 0.25
_AIRSPEED_LAG_S = 2.0
_CLIMB_LAG_S = 1.0
_ACCELERATION_M_S2 = 2.0
_RUN_ACCELERATION_M_S2 = 5.0
_BRAKING_M_S2 = 3.0
_DRIVE_EFFICIENCY = 0.6


class KinematicModel:
    """Coordinated flight of a point mass.

    Bank follows its command as a first-order lag under a roll-rate limit; airspeed and climb are first-order
    lags under an acceleration and rate limits; the airspeed commanded is the equivalent one, the true one is
    higher in thin air; the heading turns at ``g tan(bank) / V``, V being the horizontal airspeed
    (coordinated turn), plus the rotation of true north along the way, ``v_east tan(lat) /
    N``, so that wings-level flight follows a geodesic. The position is the integral of air velocity plus wind
    over the WGS 84 radii of curvature, with the heading at the middle of the step.

    Parameters
    ----------
    ground_m
        Altitude of the ground above mean sea level: flat.
    cruise_power_w, mass_kg
        Battery power in level flight at the limits' airspeed; it grows with the cube of airspeed, and
        climbing adds ``m g climb / 0.6``.
    """

    def __init__(
        self,
        limits: Limits,
        start: Place,
        heading_deg: float,
        *,
        wind: Wind,
        ground_m: float,
        airborne: bool = False,
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
        airspeed_m_s = limits.airspeed_m_s * true_over_equivalent(start.altitude_m) if airborne else 0.0
        wind_north, wind_east = wind.step(0.0)
        heading_rad = math.radians(heading_deg % 360.0)
        self._state = AircraftState(
            time_s=0.0,
            lat_deg=start.lat_deg,
            lon_deg=start.lon_deg,
            altitude_m=start.altitude_m,
            heading_rad=heading_rad,
            bank_rad=0.0,
            pitch_rad=0.0,
            airspeed_m_s=airspeed_m_s,
            climb_m_s=0.0,
            north_m_s=airspeed_m_s * math.cos(heading_rad) + (wind_north if airborne else 0.0),
            east_m_s=airspeed_m_s * math.sin(heading_rad) + (wind_east if airborne else 0.0),
            wind_north_m_s=wind_north,
            wind_east_m_s=wind_east,
            turn_rate_rad_s=0.0,
            throttle=0.0,
            power_w=0.0,
            on_ground=not airborne,
        )

    @property
    def state(self) -> AircraftState:
        """The state after the last step."""
        return self._state

    def reset(self, state: AircraftState) -> None:
        """Go on from another model's state."""
        self._state = state

    def step(self, dt_s: float, command: FlightCommand) -> AircraftState:
        """Advance by ``dt_s`` seconds."""
        wind_north, wind_east = self._wind.step(dt_s)
        if self._state.on_ground:
            self._state = self._rolled(dt_s, command, wind_north, wind_east)
        else:
            self._state = self._flown(dt_s, command, wind_north, wind_east)
        return self._state

    def _flown(
        self, dt_s: float, command: FlightCommand, wind_north: float, wind_east: float
    ) -> AircraftState:
        old, limits = self._state, self._limits
        bank_rad = self._bank(old.bank_rad, dt_s, command.bank_rad)
        thin = true_over_equivalent(old.altitude_m)
        wanted_m_s = min(max(command.airspeed_m_s, limits.stall_m_s), limits.fastest_m_s)
        change = (thin * wanted_m_s - old.airspeed_m_s) * (1.0 - math.exp(-dt_s / _AIRSPEED_LAG_S))
        most = _ACCELERATION_M_S2 * dt_s
        airspeed_m_s = old.airspeed_m_s + min(max(change, -most), most)
        climb_wanted = min(max(command.climb_m_s, -limits.sink_m_s), limits.climb_m_s)
        climb_m_s = old.climb_m_s + (climb_wanted - old.climb_m_s) * (1.0 - math.exp(-dt_s / _CLIMB_LAG_S))
        horizontal_m_s = math.sqrt(max(airspeed_m_s**2 - climb_m_s**2, 1.0))

        _, normal_m = radii_m(old.lat_deg)
        turn_rad_s = GRAVITY_M_S2 * math.tan(0.5 * (old.bank_rad + bank_rad)) / horizontal_m_s
        transport_rad_s = old.east_m_s * math.tan(math.radians(old.lat_deg)) / normal_m
        turned_rad = (turn_rad_s + transport_rad_s) * dt_s
        middle_rad = old.heading_rad + 0.5 * turned_rad
        # The chord of the turned arc is shorter than the arc by this factor (the first terms of sin x / x).
        chord = 1.0 - turned_rad * turned_rad / 24.0
        north_m = (horizontal_m_s * chord * math.cos(middle_rad) + wind_north) * dt_s
        east_m = (horizontal_m_s * chord * math.sin(middle_rad) + wind_east) * dt_s
        # At altitude h the same ground track is longer by 1 + h/R.
        shrink = 1.0 / (1.0 + old.altitude_m / normal_m)
        lat_deg, lon_deg = moved(old.lat_deg, old.lon_deg, north_m * shrink, east_m * shrink)
        altitude_m = old.altitude_m + 0.5 * (old.climb_m_s + climb_m_s) * dt_s
        down = altitude_m <= self._ground_m and climb_m_s <= 0.0
        heading_rad = (old.heading_rad + turned_rad) % (2.0 * math.pi)
        throttle, power_w = self._effort(airspeed_m_s / thin, climb_m_s, bank_rad)
        return AircraftState(
            time_s=old.time_s + dt_s,
            lat_deg=lat_deg,
            lon_deg=lon_deg,
            altitude_m=self._ground_m if down else altitude_m,
            heading_rad=heading_rad,
            bank_rad=0.0 if down else bank_rad,
            pitch_rad=0.0 if down else math.asin(min(max(climb_m_s / airspeed_m_s, -1.0), 1.0)),
            airspeed_m_s=airspeed_m_s,
            climb_m_s=0.0 if down else climb_m_s,
            north_m_s=horizontal_m_s * math.cos(heading_rad) + wind_north,
            east_m_s=horizontal_m_s * math.sin(heading_rad) + wind_east,
            wind_north_m_s=wind_north,
            wind_east_m_s=wind_east,
            turn_rate_rad_s=turn_rad_s,
            throttle=throttle,
            power_w=power_w,
            on_ground=down,
        )

    def _rolled(
        self, dt_s: float, command: FlightCommand, wind_north: float, wind_east: float
    ) -> AircraftState:
        """A step on the ground: runs straight on when launched, brakes otherwise; wind does not push it."""
        old, limits = self._state, self._limits
        if command.launch:
            speed_m_s = old.airspeed_m_s + _RUN_ACCELERATION_M_S2 * dt_s
        else:
            speed_m_s = max(old.airspeed_m_s - _BRAKING_M_S2 * dt_s, 0.0)
        run_m = 0.5 * (old.airspeed_m_s + speed_m_s) * dt_s
        heading_rad = old.heading_rad
        if old.airspeed_m_s == 0.0 and command.launch and command.launch_heading_rad is not None:
            heading_rad = command.launch_heading_rad % (2.0 * math.pi)
        cos, sin = math.cos(heading_rad), math.sin(heading_rad)
        lat_deg, lon_deg = old.lat_deg, old.lon_deg
        if run_m > 0.0:
            lat_deg, lon_deg = moved(lat_deg, lon_deg, run_m * cos, run_m * sin)
        airborne = command.launch and speed_m_s >= 1.1 * limits.stall_m_s and command.climb_m_s > 0.0
        return AircraftState(
            time_s=old.time_s + dt_s,
            lat_deg=lat_deg,
            lon_deg=lon_deg,
            altitude_m=self._ground_m,
            heading_rad=heading_rad,
            bank_rad=0.0,
            pitch_rad=0.0,
            airspeed_m_s=speed_m_s,
            climb_m_s=0.0,
            north_m_s=speed_m_s * cos,
            east_m_s=speed_m_s * sin,
            wind_north_m_s=wind_north,
            wind_east_m_s=wind_east,
            turn_rate_rad_s=0.0,
            throttle=1.0 if command.launch else 0.0,
            power_w=2.0 * self._cruise_power_w if command.launch else 0.0,
            on_ground=not airborne,
        )

    def _bank(self, bank_rad: float, dt_s: float, wanted_rad: float) -> float:
        limit = self._limits.max_bank_rad
        wanted_rad = min(max(wanted_rad, -limit), limit)
        change = (wanted_rad - bank_rad) * (1.0 - math.exp(-dt_s / _ROLL_LAG_S))
        most = self._limits.roll_rate_rad_s * dt_s
        return bank_rad + min(max(change, -most), most)

    def _effort(self, airspeed_m_s: float, climb_m_s: float, bank_rad: float) -> tuple[float, float]:
        """Throttle and battery power; a turn's induced drag is counted by its load factor."""
        level_w = self._cruise_power_w * (airspeed_m_s / self._limits.airspeed_m_s) ** 3
        climb_w = self._mass_kg * GRAVITY_M_S2 * climb_m_s / _DRIVE_EFFICIENCY
        power_w = max(level_w * (0.7 + 0.3 / math.cos(bank_rad) ** 2) + climb_w, 0.0)
        full_w = 2.5 * self._cruise_power_w + self._mass_kg * GRAVITY_M_S2 * self._limits.climb_m_s
        return min(power_w / full_w, 1.0), power_w
