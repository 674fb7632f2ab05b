"""Bodies of answers about flights."""

from __future__ import annotations

from dataclasses import asdict
from datetime import datetime
from typing import Literal, Self

from pydantic import BaseModel, Field

from app.services.records import FlightRecord


class FlightOut(BaseModel):
    """One flight."""

    id: str
    vehicle_id: str
    vehicle_name: str
    plan_id: str | None
    plan_vehicle: str | None
    state: Literal["flying", "ended", "interrupted"]
    started_at: datetime
    ended_at: datetime | None
    points: int
    payload: str | None = Field(description="How the sensor was switched; null for the default.")
    photos: int = Field(description="Reported by cameras.")
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


class FlightList(BaseModel):
    """Flights, newest first."""

    flights: list[FlightOut]
