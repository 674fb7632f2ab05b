"""The listening socket, clients that leave, the end."""

from __future__ import annotations

import asyncio
import contextlib
import socket
from collections.abc import AsyncIterator, MutableMapping
from contextlib import asynccontextmanager
from typing import Any

import httpx
import pytest
import uvicorn
from starlette.types import ASGIApp, Receive, Scope, Send

from app.middleware import MOST_LARGE, BodyCap, RequestLog
from app.server import listen
from app.services.presence import LEFT
from tests.app.test_problems import check_problem
from tests.patience import PATIENCE_S


async def _nothing(scope: object, receive: object, send: object) -> None:
    """An application that nobody asks."""


def test_what_is_accepted_sends_at_once() -> None:
    """Nagle's algorithm is off on every accepted connection, whatever the event loop does with it."""
    listener = listen(uvicorn.Config(_nothing, host="127.0.0.1", port=0))
    with listener:
        listener.listen()
        with socket.create_connection(listener.getsockname()) as client:
            accepted, _ = listener.accept()
            with accepted:
                assert accepted.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY) != 0
                assert client.getpeername() == listener.getsockname()


@asynccontextmanager
async def served(app: ASGIApp) -> AsyncIterator[tuple[uvicorn.Server, str]]:
    """A server that gives requests a moment when it ends, and its address."""
    config = uvicorn.Config(app, port=0, log_config=None, lifespan="off", timeout_graceful_shutdown=1)
    server = uvicorn.Server(config)
    server.capture_signals = contextlib.nullcontext  # type: ignore[method-assign,assignment]
    serving = asyncio.create_task(server.serve())
    try:
        async with asyncio.timeout(PATIENCE_S):
            while not server.started:
                await asyncio.sleep(0.01)
        yield server, f"http://127.0.0.1:{server.servers[0].sockets[0].getsockname()[1]}"
    finally:
        server.should_exit = True
        await serving


def around(app: ASGIApp) -> ASGIApp:
    """An application with what stands round every one of the service's."""
    return RequestLog(BodyCap(app, max_bytes=1_000_000))


async def test_a_slow_request_is_told_that_the_service_ends() -> None:
    """Whoever is not answered in time gets a problem document, not a bare 500."""
    at_work = asyncio.Event()

    async def slow(scope: Scope, receive: Receive, send: Send) -> None:
        at_work.set()
        await asyncio.sleep(60)

    async with served(around(slow)) as (server, address), httpx.AsyncClient(timeout=PATIENCE_S) as client:
        asking = asyncio.create_task(client.post(address, content=b"{}"))
        await at_work.wait()
        server.should_exit = True
        check_problem(await asking, 503)


@pytest.mark.parametrize("method", ["GET", "POST"])
async def test_that_the_client_has_left_is_known_to_what_works_for_it(method: str) -> None:
    """As soon as it goes, whether it sent a body or not; the answer to one that stays is whole."""
    at_work, told = asyncio.Event(), asyncio.Event()

    async def works(scope: Scope, receive: Receive, send: Send) -> None:
        left = LEFT.get()
        assert left is not None
        assert (await receive())["type"] == "http.request"
        if scope["path"] == "/stays":
            assert not left.is_set()
        else:
            at_work.set()
            await left.wait()
            assert (await receive())["type"] == "http.disconnect"
            told.set()
        await send({"type": "http.response.start", "status": 204, "headers": []})
        await send({"type": "http.response.body", "body": b""})

    async with served(around(works)) as (_, address):
        async with httpx.AsyncClient(timeout=PATIENCE_S) as client:
            assert (await client.request(method, address + "/stays")).status_code == 204
            asking = asyncio.create_task(client.request(method, address + "/goes"))
            await at_work.wait()
            asking.cancel()
            await asyncio.gather(asking, return_exceptions=True)
        async with asyncio.timeout(PATIENCE_S):
            await told.wait()


async def test_large_bodies_are_few_at_once() -> None:
    """While as many are held as may be, one more is told to come again; small ones pass."""
    taken: list[int] = []

    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        taken.append(len((await receive())["body"]))
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": b""})

    cap = BodyCap(app, max_bytes=100, larger={"/large": 10_000})
    finish = asyncio.Event()

    async def post(size: int, *, held: bool = False) -> dict[bytes, Any]:
        parts = [b"x" * size, b"y"]

        async def receive() -> dict[str, Any]:
            if len(parts) == 1 and held:
                await finish.wait()
            if not parts:
                await asyncio.sleep(3600)
            return {"type": "http.request", "body": parts.pop(0), "more_body": bool(parts)}

        answer: dict[bytes, Any] = {}

        async def send(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                answer.update([(b"status", message["status"]), *message["headers"]])

        await cap({"type": "http", "method": "POST", "path": "/large", "headers": []}, receive, send)
        return answer

    holding = [asyncio.create_task(post(200, held=True)) for _ in range(MOST_LARGE)]
    await asyncio.sleep(0)
    refused = await post(200)
    assert refused[b"status"] == 429
    assert int(refused[b"retry-after"]) > 0
    assert (await post(50))[b"status"] == 200
    finish.set()
    assert [(await task)[b"status"] for task in holding] == [200] * MOST_LARGE
    assert (await post(200))[b"status"] == 200
    assert taken == [51, *[201] * MOST_LARGE, 201]
