"""The database file: opened, migrated, guarded against a second service."""

from __future__ import annotations

import asyncio
import fcntl
import os
import sqlite3
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from typing import Any

import structlog
from sqlalchemy import create_engine, event, text
from sqlalchemy import exc as sql_errors
from sqlalchemy.ext.asyncio import AsyncEngine, AsyncSession, async_sessionmaker, create_async_engine
from sqlalchemy.pool import NullPool

from app.services.errors import StorageError
from app.services.store.faults import PROBE_BYTES, THOROUGH_BYTES, probe, storage_error

log = structlog.get_logger(__name__)

MIGRATIONS = Path(__file__).resolve().parents[2] / "migrations"


#: So long a write waits for other programs at the database, and for the service's own writes before it.
BUSY_S = 15
#: A connection is a thread; this many may read at once, and one write.
_CONNECTIONS = 12
#: So much is written before a process beside the service moves it into the file; the service does at 1000.
_CHECKPOINT_PAGES = 20_000


class DatabaseInUseError(RuntimeError):
    """Another service holds the database file."""


def _on_connect(connection: Any, record: object) -> None:
    cursor = connection.cursor()
    for pragma in (f"busy_timeout={BUSY_S * 1000}", "synchronous=NORMAL", "foreign_keys=ON"):
        cursor.execute(f"PRAGMA {pragma}")
    cursor.close()


def _leave_checkpoints(connection: Any, record: object) -> None:
    """Let the service move what was written into the file, which waits for the disk; unless there is none."""
    cursor = connection.cursor()
    cursor.execute(f"PRAGMA wal_autocheckpoint={_CHECKPOINT_PAGES}")
    cursor.close()


def migrate(path: Path) -> None:
    """Bring the tables of a database file up to date, creating the file when it is absent."""
    engine = create_engine(f"sqlite:///{path}", poolclass=NullPool)
    # Here: who opens a database that is up to date needs none of it.
    from alembic import command
    from alembic.config import Config

    # Once and for all: who connects while another program writes could not change it.
    with engine.connect() as connection:
        connection.exec_driver_sql("PRAGMA journal_mode=WAL")
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

    Parameters
    ----------
    alone
        Whether this is the service; a process beside it neither locks nor migrates.
    """

    def __init__(self, path: Path, *, alone: bool = True) -> None:
        self.path = path.resolve()
        self._alone = alone
        self._engine: AsyncEngine | None = None
        self._sessions: async_sessionmaker[AsyncSession] | None = None
        self._lock: int | None = None
        self._writing = asyncio.Lock()
        self._doubted = False

    async def open(self) -> None:
        """Lock, migrate, connect; raises StorageError where the file cannot be used."""
        if self._alone:
            await self._take()
        self._engine = create_async_engine(
            f"sqlite+aiosqlite:///{self.path}",
            pool_size=_CONNECTIONS,
            max_overflow=0,
            pool_timeout=BUSY_S,
        )
        event.listen(self._engine.sync_engine, "connect", _on_connect)
        if not self._alone:
            event.listen(self._engine.sync_engine, "connect", _leave_checkpoints)
        self._sessions = async_sessionmaker(self._engine, expire_on_commit=False)

    async def _take(self) -> None:
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            lock = os.open(self.path.with_name(self.path.name + ".lock"), os.O_RDWR | os.O_CREAT, 0o600)
            # SQLite gives what it lays beside a database the mode of that.
            os.close(os.open(self.path, os.O_RDWR | os.O_CREAT, 0o600))
        except OSError as error:
            raise StorageError(f"{error.filename} cannot be written: {error.strerror}") from error
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            os.close(lock)
            raise DatabaseInUseError(f"another service is at work on {self.path}") from error
        self._lock = lock
        try:
            await asyncio.to_thread(migrate, self.path)
        except sql_errors.DatabaseError as error:
            raise StorageError(f"{self.path}: {storage_error(error)}") from error

    @asynccontextmanager
    async def reading(self) -> AsyncIterator[AsyncSession]:
        """One transaction that changes nothing; raises StorageError where the database does not answer."""
        if self._sessions is None:
            raise RuntimeError("the database is not open")
        with self._told():
            async with self._sessions() as session:
                yield session

    @asynccontextmanager
    async def writing(self) -> AsyncIterator[AsyncSession]:
        """One transaction: committed at the end, rolled back on an error; raises StorageError.

        One after the other: writes that wait for another program take no connection from those who read.
        """
        if self._sessions is None:
            raise RuntimeError("the database is not open")
        with self._told():
            try:
                async with asyncio.timeout(BUSY_S):
                    await self._writing.acquire()
            except TimeoutError:
                raise StorageError("nothing can be kept now: other writes wait for the database") from None
            try:
                async with self._sessions.begin() as session:
                    yield session
            finally:
                self._writing.release()

    @contextmanager
    def _told(self) -> Iterator[None]:
        """What the database fails of as StorageError; the log has it once, until all is well again."""
        try:
            yield
        except sql_errors.IntegrityError:
            raise
        except (sql_errors.OperationalError, sql_errors.DatabaseError, sql_errors.TimeoutError) as error:
            self._doubt(error)
            raise storage_error(error) from error

    def _doubt(self, error: Exception) -> None:
        if not self._doubted:
            log.error("database fails", reason=str(getattr(error, "orig", error)), path=str(self.path))
        self._doubted = True

    async def answers(self) -> bool:
        """Whether the database can be read and written."""
        try:
            await asyncio.to_thread(probe, self.path, THOROUGH_BYTES if self._doubted else PROBE_BYTES)
            async with self.reading() as session:
                found = bool(await session.scalar(text("SELECT 1")))
        except (sqlite3.Error, StorageError) as error:
            self._doubt(error)
            return False
        if self._doubted:
            log.warning("database answers again")
        self._doubted = False
        return found

    async def close(self) -> None:
        """Disconnect and unlock."""
        if self._engine is not None:
            await self._engine.dispose()
            self._engine = self._sessions = None
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None
