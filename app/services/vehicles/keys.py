"""Keys that vehicles sign with: read from a file or the environment, never kept, logged or answered.

What is kept is times alone: which of this side's own have been used, and which were heard last.
"""

from __future__ import annotations

import json
import os
import re
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import structlog

from app.services.errors import ConflictError, RefusedError
from mavlink.wire.signing import KeyFormatError, Signing, SigningKey, Stream, parse_key
from planner.errors import Finding

log = structlog.get_logger(__name__)

#: Environment variables with a key: for all vehicles, or behind an underscore for one, e.g. ``…_UAV_1``.
VARIABLE: Final = "SWATHPLAN_SIGNING_KEY"
#: In a file: the key of all vehicles that it does not name.
_ANY: Final = "*"
#: Numbers of links: the service's, and that of a command beside it, which has times of its own.
SERVICE_LINK, COMMAND_LINK = 0, 1


class KeyRing:
    """Where a vehicle's key is found: the file first, then the environment; by its name first, then for all.

    Parameters
    ----------
    file
        Lines ``name = key``, and ``* = key`` for all others; only its owner may read it.
    folder
        Where times are kept; None: nowhere.
    """

    def __init__(self, file: Path | None, folder: Path | None, environment: Mapping[str, str]) -> None:
        self._file = file
        self._folder = folder
        self._environment = environment

    def signing_of(self, name: str, vehicle_id: str, link_id: int = SERVICE_LINK) -> Signing | None:
        """What signs and verifies for a vehicle; None where no key of it is given.

        Raises
        ------
        RefusedError
            The file cannot be read, or others may read it; a key is none.
        """
        key = self.key_of(name)
        if key is None:
            return None
        memory = None if self._folder is None else KeptTimes(self._folder / f"{vehicle_id}.json")
        return Signing(key, time.time, link_id, memory)

    def key_of(self, name: str) -> SigningKey | None:
        """A vehicle's key; None where none is given. Raises RefusedError."""
        written = {} if self._file is None else _read(self._file)
        variable = f"{VARIABLE}_{re.sub('[^A-Z0-9]', '_', name.upper())}"
        for where, text in (
            (f"{self._file}, {name}", written.get(name)),
            (variable, self._environment.get(variable)),
            (f"{self._file}, {_ANY}", written.get(_ANY)),
            (VARIABLE, self._environment.get(VARIABLE)),
        ):
            if text:
                try:
                    return parse_key(text)
                except KeyFormatError as error:
                    raise _refused(f"{where}: {error}", "write 64 hexadecimal digits") from error
        return None

    def need(self, name: str, vehicle_id: str) -> Signing:
        """The same; raises ConflictError where no key is given."""
        found = self.signing_of(name, vehicle_id)
        if found is None:
            raise ConflictError(
                f"no signing key of {name} is given: write it to SWATHPLAN_SIGNING_KEYS or set {VARIABLE}"
            )
        return found


def _refused(message: str, fix: str) -> RefusedError:
    return RefusedError(message, (Finding("signing", "signing-key", message, fix),))


def _read(file: Path) -> dict[str, str]:
    """Names and keys of a file."""
    try:
        with file.open(encoding="utf-8") as lines:
            if os.name == "posix" and os.fstat(lines.fileno()).st_mode & 0o077:
                raise _refused(
                    f"others than its owner may read the signing keys in {file}", f"chmod 600 {file}"
                )
            found: dict[str, str] = {}
            for number, line in enumerate(lines, 1):
                text = line.strip()
                if not text or text.startswith("#"):
                    continue
                name, equals, key = text.partition("=")
                if not equals:
                    raise _refused(
                        f"{file}, line {number}: it is not `name = key`", "write e.g. uav-1 = 0123…"
                    )
                found[name.strip()] = key.strip()
            return found
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8"
        raise _refused(f"the signing keys in {file} cannot be read: {reason}", "name another file") from error


class KeptTimes:
    """The times of one vehicle's link in a file that only its owner reads."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self._failed = False

    def load(self) -> tuple[int, Mapping[Stream, int]]:
        """As kept; nothing where nothing is."""
        try:
            kept: dict[str, Any] = json.loads(self._file.read_text(encoding="ascii"))
            streams = {_stream(name): int(at) for name, at in kept["streams"].items()}
            return int(kept["timestamp"]), streams
        except FileNotFoundError:
            return 0, {}
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
            log.error("times of signatures lost", file=str(self._file), reason=str(error))
            return 0, {}

    def save(self, timestamp: int, streams: Mapping[Stream, int]) -> None:
        """Keep them; what cannot be written is said once, and this machine's clock has to do."""
        names = {"/".join(map(str, stream)): at for stream, at in streams.items()}
        part = self._file.with_suffix(".part")
        try:
            self._file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
            part.unlink(missing_ok=True)
            descriptor = os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with os.fdopen(descriptor, "w", encoding="ascii") as out:
                json.dump({"timestamp": timestamp, "streams": names}, out)
            part.replace(self._file)
            self._failed = False
        except OSError as error:
            if not self._failed:
                log.error("times of signatures not kept", file=str(self._file), reason=str(error))
            self._failed = True


def _stream(name: str) -> Stream:
    system_id, component_id, link_id = (int(part) for part in name.split("/"))
    return system_id, component_id, link_id
