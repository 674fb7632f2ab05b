"""What every flight model of the simulated aircraft takes and gives."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import Protocol

from mavlink.sim.geodesy import Place

GRAVITY_M_S2 = 9.80665
#: Airspeeds that JSBSim's light aircraft flies.
JSBSIM_SLOWEST_M_S = 38.0
JSBSIM_FASTEST_M_S = 60.0


@dataclass(frozen=True, slots=True)
class HoverCommand:
    """What guidance asks of an aircraft that hovers.

    Parameters
    ----------
    north_m_s, east_m_s
        Velocity over the ground.
    north_m_s2, east_m_s2
        Acceleration known beforehand, as in a turn.
    heading_rad
        Where the nose is to point, clockwise from true north; None: where it does.
    """

    north_m_s: float = 0.0
    east_m_s: float = 0.0
    north_m_s2: float = 0.0
    east_m_s2: float = 0.0
    heading_rad: float | None = None


@dataclass(frozen=True, slots=True)
class FlightCommand:
    """What guidance asks of the aircraft.

    Parameters
    ----------
    bank_rad
        Right wing down is positive.
    airspeed_m_s
        Of wings the equivalent airspeed.
    climb_m_s
        Vertical speed, up is positive.
    launch
        On the ground: run and lift off. Without it an aircraft on the ground brakes and stays there.
    launch_heading_rad
        Where to point the standing aircraft before the run; None: leave it.
    hover
        What a multirotor does instead of banking at an airspeed; None: it stays over its place.
    """

    bank_rad: float = 0.0
    airspeed_m_s: float = 0.0
    climb_m_s: float = 0.0
    launch: bool = False
    launch_heading_rad: float | None = None
    hover: HoverCommand | None = None


@dataclass(frozen=True, slots=True)
class AircraftState:
    """The aircraft at one instant.

    Parameters
    ----------
    lat_deg, lon_deg, altitude_m
        WGS 84; altitude above mean sea level.
    heading_rad
        Where the nose points: clockwise from true north, in [0, 2 pi).
    airspeed_m_s
        True airspeed.
    bank_rad, pitch_rad
        Right wing down and nose up are positive.
    north_m_s, east_m_s, climb_m_s
        Velocity over the ground, wind included.
    wind_north_m_s, wind_east_m_s
        The air's own velocity at the aircraft.
    throttle
        0 to 1.
    power_w
        Drawn from the battery.
    """

    time_s: float
    lat_deg: float
    lon_deg: float
    altitude_m: float
    heading_rad: float
    bank_rad: float
    pitch_rad: float
    airspeed_m_s: float
    climb_m_s: float
    north_m_s: float
    east_m_s: float
    wind_north_m_s: float
    wind_east_m_s: float
    turn_rate_rad_s: float
    throttle: float
    power_w: float
    on_ground: bool

    @property
    def ground_speed_m_s(self) -> float:
        """Horizontal speed over the ground."""
        return math.hypot(self.north_m_s, self.east_m_s)

    @property
    def place(self) -> Place:
        """Where the aircraft is."""
        return Place(self.lat_deg, self.lon_deg, self.altitude_m)


class Dynamics(Protocol):
    """A flight model, advanced in fixed steps."""

    @property
    def step_s(self) -> float:
        """The step it wants, seconds."""

    @property
    def state(self) -> AircraftState:
        """The state after the last step."""

    def step(self, dt_s: float, command: FlightCommand) -> AircraftState:
        """Advance by ``dt_s`` seconds under a command."""


@dataclass(frozen=True, slots=True)
class Limits:
    """What the airframe can do.

    Parameters
    ----------
    climb_m_s, sink_m_s
        Largest climb and sink rates, both positive.
    """

    airspeed_m_s: float
    max_bank_rad: float
    roll_rate_rad_s: float
    climb_m_s: float
    sink_m_s: float

    @property
    def stall_m_s(self) -> float:
        """Slowest airspeed flown; also the speed at which it lifts off."""
        return 0.7 * self.airspeed_m_s

    @property
    def fastest_m_s(self) -> float:
        """Fastest airspeed flown."""
        return 1.5 * self.airspeed_m_s


class Wind:
    """Steady wind with gusts on top.

    Gusts are an Ornstein-Uhlenbeck process on both horizontal axes (standard deviation ``gust_m_s``,
    correlation time 5 s), seeded: the same seed gives the same flight.
    """

    _CORRELATION_S = 5.0

    def __init__(self, speed_m_s: float, from_deg: float, gust_m_s: float, seed: int) -> None:
        toward_rad = math.radians(from_deg + 180.0)
        self._mean = (speed_m_s * math.cos(toward_rad), speed_m_s * math.sin(toward_rad))
        self._gust_m_s = gust_m_s
        self._random = random.Random(seed)
        self._north = self._east = 0.0

    def step(self, dt_s: float) -> tuple[float, float]:
        """North and east components of the air's velocity, metres a second, ``dt_s`` later."""
        if self._gust_m_s > 0.0:
            decay = math.exp(-dt_s / self._CORRELATION_S)
            spread = self._gust_m_s * math.sqrt(1.0 - decay * decay)
            self._north = decay * self._north + spread * self._random.gauss(0.0, 1.0)
            self._east = decay * self._east + spread * self._random.gauss(0.0, 1.0)
        return self._mean[0] + self._north, self._mean[1] + self._east
