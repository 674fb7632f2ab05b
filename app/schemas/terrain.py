"""Bodies of answers about elevation rasters."""

from __future__ import annotations

from datetime import datetime
from typing import Self

from pydantic import BaseModel, Field

from app.services.records import TerrainRecord


class TerrainOut(BaseModel):
    """An elevation raster's record."""

    id: str = Field(description="What the member `terrain` of a scenario holds.")
    name: str
    bounds_deg: tuple[float, float, float, float] = Field(description="West, south, east, north.")
    resolution_m: float = Field(description="Distance between posts, the finer of the two.")
    rows: int
    columns: int
    min_m: float
    max_m: float
    known_fraction: float = Field(description="The part of the posts that have a height.")
    datum: str = Field(description="What the heights count from.")
    sha256: str = Field(description="Of the file as it was sent.")
    created_at: datetime
    links: dict[str, str]

    @classmethod
    def of(cls, record: TerrainRecord) -> Self:
        """The answer for a record."""
        members = {name: getattr(record, name) for name in TerrainRecord.__slots__}
        return cls(**members, links={"self": f"/api/v1/terrain/{record.id}"})


class TerrainList(BaseModel):
    """Elevation rasters, newest first."""

    terrain: list[TerrainOut]
    total: int


class RasterGridOut(BaseModel):
    """A raster on a coarse grid, to be drawn: means of cells that are even in degrees."""

    bounds_deg: tuple[float, float, float, float] = Field(
        description="West, south, east, north: the outer edges of the outer cells."
    )
    columns: int
    rows: int
    values: list[float | None] = Field(
        description="Row by row from the north-west; null where the raster knows nothing."
    )
