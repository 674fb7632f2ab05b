"""Answers of a kind: events that end when the service does, files that may still grow, reports."""

from __future__ import annotations

import asyncio
import os
from collections.abc import AsyncGenerator, AsyncIterator, Iterator
from pathlib import Path

import anyio
from fastapi.responses import HTMLResponse, StreamingResponse
from sse_starlette import EventSourceResponse, ServerSentEvent

PING_S = 15
#: Streams get this long to end by themselves once the service is told to stop.
GRACE_S = 2.0
CHUNK_BYTES = 1 << 16


def file_stream(path: Path, media_type: str) -> StreamingResponse:
    """A file as long as it is now, to be saved under its name; what is added meanwhile is left out."""
    file = path.open("rb")
    size = os.fstat(file.fileno()).st_size

    def chunks() -> Iterator[bytes]:
        with file:
            left = size
            while left and (chunk := file.read(min(left, CHUNK_BYTES))):
                left -= len(chunk)
                yield chunk

    headers = {"Content-Length": str(size), "Content-Disposition": f'attachment; filename="{path.name}"'}
    return StreamingResponse(chunks(), media_type=media_type, headers=headers)


def page_answer(page: str) -> HTMLResponse:
    """A report, in which nothing runs and which fetches nothing."""
    policy = "default-src 'none'; style-src 'unsafe-inline'; frame-ancestors 'self'"
    return HTMLResponse(page, headers={"Content-Security-Policy": policy, "X-Frame-Options": "SAMEORIGIN"})


def event_stream(events: AsyncGenerator[ServerSentEvent, None]) -> EventSourceResponse:
    """An answer made of events, to their end, the listener's or the service's.

    The generator is closed with the answer; one that takes from another has to close that one itself.
    """
    stop = anyio.Event()
    return EventSourceResponse(
        _until(events, stop), ping=PING_S, shutdown_event=stop, shutdown_grace_period=GRACE_S
    )


async def _until(
    events: AsyncGenerator[ServerSentEvent, None], stop: anyio.Event
) -> AsyncIterator[ServerSentEvent]:
    stopping = asyncio.create_task(stop.wait())
    coming: asyncio.Task[ServerSentEvent | None] | None = None
    try:
        while True:
            coming = asyncio.create_task(_next(events))
            await asyncio.wait((coming, stopping), return_when=asyncio.FIRST_COMPLETED)
            if not coming.done() or (event := coming.result()) is None:
                return
            yield event
    finally:
        tasks = [task for task in (coming, stopping) if task is not None]
        for task in tasks:
            task.cancel()
        # The scope this is cancelled with would cut every wait short, and leave a task pending.
        with anyio.CancelScope(shield=True):
            await asyncio.gather(*tasks, return_exceptions=True)
            await events.aclose()


async def _next(events: AsyncGenerator[ServerSentEvent, None]) -> ServerSentEvent | None:
    return await anext(events, None)
