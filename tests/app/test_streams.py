"""Event streams leave nothing behind, whichever side ends them."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator
from typing import Any

import pytest
from sse_starlette import ServerSentEvent

from app.routers.streams import event_stream
from tests.patience import PATIENCE_S

SCOPE = {"type": "http", "method": "GET", "path": "/", "headers": [], "asgi": {"version": "3.0"}}


class Source:
    """Events that may never come, and whether their generator was closed."""

    def __init__(self, *events: str, endless: bool) -> None:
        self.closed = False
        self._events = events
        self._endless = endless

    async def stream(self) -> AsyncGenerator[ServerSentEvent, None]:
        """The events, then silence."""
        try:
            for event in self._events:
                yield ServerSentEvent(event)
            while self._endless:
                await asyncio.sleep(3600)
        finally:
            # as a generator does that gives back what it listened with
            await asyncio.sleep(0)
            self.closed = True


async def listen(source: Source, *, leave: bool, cut: bool = False) -> list[dict[str, Any]]:
    """What a listener gets who leaves after the first event, or whose request is cut then."""
    got: list[dict[str, Any]] = []
    first = asyncio.Event()

    async def receive() -> dict[str, Any]:
        await (first.wait() if leave else asyncio.Event().wait())
        return {"type": "http.disconnect"}

    async def send(message: dict[str, Any]) -> None:
        got.append(message)
        if message["type"] == "http.response.body" and message.get("body"):
            first.set()

    answering = asyncio.create_task(event_stream(source.stream())(SCOPE, receive, send))
    if cut:
        await first.wait()
        answering.cancel()
    await asyncio.wait_for(asyncio.gather(answering, return_exceptions=True), PATIENCE_S)
    return got


@pytest.mark.parametrize(
    ("leave", "cut", "endless"),
    [(True, False, True), (False, True, True), (False, False, False)],
    ids=["the listener leaves", "the service cuts", "the events end"],
)
async def test_nothing_is_left_running(leave: bool, cut: bool, endless: bool) -> None:
    """After the end no task is pending and the events' generator has been closed."""
    before = asyncio.all_tasks()
    source = Source("one", "two", endless=endless)
    got = await listen(source, leave=leave, cut=cut)
    assert b"one" in b"".join(message.get("body", b"") for message in got)
    # sse-starlette keeps one task per loop that watches for the service's end.
    left = {task for task in asyncio.all_tasks() - before if "_shutdown_watcher" not in repr(task)}
    assert not left
    assert source.closed
