"""A recording as a link: frames come as they came then, and what is sent goes nowhere."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Final
from urllib.parse import parse_qsl

from mavlink.errors import AddressError, LinkError
from mavlink.links.recording import read_tlog
from mavlink.wire.codec import Codec

#: Longer silences of a recording are cut short to this.
_LONGEST_SILENCE_S: Final = 10.0
#: Frames due within this time of each other come together.
_TOGETHER_S: Final = 0.02
_MOST_BYTES: Final = 1 << 14
#: Frames that come together lie within this of each other in the recording, so that its clock is known.
_TOGETHER_THEN_S: Final = 0.2
#: A file none of whose first frames is whole is no recording.
_LOOKED_AT: Final = 200


class ReplayLink:
    """Plays a .tlog once.

    Parameters
    ----------
    speedup
        Seconds of the recording in a second.
    """

    def __init__(self, url: str, path: Path, speedup: float = 1.0) -> None:
        self._url = url
        self._speedup = speedup
        self._records: Iterator[tuple[float, bytes]] = read_tlog(path)
        self._closed = asyncio.Event()
        self._next: tuple[float, bytes] | None = None
        self._last_s: float | None = None
        self._due_s = 0.0
        self._clock_s: float | None = None

    @property
    def clock_s(self) -> float | None:
        """When what was received last was recorded, in seconds since 1970; None before anything was."""
        return self._clock_s

    @property
    def url(self) -> str:
        """The address as given."""
        return self._url

    async def send(self, data: bytes) -> None:
        """Nobody hears."""

    async def receive(self) -> bytes:
        """Wait for what was heard next. Raises LinkError at the end of the recording, and once closed."""
        loop = asyncio.get_running_loop()
        if self._last_s is None:
            self._due_s = loop.time()
        if not self._advance():
            raise LinkError(f"{self._url}: the recording is over")
        delay_s = self._due_s - loop.time()
        if delay_s > 0.0:
            try:
                async with asyncio.timeout(delay_s):
                    await self._closed.wait()
            except TimeoutError:
                pass
        if self._closed.is_set():
            raise LinkError(f"{self._url} is closed")
        data = bytearray()
        horizon_s = loop.time() + _TOGETHER_S
        begun_s = self._last_s or 0.0
        while self._next is not None and self._due_s <= horizon_s and len(data) < _MOST_BYTES:
            if abs(self._next[0] - begun_s) > _TOGETHER_THEN_S:
                break
            self._clock_s, frame = self._next
            data += frame
            self._next = None
            self._advance()
        # Even at the highest speed others must have their turn.
        await asyncio.sleep(0)
        return bytes(data)

    async def close(self) -> None:
        """End the replay."""
        self._closed.set()

    def _advance(self) -> bool:
        """Make the next frame and its time ready; False at the end."""
        if self._next is None and not self._closed.is_set():
            self._next = next(self._records, None)
            if self._next is not None:
                at_s = self._next[0]
                silence_s = 0.0 if self._last_s is None else at_s - self._last_s
                self._due_s += min(max(silence_s, 0.0), _LONGEST_SILENCE_S) / self._speedup
                self._last_s = at_s
        return self._next is not None


def parse_replay(url: str) -> tuple[Path, dict[str, str]]:
    """Path and options of a ``replay:`` address. Raises AddressError for malformed ones."""
    path, _, query = url.removeprefix("replay:").partition("?")
    try:
        options = dict(parse_qsl(query, strict_parsing=True)) if query else {}
    except ValueError as error:
        raise AddressError(
            f"{url!r}: the options are not understood; write replay:path?speedup=10"
        ) from error
    if not path or "\0" in path:
        raise AddressError(f"{url!r} names no file; write replay:path?speedup=10")
    return Path(path), options


def _holds_messages(path: Path) -> bool:
    codec = Codec()
    return any(codec.feed(frame) for _, frame in islice(read_tlog(path), _LOOKED_AT))


def open_replay(url: str) -> ReplayLink:
    """Open the recording a ``replay:path?speedup=`` address names.

    Raises
    ------
    AddressError
        The address is malformed.
    LinkError
        The file is missing, unreadable or no recording.
    """
    path, options = parse_replay(url)
    try:
        speedup = float(options.pop("speedup", "1"))
    except ValueError:
        speedup = math.nan
    if not (math.isfinite(speedup) and speedup > 0.0):
        raise AddressError(f"{url!r}: the speed-up must be a number above 0")
    if options:
        raise AddressError(f"{url!r}: a replay has no option {', '.join(sorted(options))}")
    try:
        # Pipes and devices never end, or never begin.
        found = path.is_file() and _holds_messages(path)
    except OSError as error:
        raise LinkError(f"{url!r} cannot be opened: {error.strerror}") from error
    if not found:
        raise LinkError(f"{url!r}: there is no recording of that name")
    return ReplayLink(url, path, speedup)
