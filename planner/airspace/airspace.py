"""Where one may fly: the area, what stands and threatens in it, the ground, the wind; and at which level."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

from shapely.geometry import Polygon

from planner.airspace.terrain import Ground
from planner.airspace.values import STILL_AIR, AltitudeReference, NoFlyZone, Obstacle, Threat, Wind


class HasAltitude(Protocol):
    """A region, or several merged."""

    @property
    def altitude_m(self) -> float | None:
        """Of its passes, over the reference; None where it asks for none."""

    @property
    def over_ground_m(self) -> float | None:
        """Height of its passes where they follow the ground; None where they are level."""


@dataclass(frozen=True, slots=True)
class Level:
    """A height flown level.

    Parameters
    ----------
    height_m
        Over the ground, which is flat at the height of home.
    amsl_m
        Over mean sea level.
    reference
        What its altitude is told over.
    depth_m
        So far below it lies the lowest of the levels that a route with passes at several heights is flown at;
        0 where it is the only one.
    spread_m
        So far below it any place may be flown over, by a flight that follows the ground; 0 where it is level.
    over_ground_m
        Height of passes that follow the ground; None for level ones.
    """

    height_m: float
    amsl_m: float
    reference: AltitudeReference = "terrain"
    depth_m: float = 0.0
    spread_m: float = 0.0
    over_ground_m: float | None = None

    @property
    def altitude_m(self) -> float:
        """Over the reference."""
        return self.amsl_m if self.reference == "amsl" else self.height_m

    @property
    def lowest(self) -> Level:
        """The lowest of the levels flown, or of what is flown over ground that is followed."""
        return self.at(self.altitude_m - max(self.depth_m, self.spread_m))

    @property
    def counted_m(self) -> tuple[float, float]:
        """From and up to which height a shape has to reach to count: at all levels, or anywhere followed."""
        if self.spread_m > 0.0:
            return self.height_m - self.spread_m, self.height_m
        return self.height_m, self.lowest.height_m

    def at(self, altitude_m: float) -> Level:
        """The level of another altitude over the same reference, by itself."""
        change_m = altitude_m - self.altitude_m
        if self.reference == "amsl":
            return Level(self.height_m + change_m, altitude_m, self.reference)
        return Level(altitude_m, self.amsl_m + change_m, self.reference)

    def of(self, region: HasAltitude) -> Level:
        """The level of a region's passes: its own, else this one."""
        if region.over_ground_m is not None:
            return replace(self, over_ground_m=region.over_ground_m)
        return self if region.altitude_m is None else self.at(region.altitude_m)


@dataclass(frozen=True, slots=True)
class Airspace:
    """Where one may fly.

    What is hard or soft in it depends on the level flown: see ``shapes.hard_shapes``, ``shapes.soft_shapes``
    and ``zones.keep_out``.

    Parameters
    ----------
    area
        Everything flown stays inside; None where not limited.
    clearance_m
        Kept from everything hard, beside it, over it and under it: obstacles, no-fly zones, hard threats.
    over_ground_m
        Kept over terrain.
    terrain
        The ground's heights; flat at the height of home where None.
    home_amsl_m
        Height of home over mean sea level; None where unknown.
    """

    area: Polygon | None = None
    threats: tuple[Threat, ...] = ()
    no_fly: tuple[NoFlyZone, ...] = ()
    obstacles: tuple[Obstacle, ...] = ()
    clearance_m: float = 0.0
    terrain: Ground | None = None
    wind: Wind = STILL_AIR
    home_amsl_m: float | None = None
    over_ground_m: float = 0.0

    def level(self, altitude_m: float, reference: AltitudeReference) -> Level:
        """The level of an altitude.

        Where the height of home is unknown it counts as sea level; a scenario read from GeoJSON has nothing
        then whose meaning depends on it (``planner.geojson.home``).
        """
        home_m = self.home_amsl_m or 0.0
        if reference == "amsl":
            return Level(altitude_m - home_m, altitude_m, reference)
        return Level(altitude_m, altitude_m + home_m, reference)
