"""Elevation rasters: taken in, checked, kept, found again."""

from __future__ import annotations

import contextlib
import hashlib
import uuid
from dataclasses import replace
from pathlib import Path

import numpy as np

from app.services.desk import Desk
from app.services.errors import RefusedError, StorageError
from app.services.records import TerrainRecord
from app.services.store.plans import now
from app.services.store.terrain import TerrainStore
from app.services.terrain.picture import Bounds, RasterGrid, drawn
from app.services.terrain.rasters import VerticalDatum, known_fraction, pack, read_raster
from planner.errors import Finding


class TerrainService:
    """The rasters of one service.

    Parameters
    ----------
    store
        Where their records are.
    folder
        Where their posts are, a file each; made when the first comes.
    desk
        Where files are read.
    """

    def __init__(self, store: TerrainStore, folder: Path, desk: Desk) -> None:
        self._store = store
        self.folder = folder
        self._desk = desk

    async def add(
        self, content: bytes, filename: str, name: str | None, datum: VerticalDatum | None
    ) -> tuple[TerrainRecord, bool]:
        """Take in a file; returns its record and whether it is new.

        The same file with the same datum is kept once.

        Raises
        ------
        RefusedError
            The file is no elevation raster that can be used; see ``read_raster``.
        """
        if not content:
            finding = Finding("terrain", "raster-format", "the body is empty", "Send the file as the body.")
            raise RefusedError("the raster is refused: the body is empty", (finding,))
        sha256 = hashlib.sha256(content).hexdigest()
        known = await self._store.by_sha256(sha256)
        if known is not None and (datum is None or datum == known.datum):
            return known, False
        title = (name or Path(filename).stem or "terrain")[:200]
        record = await self._desk.run(
            "terrain", _taken_in, self.folder, content, filename, title, sha256, datum
        )
        try:
            await self._store.add(record)
        except BaseException:
            # Nobody would ever find its posts.
            self._file(record.id).unlink(missing_ok=True)
            raise
        return record, True

    def _file(self, terrain_id: str) -> Path:
        return self.folder / f"{terrain_id}.npz"

    async def get(self, terrain_id: str) -> TerrainRecord:
        """One raster's record; raises NotFoundError."""
        return await self._store.get(terrain_id)

    async def newest(self, limit: int, offset: int) -> tuple[TerrainRecord, ...]:
        """Records, newest first."""
        return await self._store.newest(limit, offset)

    async def count(self) -> int:
        """How many there are."""
        return await self._store.count()

    async def grid(self, terrain_id: str, bounds_deg: Bounds | None, cells: int) -> RasterGrid:
        """A raster, or what of it lies within bounds, as a grid of at most so many cells a side.

        Raises
        ------
        NotFoundError
            There is none of the name.
        RefusedError
            Nothing of it lies within the bounds.
        """
        await self._store.get(terrain_id)
        return await self._desk.run("terrain", drawn, self.folder, terrain_id, bounds_deg, cells)

    async def remove(self, terrain_id: str) -> None:
        """Forget a raster; plans made on it stay. Raises NotFoundError."""
        await self._store.delete(terrain_id)
        self._file(terrain_id).unlink(missing_ok=True)


def _taken_in(
    folder: Path, content: bytes, filename: str, name: str, sha256: str, datum: VerticalDatum | None
) -> TerrainRecord:
    """Read a file and keep its posts."""
    terrain_id = str(uuid.uuid4())
    terrain = replace(read_raster(content, filename, name, datum), name=terrain_id)
    partial = folder / f".{terrain_id}.partial"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        partial.write_bytes(pack(terrain))
        partial.replace(folder / f"{terrain_id}.npz")
    except OSError as error:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)
        raise StorageError(
            f"the raster cannot be kept: {error.strerror}; make room, or see to the rights"
        ) from None
    rows, columns = terrain.heights_m.shape
    return TerrainRecord(
        id=terrain_id,
        name=name,
        bounds_deg=terrain.bounds_deg,
        resolution_m=terrain.resolution_m,
        rows=rows,
        columns=columns,
        min_m=float(np.nanmin(terrain.heights_m)),
        max_m=float(np.nanmax(terrain.heights_m)),
        known_fraction=known_fraction(terrain),
        datum=terrain.datum,
        sha256=sha256,
        created_at=now(),
    )
