"""What is asked: regions, threats, zones, aircraft, sensors, wishes.

All geometry is in the local frame (metres east and north); all angles are radians counter-clockwise from
east; altitudes are metres over the datum named by ``altitude_reference``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from shapely.geometry import LineString, MultiPolygon, Polygon

from planner.airspace.terrain import Ground
from planner.errors import Finding
from planner.frames import LocalFrame
from planner.sensors.sar import SarSensor
from planner.vehicle.aircraft import Aircraft

Point = tuple[float, float]
AltitudeReference = Literal["amsl", "home", "terrain"]


@dataclass(frozen=True, slots=True)
class Region:
    """A region of interest, as an area on the ground.

    A corridor (LineString with width) and a target (Point with radius) arrive here as the area they mean.
    ``approach_rad`` holds the allowed flight directions, None for any; ``revisits`` how often it is to be
    seen, on separate occasions; ``axis`` the line a corridor follows.
    """

    name: str
    area: Polygon | MultiPolygon
    priority: float = 1.0
    required: bool = True
    sensor: str | None = None
    min_resolution_m: float | None = None
    approach_rad: tuple[float, ...] | None = None
    revisits: int = 1
    axis: LineString | None = None


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
    """Never entered between ``floor_m`` and ``ceiling_m`` amsl. A disc where ``radius_m`` is set."""

    name: str
    area: Polygon | None
    centre: Point | None = None
    radius_m: float | None = None
    floor_m: float = float("-inf")
    ceiling_m: float = float("inf")


@dataclass(frozen=True, slots=True)
class Obstacle:
    """Something standing on the ground; kept clear by the scenario's ``clearance_m``."""

    name: str
    area: Polygon
    height_m: float
    base_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Terminal:
    """Where the flight starts or ends; any direction where ``angle_rad`` is None."""

    name: str
    position: Point
    angle_rad: float | None = None


@dataclass(frozen=True, slots=True)
class Wind:
    """Steady wind: speed, and the direction the air moves to."""

    speed_m_s: float = 0.0
    toward_rad: float = 0.0


@dataclass(frozen=True, slots=True)
class Objective:
    """Weights of the cost terms: w1, w2, w3 of eq 25 (Li et al. 2018) and two more."""

    length: float = 1.0
    missile: float = 1.0
    radar: float = 1.0
    energy: float = 0.0
    turns: float = 0.0


@dataclass(frozen=True, slots=True)
class Method:
    """The algorithm of each stage, by name."""

    coverage: str = "auto"
    routing: str = "auto"
    transit: str = "auto"
    smoothing: str = "auto"
    search: str = "auto"


@dataclass(frozen=True, slots=True)
class Scenario:
    """A whole request, validated; see ``planner.geojson.read_scenario``.

    Where there is terrain the flight is level and ``altitude_reference`` is ``amsl``; see
    ``planner.geojson.relief``.
    """

    name: str
    frame: LocalFrame
    regions: tuple[Region, ...]
    aircraft: tuple[Aircraft, ...]
    sensors: tuple[SarSensor, ...]
    start: Terminal
    end: Terminal
    altitude_m: float
    altitude_reference: AltitudeReference = "terrain"
    area: Polygon | None = None
    threats: tuple[Threat, ...] = ()
    no_fly: tuple[NoFlyZone, ...] = ()
    obstacles: tuple[Obstacle, ...] = ()
    wind: Wind = Wind()
    clearance_m: float = 0.0
    objective: Objective = Objective()
    method: Method = Method()
    seed: int = 0
    time_budget_s: float | None = None
    scenario_hash: str = ""
    home_amsl_m: float | None = None
    warnings: tuple[Finding, ...] = ()
    terrain: Ground | None = None

    @property
    def height_m(self) -> float:
        """Flight height over the ground, which is flat at the height of home."""
        if self.altitude_reference == "amsl":
            return self.altitude_m - (self.home_amsl_m or 0.0)
        return self.altitude_m

    @property
    def altitude_amsl_m(self) -> float:
        """Flight altitude over mean sea level; home counts as sea level where its height is unknown."""
        if self.altitude_reference == "amsl":
            return self.altitude_m
        return self.altitude_m + (self.home_amsl_m or 0.0)

    def sensor_for(self, region: Region) -> SarSensor:
        """The sensor asked for by a region, else the first."""
        if region.sensor is None:
            return self.sensors[0]
        return next(sensor for sensor in self.sensors if sensor.name == region.sensor)
