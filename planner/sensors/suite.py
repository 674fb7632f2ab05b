"""The sensors on board, by name, and how they look at the ground of an area from a level."""

from __future__ import annotations

from dataclasses import dataclass, replace

from shapely.geometry import MultiPolygon, Polygon

from planner.airspace.airspace import Airspace, Level
from planner.airspace.envelope import SMOOTH_M
from planner.sensors.base import Sensor
from planner.sensors.camera import CameraSensor
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.atmosphere import true_over_equivalent
from planner.wishes import Region

#: Heights between the posts of a plan are known to this.
RELIEF_MARGIN_M = 0.5


def camera_on(camera: CameraSensor, aircraft: Aircraft, amsl_m: float) -> CameraSensor:
    """A camera on an aircraft so high over the sea: what hovers flies at a speed over the ground."""
    thin = 1.0 if aircraft.hovers else true_over_equivalent(amsl_m)
    return replace(camera, airspeed_m_s=aircraft.airspeed_m_s, thin=thin)


@dataclass(frozen=True, slots=True)
class Suite:
    """The sensors; the first is meant where a region names none."""

    sensors: tuple[Sensor, ...]

    @property
    def first(self) -> str:
        """Name of the one meant where none is named."""
        return self.sensors[0].name

    def named(self, name: str | None) -> Sensor:
        """The sensor of a name."""
        if name is None:
            return self.sensors[0]
        return next(sensor for sensor in self.sensors if sensor.name == name)

    def of(self, region: Region) -> Sensor:
        """The sensor asked for by a region."""
        return self.named(region.sensor)

    def aboard(self, aircraft: Aircraft, amsl_m: float) -> Suite:
        """Those that an aircraft carries, its cameras told how fast they are flown so high over the sea."""
        carried = [sensor for sensor in self.sensors if aircraft.carries(sensor.name)]
        return Suite(
            tuple(camera_on(s, aircraft, amsl_m) if isinstance(s, CameraSensor) else s for s in carried)
        )

    def in_wind(self, drift: float, toward_rad: float) -> Suite:
        """The same on an aircraft in a steady wind: its speed by the airspeed, and where the air moves to."""
        return replace(self, sensors=tuple(sensor.in_wind(drift, toward_rad) for sensor in self.sensors))

    def over(
        self, name: str | None, area: Polygon | MultiPolygon, airspace: Airspace, level: Level
    ) -> tuple[Sensor, float]:
        """A sensor and the flight height over the ground of an area, for the stages that plan its passes.

        On terrain the height is that over the middle between the area's lowest and highest ground, and the
        sensor allows for the relief between; where passes follow the ground it is theirs, and the relief that
        beside the track.
        """
        sensor = self.named(name)
        if airspace.terrain is None:
            return sensor, level.height_m
        if level.over_ground_m is not None:
            height_m = level.over_ground_m - SMOOTH_M
            beside_m = airspace.terrain.relief_beside_m(area, sensor.swath_m(height_m) / 2.0)
            return sensor.over_relief(beside_m + SMOOTH_M), height_m
        low_m, high_m = airspace.terrain.range_over(area)
        relief_m = (high_m - low_m) / 2.0 + RELIEF_MARGIN_M
        return sensor.over_relief(relief_m), level.amsl_m - (low_m + high_m) / 2.0
