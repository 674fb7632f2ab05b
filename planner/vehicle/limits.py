"""What a flight uses, and which limits of its aircraft that exceeds: the one place that compares the two."""

from __future__ import annotations

import math
from dataclasses import dataclass

from planner.vehicle.aircraft import Aircraft


@dataclass(frozen=True, slots=True)
class Use:
    """Length and time of a flight, and its energy where there is a power model."""

    length_m: float
    duration_s: float
    energy_wh: float | None

    def scaled(self, factor: float) -> Use:
        """A flight longer by a factor."""
        energy_wh = None if self.energy_wh is None else factor * self.energy_wh
        return Use(factor * self.length_m, factor * self.duration_s, energy_wh)


@dataclass(frozen=True, slots=True)
class Excess:
    """A limit that a flight is over: its name among the violations, what is used, what there is, the unit."""

    constraint: str
    used: float
    limit: float
    unit: str

    @property
    def margin(self) -> float:
        """By how much, > 0."""
        return self.used - self.limit


def exceeded(aircraft: Aircraft, use: Use) -> tuple[Excess, ...]:
    """The limits that a flight is over, the one most exceeded first."""
    found = [each for each in _against(aircraft, use) if each.used > each.limit]
    return tuple(sorted(found, key=lambda excess: -excess.used / excess.limit))


def strain(aircraft: Aircraft, use: Use) -> float:
    """The greatest part of a limit that a flight uses; over 1 where it is over one, 0 without limits."""
    return max((each.used / each.limit for each in _against(aircraft, use)), default=0.0)


def raised(aircraft: Aircraft, constraint: str, used: float) -> str:
    """What an aircraft would need for a use of a limit, as a scenario says it: rounded up.

    Of energy the battery as it was given, by its charge where that was; or the reserve, where less would do.
    """
    if constraint == "range":
        return f"Set max_range_m to {math.ceil(used)} or more"
    if constraint == "flight-time":
        return f"Set max_flight_time_s to {math.ceil(used)} or more"
    whole_wh = used / (1.0 - aircraft.reserve)
    if aircraft.voltage_v is None:
        said = f"Set energy_wh to {math.ceil(10.0 * whole_wh) / 10.0:g} or more"
    else:
        said = f"Set charge_mah to {math.ceil(1000.0 * whole_wh / aircraft.voltage_v)} or more"
    if aircraft.energy_wh is not None and used < aircraft.energy_wh:
        least = math.floor(100.0 * (1.0 - used / aircraft.energy_wh)) / 100.0
        said += f", or reserve to {least:g} or less"
    return said


def _against(aircraft: Aircraft, use: Use) -> list[Excess]:
    rows = (
        ("range", use.length_m, aircraft.max_range_m, "m"),
        ("flight-time", use.duration_s, aircraft.max_flight_time_s, "s"),
        ("energy", use.energy_wh, aircraft.usable_wh, "Wh"),
    )
    return [
        Excess(constraint, used, limit, unit)
        for constraint, used, limit, unit in rows
        if used is not None and limit is not None
    ]
