"""A database that cannot be used: why, in words, and whether it can be by now."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from typing import Final

from sqlalchemy.exc import DBAPIError

from app.services.errors import StorageError

#: Beginnings of SQLite's names of errors, with what they mean to whoever runs the service.
_REASONS: Final = (
    ("SQLITE_FULL", "there is no room left for the database: make room on its disk"),
    ("SQLITE_BUSY", "another program holds the database: end it, or let it finish"),
    ("SQLITE_LOCKED", "another program holds the database: end it, or let it finish"),
    ("SQLITE_READONLY", "the database may not be written: see to the rights of its file and folder"),
    ("SQLITE_CANTOPEN", "the database cannot be opened: see to its file, its folder and their rights"),
    ("SQLITE_IOERR", "the database's disk fails or is full: make room on it, or replace it"),
    ("SQLITE_CORRUPT", "the database is damaged: put back a copy of it"),
    ("SQLITE_NOTADB", "the database's file is no database: put back a copy of it"),
)
#: Written and taken back by a probe: so much at any time, and so much after a write has failed, for which
#: there may have been room for a little and not for a plan.
PROBE_BYTES, THOROUGH_BYTES = 1 << 16, 1 << 20
#: So long a probe waits for whoever holds the database, seconds.
PROBE_WAIT_S = 1.0


def storage_error(error: BaseException) -> StorageError:
    """What an error of the database means to a client."""
    original = error.orig if isinstance(error, DBAPIError) else error
    name = getattr(original, "sqlite_errorname", "")
    reason = next(
        (words for begin, words in _REASONS if name.startswith(begin)),
        "the database does not answer: the service's log tells more",
    )
    return StorageError(f"nothing can be kept now: {reason}")


def probe(path: Path, size_bytes: int) -> None:
    """Write to the database's own files and take it back; raises sqlite3.Error where that is not possible.

    A cache of a few pages has what is written go to the disk before it is taken back.
    """
    connection = sqlite3.connect(path, timeout=PROBE_WAIT_S, isolation_level=None)
    try:
        connection.execute("PRAGMA cache_size = 8")
        connection.execute("BEGIN IMMEDIATE")
        connection.execute("CREATE TABLE probe (filler BLOB)")
        connection.execute("INSERT INTO probe VALUES (zeroblob(?))", (size_bytes,))
        connection.execute("ROLLBACK")
    finally:
        connection.close()
