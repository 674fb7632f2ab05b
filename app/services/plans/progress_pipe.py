"""The service's end of the pipes through which planning processes report progress."""

from __future__ import annotations

import asyncio
import json
import os
import tempfile
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

Report = Callable[[str, float], None]

#: The longest line a worker writes is far shorter; what exceeds it is not a report.
MAX_LINE_BYTES = 4096


@asynccontextmanager
async def progress_pipe(report: Report) -> AsyncIterator[str]:
    """A named pipe whose lines are handed to ``report(stage, fraction)``; yields its path."""
    folder = tempfile.mkdtemp(prefix="swathplan-")
    path = Path(folder) / "progress"
    os.mkfifo(path, 0o600)
    # Opened for writing too, so that a worker hanging up is not the end of the stream.
    fd = os.open(path, os.O_RDWR | os.O_NONBLOCK)
    loop = asyncio.get_running_loop()
    rest = b""

    def drain() -> None:
        nonlocal rest
        try:
            chunk = os.read(fd, 65536)
        except BlockingIOError:
            return
        *lines, rest = (rest + chunk).split(b"\n")
        rest = rest[-MAX_LINE_BYTES:]
        for line in lines:
            message = json.loads(line)
            report(str(message["stage"]), float(message["progress"]))

    loop.add_reader(fd, drain)
    try:
        yield str(path)
    finally:
        drain()
        loop.remove_reader(fd)
        os.close(fd)
        path.unlink()
        Path(folder).rmdir()
