"""Uploaded elevation rasters in the database; their posts are in files beside it."""

from __future__ import annotations

from sqlalchemy import delete, func, select

from app.services.errors import NotFoundError
from app.services.records import TerrainRecord
from app.services.store.database import Database
from app.services.store.tables import TerrainRow


def _record(row: TerrainRow) -> TerrainRecord:
    return TerrainRecord(
        id=row.id,
        name=row.name,
        bounds_deg=(row.west_deg, row.south_deg, row.east_deg, row.north_deg),
        resolution_m=row.resolution_m,
        rows=row.rows,
        columns=row.columns,
        min_m=row.min_m,
        max_m=row.max_m,
        known_fraction=row.known_fraction,
        datum=row.datum,
        sha256=row.sha256,
        created_at=row.created_at,
    )


class TerrainStore:
    """Rasters: added, found by id or by content, deleted."""

    def __init__(self, database: Database) -> None:
        self._database = database

    async def add(self, record: TerrainRecord) -> None:
        """A new raster."""
        west_deg, south_deg, east_deg, north_deg = record.bounds_deg
        row = TerrainRow(
            id=record.id,
            name=record.name,
            west_deg=west_deg,
            south_deg=south_deg,
            east_deg=east_deg,
            north_deg=north_deg,
            resolution_m=record.resolution_m,
            rows=record.rows,
            columns=record.columns,
            min_m=record.min_m,
            max_m=record.max_m,
            known_fraction=record.known_fraction,
            datum=record.datum,
            sha256=record.sha256,
            created_at=record.created_at,
        )
        async with self._database.writing() as session:
            session.add(row)

    async def get(self, terrain_id: str) -> TerrainRecord:
        """One raster; raises NotFoundError."""
        async with self._database.reading() as session:
            row = await session.scalar(select(TerrainRow).where(TerrainRow.id == terrain_id))
        if row is None:
            raise NotFoundError("terrain", terrain_id)
        return _record(row)

    async def by_sha256(self, sha256: str) -> TerrainRecord | None:
        """The raster with this content, read the same way, where there is one."""
        async with self._database.reading() as session:
            row = await session.scalar(select(TerrainRow).where(TerrainRow.sha256 == sha256))
        return None if row is None else _record(row)

    async def newest(self, limit: int, offset: int) -> tuple[TerrainRecord, ...]:
        """Rasters, newest first."""
        query = select(TerrainRow).order_by(TerrainRow.number.desc()).limit(limit).offset(offset)
        async with self._database.reading() as session:
            return tuple(_record(row) for row in await session.scalars(query))

    async def count(self) -> int:
        """How many there are."""
        async with self._database.reading() as session:
            return await session.scalar(select(func.count()).select_from(TerrainRow)) or 0

    async def delete(self, terrain_id: str) -> None:
        """Forget one; raises NotFoundError."""
        async with self._database.writing() as session:
            result = await session.execute(
                delete(TerrainRow).where(TerrainRow.id == terrain_id).returning(TerrainRow.id)
            )
            if result.first() is None:
                raise NotFoundError("terrain", terrain_id)
