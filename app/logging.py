"""Logs: one JSON object a line on standard error, with the request's id."""

from __future__ import annotations

import atexit
import logging
import queue
import sys
import threading
from typing import Final

import structlog
from structlog.types import Processor

#: So long the end of a process waits for its last lines.
_END_S: Final = 2.0


class _ThreadedHandler(logging.Handler):
    """Writes to standard error in a thread: who logs does not wait for the disk behind it."""

    def __init__(self) -> None:
        super().__init__()
        self._lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._serve, name="log", daemon=True)
        self._thread.start()
        atexit.register(self._end)

    def emit(self, record: logging.LogRecord) -> None:
        """Take one record."""
        try:
            self._lines.put(self.format(record) + "\n")
        except Exception:  # noqa: BLE001 - as the standard library's handlers do
            self.handleError(record)

    def _serve(self) -> None:
        while (line := self._lines.get()) is not None:
            sys.stderr.write(line)
            sys.stderr.flush()

    def _end(self) -> None:
        self._lines.put(None)
        self._thread.join(_END_S)


def configure(level: str, *, threaded: bool = False) -> None:
    """Send structlog's and the standard library's records through one JSON renderer.

    Parameters
    ----------
    threaded
        Whether they are written by a thread of their own.
    """
    shared: list[Processor] = [
        structlog.contextvars.merge_contextvars,
        structlog.stdlib.add_log_level,
        structlog.stdlib.add_logger_name,
        structlog.processors.TimeStamper(fmt="iso", utc=True),
        structlog.processors.format_exc_info,
    ]
    structlog.configure(
        processors=[*shared, structlog.stdlib.ProcessorFormatter.wrap_for_formatter],
        logger_factory=structlog.stdlib.LoggerFactory(),
        wrapper_class=structlog.stdlib.BoundLogger,
        cache_logger_on_first_use=True,
    )
    handler = _ThreadedHandler() if threaded else logging.StreamHandler(sys.stderr)
    handler.setFormatter(
        structlog.stdlib.ProcessorFormatter(
            foreign_pre_chain=shared,
            processors=[
                structlog.stdlib.ProcessorFormatter.remove_processors_meta,
                structlog.processors.JSONRenderer(),
            ],
        )
    )
    root = logging.getLogger()
    root.handlers = [handler]
    root.setLevel(level.upper())
    for noisy in ("uvicorn.access", "aiosqlite", "alembic", "sse_starlette", "httpx", "httpcore"):
        logging.getLogger(noisy).setLevel(logging.WARNING)
