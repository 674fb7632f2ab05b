"""How soon an autopilot flies steadily behind a turn, and how steadily then: what passes leave room for.

Straight flight that takes an autopilot seconds takes it metres by the ground speed, so seconds are what is
known of it. Figures are those of flights in the autopilots' own simulators (``docs/ardupilot.md``,
``docs/px4.md``, ``docs/transit.md``).
"""

from __future__ import annotations

from dataclasses import dataclass

from planner.vehicle.aircraft import Autopilot, VehicleType


@dataclass(frozen=True, slots=True)
class Steadiness:
    """What a pass of an aircraft is planned with where its scenario does not say.

    Parameters
    ----------
    settle_s
        Straight flight before a pass, until the line and the course are held and the wings are level.
    pointing_deg
        Roll that is left then, and yaw.
    position_m
        Distance from the line that is left.
    kept_m
        Kept from what must not be entered: the widest of what lines and arcs are flown off, so that the
        aircraft stays out where its planned line does.
    """

    settle_s: float
    pointing_deg: float
    position_m: float
    kept_m: float


_STEADINESS: dict[tuple[Autopilot, VehicleType], Steadiness] = {
    ("ardupilot", "fixed_wing"): Steadiness(10.0, 1.5, 5.0, 30.0),
    ("ardupilot", "vtol"): Steadiness(10.0, 1.5, 5.0, 30.0),
    ("ardupilot", "multirotor"): Steadiness(3.0, 1.5, 2.0, 5.0),
    ("px4", "fixed_wing"): Steadiness(11.0, 3.0, 5.0, 20.0),
    ("px4", "vtol"): Steadiness(15.0, 3.0, 5.0, 20.0),
    ("px4", "multirotor"): Steadiness(3.0, 1.5, 2.0, 5.0),
}


def steadiness_of(autopilot: Autopilot, kind: VehicleType) -> Steadiness:
    """Of an autopilot that flies a kind of aircraft."""
    return _STEADINESS[autopilot, kind]
