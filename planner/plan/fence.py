"""Where the vehicles may and may not fly."""

from __future__ import annotations

from dataclasses import dataclass

from planner.plan.words import LonLat, Ring


@dataclass(frozen=True, slots=True)
class ZonePolygon:
    """A horizontal polygon of the fence: the outer ring, without its closing point, and an altitude band."""

    name: str
    ring: Ring
    floor_m: float | None = None
    ceiling_m: float | None = None


@dataclass(frozen=True, slots=True)
class ZoneCircle:
    """A disc of the fence."""

    name: str
    centre: LonLat
    radius_m: float
    floor_m: float | None = None
    ceiling_m: float | None = None


@dataclass(frozen=True, slots=True)
class Fence:
    """Where the vehicles may and may not fly.

    ``home_altitude_m`` is what floors and ceilings count from, over the plan's datum: where the scenario
    starts, which of several bases may be another than a vehicle's; None where that is every vehicle's home.
    """

    inclusion: tuple[ZonePolygon, ...] = ()
    exclusion: tuple[ZonePolygon, ...] = ()
    exclusion_circles: tuple[ZoneCircle, ...] = ()
    home_altitude_m: float | None = None
