"""What a plan tells of the aircraft, what is on board, and the wind they fly in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from planner.plan.words import Finish, LonLat, Trigger


@dataclass(frozen=True, slots=True)
class PlanVehicle:
    """What the mission needs to know of the aircraft.

    ``home`` is where it takes off and ``end`` where it finishes; None where the plan's own are.
    ``home_altitude_m`` is the altitude of home over the plan's datum where the path begins in the air; None
    where it begins on the ground, at home.
    """

    name: str
    type: Literal["fixed_wing", "multirotor", "vtol"]
    autopilot: Literal["ardupilot", "px4"]
    airspeed_m_s: float
    min_turn_radius_m: float
    max_climb_deg: float = 8.0
    finish: Finish = "land"
    home: LonLat | None = None
    end: LonLat | None = None
    home_altitude_m: float | None = None


@dataclass(frozen=True, slots=True)
class PlanWind:
    """The steady wind that the plan is made for: its speed, and where it comes from, from true north."""

    speed_m_s: float = 0.0
    from_deg: float = 0.0


STILL_AIR: Final = PlanWind()


@dataclass(frozen=True, slots=True)
class PlanCamera:
    """What a mission and the judge of its flight need to know of a camera.

    Parameters
    ----------
    focal_length_m, pixel_pitch_m
        Of the lens itself, and between pixels.
    columns, rows
        Pixels across and along the flight direction, as it is mounted.
    forward_overlap, side_overlap
        Parts of a photo that the next, and that of the next lane, see again.
    tilt_deg
        Of its axis, from straight down forwards.
    min_interval_s
        Shortest time between two photos; 0 where unknown.
    trigger
        Photos by distance flown, by time, or one video for each collect.
    model
        Its name in the camera database; None for one given by its figures.
    """

    name: str
    focal_length_m: float
    pixel_pitch_m: float
    columns: int
    rows: int
    forward_overlap: float
    side_overlap: float
    tilt_deg: float = 0.0
    min_interval_s: float = 0.0
    trigger: Trigger = "distance"
    model: str | None = None
    spectrum: Literal["visible", "infrared"] = "visible"
