"""The database file: opened, migrated, guarded against a second service."""

from __future__ import annotations

import asyncio
import fcntl
import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from alembic import command
from alembic.config import Config
from sqlalchemy import create_engine, event, text
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.ext.asyncio import AsyncEngine, AsyncSession, async_sessionmaker, create_async_engine
from sqlalchemy.pool import NullPool

MIGRATIONS = Path(__file__).resolve().parents[2] / "migrations"


class DatabaseInUseError(RuntimeError):
    """Another service holds the database file."""


def _on_connect(connection: Any, record: object) -> None:
    cursor = connection.cursor()
    for pragma in ("journal_mode=WAL", "synchronous=NORMAL", "foreign_keys=ON", "busy_timeout=30000"):
        cursor.execute(f"PRAGMA {pragma}")
    cursor.close()


def migrate(path: Path) -> None:
    """Bring the tables of a database file up to date, creating the file when it is absent."""
    engine = create_engine(f"sqlite:///{path}", poolclass=NullPool)
    config = Config()
    config.set_main_option("script_location", str(MIGRATIONS).replace("%", "%%"))
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, "head")
    engine.dispose()


class Database:
    """Sessions on one database file.

    One service at a time: a lock file beside the database keeps a second one out, because each takes the
    plans it finds running at start for its predecessor's.
    """

    def __init__(self, path: Path) -> None:
        self.path = path.resolve()
        self._engine: AsyncEngine | None = None
        self._sessions: async_sessionmaker[AsyncSession] | None = None
        self._lock: int | None = None

    async def open(self) -> None:
        """Lock, migrate, connect."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        lock = os.open(self.path.with_name(self.path.name + ".lock"), os.O_RDWR | os.O_CREAT, 0o600)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            os.close(lock)
            raise DatabaseInUseError(f"another service is at work on {self.path}") from error
        self._lock = lock
        await asyncio.to_thread(migrate, self.path)
        self._engine = create_async_engine(f"sqlite+aiosqlite:///{self.path}")
        event.listen(self._engine.sync_engine, "connect", _on_connect)
        self._sessions = async_sessionmaker(self._engine, expire_on_commit=False)

    @asynccontextmanager
    async def session(self) -> AsyncIterator[AsyncSession]:
        """One transaction: committed at the end, rolled back on an error."""
        if self._sessions is None:
            raise RuntimeError("the database is not open")
        async with self._sessions.begin() as session:
            yield session

    async def answers(self) -> bool:
        """Whether the database can be read."""
        try:
            async with self.session() as session:
                return bool(await session.scalar(text("SELECT 1")))
        except SQLAlchemyError:
            return False

    async def close(self) -> None:
        """Disconnect and unlock."""
        if self._engine is not None:
            await self._engine.dispose()
            self._engine = self._sessions = None
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None
