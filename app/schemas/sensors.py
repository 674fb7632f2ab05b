"""Bodies of answers about the camera database."""

from __future__ import annotations

from dataclasses import asdict
from typing import Literal, Self

from pydantic import BaseModel, Field

from planner.sensors.cameras import Camera, Kind
from planner.sensors.quality import Spectrum
from planner.sensors.radars import Radar


class SensorOut(BaseModel):
    """One camera with its lens, by the figures its maker publishes."""

    name: str = Field(
        description="What a sensor's `model` says in a scenario.", examples=["Sony a6000 16 mm"]
    )
    kind: Kind
    type: Literal["camera"] = "camera"
    spectrum: Spectrum
    focal_length_m: float = Field(description="Of the lens itself, not its equivalent on 35 mm film.")
    pixel_pitch_m: float
    image_px: tuple[int, int] = Field(description="Pixels across and along the flight direction.")
    min_interval_s: float = Field(description="Shortest time between two photos; 0: not published.")
    source: str = Field(description="Where the figures are published.")

    @classmethod
    def of(cls, camera: Camera) -> Self:
        """The answer for a camera."""
        optics = camera.optics
        return cls(
            name=camera.name,
            kind=camera.kind,
            spectrum=camera.spectrum,
            focal_length_m=optics.focal_length_m,
            pixel_pitch_m=optics.pixel_pitch_m,
            image_px=(optics.columns, optics.rows),
            min_interval_s=camera.min_interval_s,
            source=camera.source,
        )


class RadarOut(BaseModel):
    """One radar by published figures: what a scenario's entry of `sensors` may begin with."""

    name: str
    type: Literal["sar"] = "sar"
    mode: str
    look: str
    incidence_deg: float
    elevation_beamwidth_deg: float
    azimuth_beamwidth_deg: float
    resolution_m: float | None = Field(description="null: not published.")
    wavelength_m: float | None
    source: str = Field(description="Where the figures are published.")

    @classmethod
    def of(cls, radar: Radar) -> Self:
        """The answer for a radar."""
        return cls(**asdict(radar))


class SensorList(BaseModel):
    """Cameras, and radars."""

    sensors: list[SensorOut]
    radars: list[RadarOut]
