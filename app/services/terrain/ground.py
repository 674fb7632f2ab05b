"""The ground's heights for vehicles that ask, from the rasters that were uploaded."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from app.services.desk import Desk
from app.services.errors import ServiceError

Place = tuple[float, float]


def terrain_folder(database: Path) -> Path:
    """Where the posts of uploaded rasters lie: beside the database, each raster in a file of its own."""
    return database.resolve().with_name(database.stem + "-terrain")


class GroundService:
    """Heights over mean sea level, worked out at a desk.

    Parameters
    ----------
    folder
        Where the rasters' posts are, a file each; the newest that knows a place counts.
    """

    def __init__(self, folder: Path, desk: Desk) -> None:
        self._folder = folder
        self._desk = desk

    async def heights(self, places_deg: Sequence[Place]) -> Sequence[float | None]:
        """Heights in metres at places (longitude, latitude); None where no raster knows one.

        What cannot be worked out now is not known now: the vehicle asks again.
        """
        try:
            return await self._desk.run("terrain", heights_in, self._folder, tuple(places_deg))
        except ServiceError:
            return [None] * len(places_deg)


def heights_in(folder: Path, places_deg: Sequence[Place]) -> list[float | None]:
    """Heights at places from the rasters of a folder; in a worker."""
    # The process that holds the links is to load nothing of the kind.
    from app.services.terrain import sampling

    return sampling.heights_in(folder, places_deg)
