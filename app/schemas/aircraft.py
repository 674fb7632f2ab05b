"""Bodies of answers about airframes."""

from __future__ import annotations

from typing import Any, Self

from pydantic import BaseModel, Field

from planner.vehicle.airframes import Airframe


class AircraftOut(BaseModel):
    """One airframe, by published figures."""

    name: str = Field(
        description="What a vehicle's `model` says in a scenario.", examples=["DJI Matrice 300 RTK"]
    )
    vehicle: dict[str, Any] = Field(description="What an entry of `vehicles` that names it begins with.")
    source: str = Field(description="Where the figures are published.")

    @classmethod
    def of(cls, airframe: Airframe) -> Self:
        """The answer for an airframe."""
        return cls(name=airframe.name, vehicle=dict(airframe.members), source=airframe.source)


class AircraftList(BaseModel):
    """The airframes found."""

    aircraft: list[AircraftOut]
