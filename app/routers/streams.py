"""Server-sent events that end in good order when the service does."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator, AsyncIterator

import anyio
from sse_starlette import EventSourceResponse, ServerSentEvent

PING_S = 15
#: Streams get this long to end by themselves once the service is told to stop.
GRACE_S = 2.0


def event_stream(events: AsyncGenerator[ServerSentEvent, None]) -> EventSourceResponse:
    """An answer made of events, to their end, the listener's or the service's."""
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
        for task in (coming, stopping):
            if task is not None:
                task.cancel()
                await asyncio.gather(task, return_exceptions=True)
        await events.aclose()


async def _next(events: AsyncGenerator[ServerSentEvent, None]) -> ServerSentEvent | None:
    return await anext(events, None)
