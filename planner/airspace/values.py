"""Threats, zones, obstacles and wind, as they were asked for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from shapely.geometry import Polygon

from planner.route import Point

AltitudeReference = Literal["amsl", "home", "terrain"]


@dataclass(frozen=True, slots=True)
class Threat:
    """A missile site or a radar: soft unless ``hard``.

    ``intensity_m`` is δ of eq 13 (Li et al. 2018), for radars.
    """

    name: str
    model: Literal["missile", "radar"]
    centre: Point
    radius_m: float
    intensity_m: float = 0.0
    height_m: float = float("inf")
    hard: bool = False


@dataclass(frozen=True, slots=True)
class NoFlyZone:
    """Never entered between ``floor_m`` and ``ceiling_m`` amsl. A disc where ``radius_m`` is set.

    ``of_ground``: high ground, with what is kept over it in the shape already; it is not grown once more.
    """

    name: str
    area: Polygon | None
    centre: Point | None = None
    radius_m: float | None = None
    floor_m: float = float("-inf")
    ceiling_m: float = float("inf")
    of_ground: bool = False


@dataclass(frozen=True, slots=True)
class Obstacle:
    """Something that stands on the ground, or over it.

    Parameters
    ----------
    height_m
        From its base to its top; on terrain, from its base's height over home as if the ground were home's.
        That the base is added, where a map's ``height`` may have it within, is the safe side.
    base_m
        Over the ground it stands on. Nothing passes below it; it says that there is ground to be seen there.
    """

    name: str
    area: Polygon
    height_m: float
    base_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Wind:
    """Steady wind: speed, and the direction the air moves to."""

    speed_m_s: float = 0.0
    toward_rad: float = 0.0


STILL_AIR = Wind()
