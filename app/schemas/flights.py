"""Bodies of answers about flights."""

from __future__ import annotations

from dataclasses import asdict
from datetime import datetime
from typing import Literal, Self

from pydantic import BaseModel, Field

from app.services.records import FlightRecord


class SensorActionOut(BaseModel):
    """A sensor that was left on, and that the service switched off by itself."""

    at: datetime
    time_s: float | None = Field(description="The vehicle's time since boot.")
    action: Literal["sensor_off"]
    reason: str = Field(examples=["mode RTL instead of the mission's"])
    outcome: str = Field(description="What the vehicle answered.", examples=["DO_SET_RELAY: accepted"])
    lon_deg: float | None
    lat_deg: float | None


class EnergyOut(BaseModel):
    """What a flight drew from its batteries."""

    used_wh: float
    source: Literal["counted", "charge", "integrated"] = Field(
        description="The battery's own count of energy; of charge, times its voltage; current times voltage."
    )
    complete: bool = Field(description="False where readings were missing meanwhile.")


class LinkEventOut(BaseModel):
    """A loss of the link, at the moment the vehicle was last heard, or its end."""

    kind: Literal["lost", "back"]
    at: datetime
    time_s: float | None = Field(description="The vehicle's time since boot.")


class FlightOut(BaseModel):
    """One flight."""

    id: str
    vehicle_id: str
    vehicle_name: str
    plan_id: str | None
    plan_vehicle: str | None
    plan_sortie: int = Field(description="Which of that vehicle's flights in the plan it followed.")
    state: Literal["flying", "ended", "interrupted"]
    started_at: datetime
    ended_at: datetime | None
    points: int
    payload: str | None = Field(description="How the sensor was switched; null for the default.")
    photos: int = Field(description="Reported by cameras.")
    actions: list[SensorActionOut] = Field(description="What the service did by itself meanwhile.")
    energy: EnergyOut | None = Field(description="By its batteries' telemetry; null where none tells.")
    link: list[LinkEventOut] = Field(description="When the link was lost and came back.")
    logs: list[str] = Field(description="Onboard logs that filled gaps of the track.")
    links: dict[str, str]

    @classmethod
    def of(cls, record: FlightRecord) -> Self:
        """The answer for a record."""
        base = f"/api/v1/flights/{record.id}"
        links = {"self": base} | {
            name: f"{base}/{name}"
            for name in ("track.geojson", "track.gpx", "coverage.geojson", "report.html")
        }
        return cls(**asdict(record), links=links)


class SpanOut(BaseModel):
    """A gap by the record's clock; no end where the record has none."""

    start_s: float
    end_s: float | None


class LeftOut(SpanOut):
    """A gap that stays."""

    why: str


class FilledOut(BaseModel):
    """What a log gave to a flight's record."""

    clock_s: float = Field(description="What the log's clock is behind the record's.")
    points: int
    photos: int
    filled: list[SpanOut]
    left: list[LeftOut]


class FlightList(BaseModel):
    """Flights, newest first."""

    flights: list[FlightOut]
