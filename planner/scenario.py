"""What is asked: regions, threats, zones, aircraft, sensors, wishes.

All geometry is in the local frame (metres east and north); all angles are radians counter-clockwise from
east; altitudes are metres over the datum named by ``altitude_reference``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from shapely.geometry import Polygon

from planner.airspace.airspace import Airspace, Level
from planner.airspace.terrain import Ground
from planner.airspace.values import STILL_AIR, AltitudeReference, NoFlyZone, Obstacle, Threat, Wind
from planner.errors import Finding
from planner.frames import LocalFrame
from planner.route import Terminal
from planner.sensors.base import Sensor
from planner.sensors.suite import Suite
from planner.vehicle.aircraft import Aircraft
from planner.wishes import (
    DEFAULT_SEPARATION,
    Band,
    GoingOn,
    Importance,
    Method,
    Objective,
    Region,
    Separation,
)


@dataclass(frozen=True, slots=True)
class Scenario:
    """A whole request, validated; see ``planner.geojson.read_scenario``.

    ``looked_at`` is where zones were looked for, where some farther off were left out.

    Where there is terrain ``altitude_reference`` is ``amsl``; see ``planner.geojson.relief``. The flight is
    level, unless ``lowest_amsl_m`` says how far down it may come where it follows the ground.
    ``max_height_m`` is the greatest height over ground of passes that was asked for, ``band`` what flights
    may go up and down in between them to keep apart; None where they may not. ``bases`` are those that
    aircraft start from and return to by name; one that names none flies from ``start`` to ``end``. In a
    search the regions are the ground that is searched, and ``importance`` says what it is worth.
    """

    name: str
    frame: LocalFrame
    regions: tuple[Region, ...]
    aircraft: tuple[Aircraft, ...]
    sensors: tuple[Sensor, ...]
    start: Terminal
    end: Terminal
    altitude_m: float
    altitude_reference: AltitudeReference = "terrain"
    area: Polygon | None = None
    threats: tuple[Threat, ...] = ()
    no_fly: tuple[NoFlyZone, ...] = ()
    obstacles: tuple[Obstacle, ...] = ()
    wind: Wind = STILL_AIR
    clearance_m: float = 0.0
    objective: Objective = field(default_factory=Objective)
    method: Method = field(default_factory=Method)
    task: str = "collect"
    seed: int = 0
    time_budget_s: float | None = None
    scenario_hash: str = ""
    home_amsl_m: float | None = None
    warnings: tuple[Finding, ...] = ()
    terrain: Ground | None = None
    over_ground_m: float = 0.0
    looked_at: Polygon | None = None
    lowest_amsl_m: float | None = None
    terrain_following: bool = False
    max_height_m: float | None = None
    band: Band | None = None
    bases: tuple[Terminal, ...] = ()
    separation: Separation | None = None
    importance: Importance = field(default_factory=Importance)
    going_on: GoingOn | None = None

    def ends_of(self, aircraft: Aircraft) -> tuple[Terminal, Terminal]:
        """Where an aircraft starts, and where it ends."""
        base = next((base for base in self.bases if base.name == aircraft.base), None)
        ends = (self.start, self.end) if base is None else (base, Terminal(base.name, base.position))
        ends = (ends[0], next(iter(self._named(aircraft)), ends[1]))
        if aircraft.aloft is None:
            return ends
        aloft = aircraft.aloft
        place: tuple[float, float] = tuple(self.frame.to_local((aloft.lon_deg, aloft.lat_deg)).tolist())
        angle_rad = None
        if aloft.heading_deg is not None:
            angle_rad = self.frame.angle_rad(*place, aloft.heading_deg)
        return replace(
            ends[0], position=place, angle_rad=angle_rad, over_home_m=aloft.height_m, home=ends[0].ground
        ), ends[1]

    def _named(self, aircraft: Aircraft) -> tuple[Terminal, ...]:
        named = {base.name: Terminal(base.name, base.position) for base in self.bases}
        return tuple(named[name] for name in aircraft.end_bases or () if name in named)

    def landings_of(self, aircraft: Aircraft) -> tuple[Terminal, ...]:
        """Where an aircraft may end: at any of the bases that it names, else at its one end."""
        return self._named(aircraft) or (self.ends_of(aircraft)[1],)

    def landing_at(self, aircraft: Aircraft, end: Terminal) -> Scenario:
        """What one aircraft may be asked, as ``of_one``, if it ends there."""
        alone = self.of_one(aircraft)
        plain = tuple(replace(each, base=None, end_bases=None) for each in alone.aircraft)
        return replace(alone, start=self.ends_of(aircraft)[0], end=end, aircraft=plain, bases=())

    def home_from(self, start: Terminal) -> Scenario:
        """The same with the home that an autopilot has on board: the ground that a flight takes off from.

        Over terrain that of one base is another height than that of the next. Altitudes count from the sea
        then, and stay; heights of what stands on the ground are over home, and of another one.
        """
        if self.terrain is None or self.home_amsl_m is None:
            return self
        home_amsl_m = float(self.terrain.at(start.ground))
        lower_m = self.home_amsl_m - home_amsl_m
        if lower_m == 0.0 or math.isnan(lower_m):
            return self
        return replace(
            self,
            home_amsl_m=home_amsl_m,
            threats=tuple(replace(each, height_m=each.height_m + lower_m) for each in self.threats),
            obstacles=tuple(replace(each, height_m=each.height_m + lower_m) for each in self.obstacles),
        )

    def of_one(self, aircraft: Aircraft) -> Scenario:
        """What one of several aircraft may be asked: the regions its sensors see, from its own ends.

        Each region names its sensor: another may be the first on board. Ground searched with no sensor named
        is searched with the first on board. Heights are over its own home.
        """
        start, end = self.ends_of(aircraft)
        if len(self.aircraft) == 1:
            alone = self if aircraft.aloft is None else replace(self, start=start, end=end)
            return alone.home_from(start)
        asked = [(region, self._sensor_aboard(region, aircraft)) for region in self.regions]
        regions = tuple(replace(region, sensor=name) for region, name in asked if aircraft.carries(name))
        suite = self.suite.aboard(aircraft, self.level.amsl_m)
        return replace(
            self, aircraft=(aircraft,), sensors=suite.sensors, regions=regions, start=start, end=end, bases=()
        ).home_from(start)

    def _sensor_aboard(self, region: Region, aircraft: Aircraft) -> str:
        aboard = (sensor.name for sensor in self.sensors if aircraft.carries(sensor.name))
        first = next(aboard, None)
        searched_with_any = self.task == "search" and region.sensor is None
        return first if searched_with_any and first is not None else self.sensor_for(region).name

    @property
    def kept_apart(self) -> Separation:
        """What aircraft keep from each other."""
        return self.separation or DEFAULT_SEPARATION

    @property
    def is_fleet(self) -> bool:
        """Whether more is asked than one flight of one aircraft at any time."""
        return (
            len(self.aircraft) > 1
            or self.method.routing == "stecz2020"
            or any(aircraft.batteries > 1 or aircraft.end_bases is not None for aircraft in self.aircraft)
            or any(region.time_window_s is not None for region in self.regions)
            or any(region.revisit_after_s > 0.0 for region in self.regions)
        )

    def terminals(self) -> tuple[Terminal, ...]:
        """Every place where a flight starts or ends, those of one place once."""
        found: dict[tuple[float, float], Terminal] = {}
        for aircraft in self.aircraft:
            for terminal in (self.ends_of(aircraft)[0], *self.landings_of(aircraft)):
                found.setdefault(terminal.position, terminal)
        return tuple(found.values())

    @property
    def airspace(self) -> Airspace:
        """Where one may fly."""
        return Airspace(
            self.area, self.threats, self.no_fly, self.obstacles, self.clearance_m, self.terrain, self.wind,
            self.home_amsl_m, self.over_ground_m,
        )  # fmt: skip

    @property
    def level(self) -> Level:
        """The highest level that regions are seen from, and how far below it the lowest lies."""
        altitudes_m = [
            self.altitude_m if region.altitude_m is None else region.altitude_m for region in self.regions
        ] or [self.altitude_m]
        top_m = max(altitudes_m)
        level = self.airspace.level(top_m, self.altitude_reference)
        spread_m = 0.0 if self.lowest_amsl_m is None else level.amsl_m - self.lowest_amsl_m
        return replace(level, depth_m=top_m - min(altitudes_m), spread_m=spread_m)

    @property
    def height_m(self) -> float:
        """Flight height over the ground, which is flat at the height of home: the greatest of several."""
        return self.level.height_m

    @property
    def altitude_amsl_m(self) -> float:
        """Flight altitude over mean sea level, where the height of home is known."""
        return self.level.amsl_m

    @property
    def suite(self) -> Suite:
        """The sensors on board."""
        return Suite(self.sensors)

    def sensor_for(self, region: Region) -> Sensor:
        """The sensor asked for by a region, else the first."""
        return self.suite.of(region)
