"""What an aircraft can do: speed, turn radius, range."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

from planner.vehicle.energy import STANDARD_GRAVITY_M_S2, PowerModel

VehicleType = Literal["fixed_wing", "multirotor", "vtol"]
Autopilot = Literal["ardupilot", "px4"]
FinishWish = Literal["auto", "land", "return", "loiter"]

#: Share of the energy kept where a scenario says nothing else.
DEFAULT_RESERVE = 0.2

#: What hovers turns on the spot, where nothing else is asked of it: its corners are arcs of this radius, as
#: near as autopilots pass a waypoint (WPNAV_RADIUS, NAV_ACC_RAD), flown as slowly as that asks for.
CORNER_RADIUS_M = 2.0

#: Items of a mission that an autopilot holds, by its name and whether it flies ArduCopter: what ArduPlane and
#: ArduCopter 4.6 told; PX4's boards of unknown size.
MOST_ITEMS: dict[tuple[Autopilot, bool], int] = {
    ("ardupilot", False): 655,
    ("ardupilot", True): 650,
    ("px4", False): 500,
    ("px4", True): 500,
}

#: Planned arcs are this much wider than the aircraft's limit, so that no rounding makes a turn too tight.
TURN_RADIUS_MARGIN = 1.001


@dataclass(frozen=True, slots=True)
class Aloft:
    """Where an aircraft is that is in the air already: degrees, metres over home; its course from true north.

    What hovers may go on in any direction: ``heading_deg`` is None then.
    """

    lon_deg: float
    lat_deg: float
    height_m: float
    heading_deg: float | None = None


@dataclass(frozen=True, slots=True)
class Aircraft:
    """One vehicle of the scenario.

    Parameters
    ----------
    name
        As the client wrote it.
    airspeed_m_s
        Cruise airspeed, > 0.
    min_turn_radius_m
        Tightest turn it flies at that airspeed, in the air mass, > 0; of what turns on the spot
        ``CORNER_RADIUS_M``, flown more slowly.
    energy_wh, max_range_m, max_flight_time_s
        What one flight has; None where not limited.
    reserve
        Share of the energy that is kept.
    voltage_v
        By which the charge of its battery was given; None where that was energy.
    power
        What flight takes of the battery; None where unknown.
    settle_m
        Straight flight wanted before each collect, over the ground in ``wind_m_s``.
    max_climb_deg
        Steepest climb or descent.
    base
        Name of the base it starts from; None for the scenario's start.
    end_bases
        Names of the bases it may land at, whichever suits; None for where it starts, or the scenario's end.
    wind_m_s
        Steady wind it flies in, from any direction, slower than ``airspeed_m_s``.
    finish
        How its flight ends; ``auto`` is for ``planner.profile.finish`` to say.
    min_airspeed_m_s
        The slowest that it may be flown at where ``airspeed_m_s`` is too fast for a camera; None for wings
        that fly at no other speed.
    sensors
        Names of those on board; None for all.
    batteries, turnaround_s
        How many flights it can make, each with all of its energy, and the time between two of them.
    aloft
        Where it is if it flies already; None on the ground.
    max_items
        How many items of a mission its autopilot holds; None for what is usual.
    """

    name: str
    type: VehicleType
    autopilot: Autopilot
    airspeed_m_s: float
    min_turn_radius_m: float
    max_climb_deg: float = 8.0
    energy_wh: float | None = None
    power: PowerModel | None = None
    max_range_m: float | None = None
    max_flight_time_s: float | None = None
    settle_m: float = 0.0
    base: str | None = None
    wind_m_s: float = 0.0
    reserve: float = DEFAULT_RESERVE
    finish: FinishWish = "auto"
    min_airspeed_m_s: float | None = None
    sensors: tuple[str, ...] | None = None
    batteries: int = 1
    turnaround_s: float = 0.0

    def carries(self, sensor: str) -> bool:
        """Whether a sensor is on board."""
        return self.sensors is None or sensor in self.sensors

    aloft: Aloft | None = None
    max_items: int | None = None
    end_bases: tuple[str, ...] | None = None
    voltage_v: float | None = None

    @property
    def most_items(self) -> int:
        """How many items of a mission its autopilot holds."""
        return self.max_items or MOST_ITEMS[self.autopilot, self.hovers]

    @property
    def limited(self) -> bool:
        """Whether anything says how long one flight may be."""
        return (self.usable_wh, self.max_range_m, self.max_flight_time_s) != (None, None, None)

    @property
    def hovers(self) -> bool:
        """Whether it flies on rotors alone: at a speed over the ground, its nose along its course."""
        return self.type == "multirotor"

    @property
    def turns_on_the_spot(self) -> bool:
        """Whether it brakes for its corners rather than fly round them."""
        return self.hovers and self.min_turn_radius_m <= CORNER_RADIUS_M

    @property
    def usable_wh(self) -> float | None:
        """Energy that a flight may use; None where not limited."""
        return None if self.energy_wh is None else self.energy_wh * (1.0 - self.reserve)

    def in_wind(self, wind_m_s: float) -> Aircraft:
        """The same aircraft in a steady wind of this speed: its turns over the ground are wider.

        Coming back to a line takes an autopilot time: downwind, over so much more ground. What hovers flies
        no faster over the ground than in still air.
        """
        if self.hovers:
            return replace(self, wind_m_s=wind_m_s)
        longer = (self.airspeed_m_s + wind_m_s) / (self.airspeed_m_s + self.wind_m_s)
        return replace(self, wind_m_s=wind_m_s, settle_m=self.settle_m * longer)

    @property
    def ground_turn_radius_m(self) -> float:
        """Tightest arc over the ground that it flies in its wind, whatever the directions.

        Downwind, at airspeed and wind together, the bank of ``min_turn_radius_m`` allows no tighter one; see
        ``planner.vehicle.wind``.
        """
        if self.hovers:
            return self.min_turn_radius_m
        return self.min_turn_radius_m * ((self.airspeed_m_s + self.wind_m_s) / self.airspeed_m_s) ** 2

    @property
    def planned_turn_radius_m(self) -> float:
        """Radius of planned arcs."""
        return self.ground_turn_radius_m * TURN_RADIUS_MARGIN


def turn_radius_from_bank_m(airspeed_m_s: float, bank_deg: float) -> float:
    """Radius of a coordinated level turn, v² / (g tan φ)."""
    return airspeed_m_s**2 / (STANDARD_GRAVITY_M_S2 * math.tan(math.radians(bank_deg)))


def turn_radius_from_load_factor_m(airspeed_m_s: float, load_factor: float) -> float:
    """Radius of a coordinated level turn, v² / (g √(n² − 1))."""
    return airspeed_m_s**2 / (STANDARD_GRAVITY_M_S2 * math.sqrt(load_factor**2 - 1.0))
