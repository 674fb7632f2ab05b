"""Whether whoever asked still waits for the answer."""

from __future__ import annotations

import asyncio
from contextvars import ContextVar

#: Set once the client of the request at work is gone; None where there is no such client.
LEFT: ContextVar[asyncio.Event | None] = ContextVar("left", default=None)
