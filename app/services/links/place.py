"""Where the process that holds a database's links is found: its lock, its socket, its log."""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

#: Longer paths cannot be bound on every system (sun_path of unix(7)).
_MOST_PATH_BYTES: Final = 100


class PlaceTakenError(RuntimeError):
    """Another process holds the links of the database."""


@dataclass(frozen=True, slots=True)
class Holder:
    """Who holds the links.

    Parameters
    ----------
    fingerprint
        Of its version and settings: another one is to be started anew.
    """

    pid: int
    version: str
    fingerprint: str


@dataclass(frozen=True, slots=True)
class Place:
    """Files of one database's processes.

    Parameters
    ----------
    lock
        Held locked (flock) by the process that holds the links, with its :class:`Holder` in it.
    links, web
        Sockets of the two processes, for this user alone.
    log
        What the process that holds the links logs.
    """

    lock: Path
    links: Path
    web: Path
    log: Path

    def holder(self) -> Holder | None:
        """Who holds the links now; None when nobody does."""
        try:
            descriptor = os.open(self.lock, os.O_RDONLY)
        except FileNotFoundError:
            return None
        try:
            fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            text = self.lock.read_text()
            return Holder(**json.loads(text)) if text else None
        finally:
            os.close(descriptor)
        return None


def place_of(database: Path) -> Place:
    """Where the processes of a database are found."""
    path = database.resolve()

    def beside(suffix: str) -> Path:
        return path.with_name(path.name + suffix)

    links, web = beside(".links.sock"), beside(".web.sock")
    if len(os.fsencode(links)) > _MOST_PATH_BYTES:
        folder = _private_folder()
        name = hashlib.sha256(os.fsencode(path)).hexdigest()[:24]
        links, web = folder / f"{name}.links.sock", folder / f"{name}.web.sock"
    return Place(beside(".links"), links, web, beside(".links.log"))


def _private_folder() -> Path:
    """A folder of this user's alone, for sockets whose path would be too long."""
    folder = Path(tempfile.gettempdir()) / f"swathplan-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    status = folder.lstat()
    if status.st_uid != os.getuid() or folder.is_symlink() or status.st_mode & 0o077:
        raise PermissionError(
            f"{folder} is open to others: remove it, or keep the database at a shorter path"
        )
    return folder


class Lock:
    """The place taken, until it is given up.

    Raises
    ------
    PlaceTakenError
        Somebody has it.
    """

    def __init__(self, place: Place, holder: Holder) -> None:
        self._path = place.lock
        self._descriptor = os.open(place.lock, os.O_RDWR | os.O_CREAT, 0o600)
        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            os.close(self._descriptor)
            raise PlaceTakenError(f"another process holds the links of {place.lock}") from error
        os.ftruncate(self._descriptor, 0)
        os.pwrite(self._descriptor, json.dumps(asdict(holder)).encode(), 0)

    @property
    def stands(self) -> bool:
        """Whether others still find it: its file is neither removed nor replaced."""
        try:
            found = self._path.stat()
        except OSError:
            return False
        mine = os.fstat(self._descriptor)
        return (found.st_dev, found.st_ino) == (mine.st_dev, mine.st_ino)

    def release(self) -> None:
        """Give the place up."""
        os.ftruncate(self._descriptor, 0)
        os.close(self._descriptor)
