"""What limits a flight, what a metre of it takes, and flights that were tried."""

from __future__ import annotations

from dataclasses import dataclass

from planner.profile.compose import Composed
from planner.publish import Leg
from planner.route import CollectPass
from planner.search.programme import Programme
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.energy import FlightState
from planner.vehicle.limits import Use

#: A flight that uses more than this part of what it may is not flown: the judge reckons by the vertices of
#: the published line, mostly by a thousandth another way, of tight turns side by side by up to four.
MOST = 0.9955


@dataclass(frozen=True, slots=True)
class Flight:
    """One programme of a search, flown."""

    programme: Programme
    passes: tuple[CollectPass, ...]
    composed: Composed
    legs: tuple[Leg, ...]
    notes: tuple[str, ...]
    use: Use


def per_m_of(aircraft: Aircraft, above_sea_m: float) -> dict[str, float]:
    """What a metre through the air takes of each limit, in level flight."""
    state = FlightState(aircraft.airspeed_m_s, above_sea_m=above_sea_m)
    energy_wh = (
        0.0 if aircraft.power is None else aircraft.power.power_w(state) / aircraft.airspeed_m_s / 3600.0
    )
    return {"range": 1.0, "flight-time": 1.0 / aircraft.airspeed_m_s, "energy": energy_wh}


def limits_of(aircraft: Aircraft, use: Use) -> dict[str, tuple[float, float, str]]:
    """What is used, what there is, and the unit, of each limit that there is."""
    rows = {
        "range": (use.length_m, aircraft.max_range_m, "m"),
        "flight-time": (use.duration_s, aircraft.max_flight_time_s, "s"),
        "energy": (use.energy_wh, aircraft.usable_wh, "Wh"),
    }
    return {
        name: (used_, limit, unit)
        for name, (used_, limit, unit) in rows.items()
        if used_ is not None and limit is not None
    }


def part_used(aircraft: Aircraft, use: Use) -> float:
    """What part of the limit that is nearest is used; 0 without any."""
    return max((taken / limit for taken, limit, _ in limits_of(aircraft, use).values()), default=0.0)
