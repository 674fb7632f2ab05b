"""Databases that fail: what is told of it, and when they are believed again."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest
from sqlalchemy import text

from app.services.errors import StorageError
from app.services.store import database as databases
from app.services.store.database import Database
from app.services.store.faults import probe, storage_error


def full(path: Path) -> None:
    """Write to a database that may not grow."""
    connection = sqlite3.connect(path)
    connection.execute("PRAGMA max_page_count = 1")
    connection.execute("CREATE TABLE other (filler BLOB)")


def held(path: Path) -> None:
    """Write to a database that another connection holds."""
    holder = sqlite3.connect(path, isolation_level=None)
    holder.execute("BEGIN EXCLUSIVE")
    sqlite3.connect(path, timeout=0).execute("CREATE TABLE other (filler BLOB)")


def read_only(path: Path) -> None:
    """Write to a database that may only be read."""
    sqlite3.connect(f"file:{path}?mode=ro", uri=True).execute("CREATE TABLE other (filler BLOB)")


def nowhere(path: Path) -> None:
    """Open a database in a folder that is not there."""
    sqlite3.connect(path / "no" / "such")


def garbage(path: Path) -> None:
    """Read what is no database."""
    path.write_bytes(b"no database at all" * 100)
    sqlite3.connect(path).execute("SELECT * FROM plans")


@pytest.mark.parametrize(
    ("fail", "words"),
    [
        (full, "no room left"),
        (held, "another program holds"),
        (read_only, "rights"),
        (nowhere, "cannot be opened"),
        (garbage, "is no database"),
    ],
)
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning", "ignore::ResourceWarning")
def test_what_sqlite_fails_of_is_told_in_words(tmp_path: Path, fail: object, words: str) -> None:
    """Each of SQLite's own errors names what is wrong and what to do."""
    path = tmp_path / "plans.db"
    sqlite3.connect(path).execute("CREATE TABLE plans (number INTEGER)")
    assert callable(fail)
    with pytest.raises(sqlite3.Error) as failed:
        fail(path)
    assert words in str(storage_error(failed.value))


async def test_a_held_database_is_told_and_still_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """While another program writes, writes fail in words, reads go on; all is well then."""
    monkeypatch.setattr(databases, "BUSY_S", 1)
    database = Database(tmp_path / "plans.db")
    await database.open()
    holder = sqlite3.connect(database.path, isolation_level=None)
    try:
        holder.execute("BEGIN EXCLUSIVE")
        with pytest.raises(StorageError, match="another program holds"):
            async with database.writing() as session:
                await session.execute(text("DELETE FROM plans"))
        async with database.reading() as session:
            assert await session.scalar(text("SELECT count(*) FROM plans")) == 0
        assert not await database.answers()
        holder.execute("ROLLBACK")
        assert await database.answers()
        async with database.writing() as session:
            await session.execute(text("DELETE FROM plans"))
    finally:
        holder.close()
        await database.close()


def test_a_probe_leaves_nothing_behind(tmp_path: Path) -> None:
    """Neither a table nor a larger file."""
    path = tmp_path / "plans.db"
    connection = sqlite3.connect(path)
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("CREATE TABLE plans (number INTEGER)")
    connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    size = path.stat().st_size
    for _ in range(3):
        probe(path, 1 << 20)
    names = [name for (name,) in connection.execute("SELECT name FROM sqlite_schema")]
    connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    connection.close()
    assert names == ["plans"]
    assert path.stat().st_size == size


async def test_a_folder_that_cannot_be_made_is_told(tmp_path: Path) -> None:
    """A service whose database has no place to be does not start, and says why."""
    (tmp_path / "file").touch()
    with pytest.raises(StorageError, match="cannot be written"):
        await Database(tmp_path / "file" / "plans.db").open()
