"""The door between clients and two processes, each a small server on a socket of its own."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import tempfile
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path

import httpx
import pytest
import uvicorn
from fastapi import FastAPI, Request
from fastapi.responses import PlainTextResponse, Response, StreamingResponse

from app.door.crowd import most_connections
from app.door.door import Door, Patience
from app.door.lanes import CHANGES, OTHERS, READS
from app.door.quiet import Quiet
from app.serving import private_socket
from tests.patience import PATIENCE_S

USUAL = Patience()
#: For tests of a client that is slow.
HASTY = Patience(idle_s=5.0, head_s=0.2, body_s=0.2, answer_s=5.0)


def application(name: str) -> FastAPI:
    """Tells its name, and what it was sent."""
    app = FastAPI()
    app.state.open = 0
    app.state.most = 0

    @app.get("/slow")
    @app.get("/api/v1/vehicles")
    async def slow(request: Request) -> PlainTextResponse:
        app.state.open += 1
        app.state.most = max(app.state.most, app.state.open)
        await asyncio.sleep(0.02)
        app.state.open -= 1
        return PlainTextResponse(name)

    @app.get("/api/v1/vehicles/1/telemetry")
    async def telemetry() -> StreamingResponse:
        async def lines() -> AsyncIterator[str]:
            app.state.open += 1
            try:
                while True:
                    yield "state\n"
                    await asyncio.sleep(0.01)
            finally:
                app.state.open -= 1

        return StreamingResponse(lines())

    @app.api_route("/{path:path}", methods=["GET", "POST", "HEAD", "DELETE"])
    async def echo(request: Request) -> Response:
        body = await request.body()
        if request.method == "DELETE":
            return Response(status_code=204)
        return PlainTextResponse(f"{name} {request.method} {request.url.path} {len(body)} {sum(body)}")

    return app


@asynccontextmanager
async def standing(app: FastAPI, path: Path) -> AsyncIterator[None]:
    """A server on a private socket."""
    server = uvicorn.Server(uvicorn.Config(app, log_config=None, access_log=False, lifespan="off"))
    server.capture_signals = contextlib.nullcontext  # type: ignore[method-assign,assignment]
    serving = asyncio.create_task(server.serve([private_socket(path)]))
    try:
        async with asyncio.timeout(PATIENCE_S):
            while not server.started:
                await asyncio.sleep(0.01)
        yield
    finally:
        server.should_exit = server.force_exit = True
        await serving


@asynccontextmanager
async def opened(web: Path, links: Path, patience: Patience = USUAL) -> AsyncIterator[int]:
    """The port of a door."""
    server = await asyncio.start_server(Door(str(web), str(links), patience).serve, "127.0.0.1", 0)
    try:
        yield server.sockets[0].getsockname()[1]
    finally:
        server.close()


@pytest.fixture
def folder() -> Iterator[Path]:
    """A folder whose path is short enough for sockets."""
    with tempfile.TemporaryDirectory(prefix="door") as name:
        yield Path(name)


@asynccontextmanager
async def house(folder: Path) -> AsyncIterator[tuple[httpx.AsyncClient, FastAPI, FastAPI, int]]:
    """A client of a door, both applications behind it, and its port."""
    web, links = application("web"), application("links")
    async with (
        standing(web, folder / "web"),
        standing(links, folder / "links"),
        opened(folder / "web", folder / "links") as port,
        httpx.AsyncClient(base_url=f"http://127.0.0.1:{port}", timeout=PATIENCE_S) as client,
    ):
        yield client, web, links, port


async def test_each_request_goes_where_it_belongs(folder: Path) -> None:
    """Vehicles to one process, all else to the other, over one connection that is kept."""
    async with house(folder) as (client, *_):
        for path, name in (
            ("/api/v1/vehicles/1", "links"),
            ("/api/v1/vehicles/1/commands", "links"),
            ("/api/v1/vehiclesandmore", "web"),
            ("/links/end", "web"),
            ("/", "web"),
        ):
            body = bytes(range(256)) * 1000
            answer = await client.post(path, content=body)
            assert answer.text == f"{name} POST {path} {len(body)} {sum(body)}"
            assert answer.headers.get("connection") != "close"
        assert (await client.head("/x")).headers["content-length"]
        assert (await client.delete("/x")).status_code == 204
        assert (await client.get("/api/v1/vehicles")).text == "links"


async def test_bodies_in_chunks_and_ends_of_connections(folder: Path) -> None:
    """A body without a length passes; so does one of HTTP/1.0; both end their connection."""

    async def chunks() -> AsyncIterator[bytes]:
        for _ in range(10):
            yield b"\1" * 1000

    async with house(folder) as (client, _, _, port):
        answer = await client.post("/x", content=chunks())
        assert answer.text == "web POST /x 10000 10000"
        assert answer.headers["connection"] == "close"
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(b"GET /old HTTP/1.0\r\nHost: localhost\r\n\r\n")
        assert (await reader.read()).endswith(b"web GET /old 0 0")
        writer.close()


async def test_a_chunk_that_holds_what_ends_a_body_does_not_end_it(folder: Path) -> None:
    """A piece of a body that ends like the last chunk is passed on with what comes after it."""
    async with house(folder) as (_, _, _, port):
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(
            b"POST /x HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n5\r\n0\r\n\r\n"
        )
        await asyncio.sleep(0.1)  # so that the rest comes by itself
        writer.write(b"\r\n3\r\n\1\1\1\r\n0\r\n\r\n")
        expected = f"web POST /x 8 {sum(b'0') + 2 * (13 + 10) + 3}"
        async with asyncio.timeout(PATIENCE_S):
            assert (await reader.read()).endswith(expected.encode())
        writer.close()


async def test_requests_may_follow_each_other_unasked(folder: Path) -> None:
    """Two requests in one write are answered in turn (RFC 9112, 9.3.2)."""
    async with house(folder) as (_, _, _, port):
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        one = b"POST /%d HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\n\1\1"
        writer.write(one % 1 + one % 2)
        for number in (b"1", b"2"):
            await reader.readuntil(b"\r\n\r\n")
            expected = b"web POST /" + number + b" 2 2"
            assert await reader.readexactly(len(expected)) == expected
        writer.close()


async def test_a_client_that_leaves_ends_what_it_asked_for(folder: Path) -> None:
    """A stream behind the door stops once nobody reads it."""
    async with house(folder) as (client, _, links, _):
        async with client.stream("GET", "/api/v1/vehicles/1/telemetry") as stream:
            lines = stream.aiter_lines()
            assert [await anext(lines) for _ in range(3)] == ["state"] * 3
            assert links.state.open == 1
        async with asyncio.timeout(PATIENCE_S):
            while links.state.open:
                await asyncio.sleep(0.01)


async def test_reads_of_vehicles_take_turns(folder: Path) -> None:
    """However many ask, a few are answered at a time: what holds the links has time for them."""
    async with house(folder) as (client, web, links, _):
        await asyncio.gather(*(client.get("/api/v1/vehicles") for _ in range(12)))
        await asyncio.gather(*(client.get("/slow") for _ in range(12)))
        assert links.state.most <= READS.most < CHANGES.most < OTHERS.most
        assert web.state.most > READS.most


async def test_who_is_not_there_is_told(folder: Path) -> None:
    """Problem documents with 503: nobody at the socket, or one that goes in the middle of an answer."""

    async def dying(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.readuntil(b"\r\n\r\n")
        writer.close()

    async with (
        opened(folder / "web", folder / "links") as port,
        httpx.AsyncClient(base_url=f"http://127.0.0.1:{port}") as client,
    ):
        for path, words in (("/api/v1/vehicles", "links to the vehicles"), ("/", "service is starting")):
            answer = await client.get(path)
            assert (answer.status_code, answer.headers["retry-after"]) == (503, "2")
            assert answer.headers["content-type"] == "application/problem+json"
            assert (answer.json()["instance"], answer.json()["status"]) == (path, 503)
            assert words in answer.json()["detail"]
        server = await asyncio.start_unix_server(dying, folder / "web")
        assert (await client.post("/", content=b"x")).json()["title"] == "Ended meanwhile"
        server.close()


async def test_an_answer_cut_short_is_not_taken_for_a_whole_one(folder: Path) -> None:
    """The client's connection breaks where that of the process behind broke."""

    async def half(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.readuntil(b"\r\n\r\n")
        writer.write(b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n")
        await writer.drain()
        writer.close()

    server = await asyncio.start_unix_server(half, folder / "web")
    async with (
        opened(folder / "web", folder / "links") as port,
        httpx.AsyncClient(base_url=f"http://127.0.0.1:{port}") as client,
    ):
        with pytest.raises(httpx.TransportError):
            await client.get("/")
    server.close()


@pytest.mark.parametrize(
    ("spoken", "answered"),
    [
        (b"GET / HTTP/1.1\r\nHost: local", b"HTTP/1.1 408 "),
        (b"GET / HTTP/1.1\r\nX: " + b"x" * 70_000, b"HTTP/1.1 400 "),
        (b"\x16\x03\x01\r\n\r\n", b"HTTP/1.1 400 "),
        (b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\nhalf", b""),
    ],
)
async def test_slow_and_wrong_clients_are_not_waited_for(
    folder: Path, spoken: bytes, answered: bytes
) -> None:
    """Unfinished heads, endless ones, what is no HTTP, unfinished bodies: the connection ends."""
    async with (
        standing(application("web"), folder / "web"),
        opened(folder / "web", folder / "links", HASTY) as port,
    ):
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(spoken)
        with contextlib.suppress(ConnectionResetError):
            async with asyncio.timeout(PATIENCE_S):
                assert (await reader.read()).startswith(answered)
        writer.close()


async def test_idle_connections_make_room(folder: Path) -> None:
    """However many connections are left idle or half said, who asks something is answered at once."""
    async with standing(application("web"), folder / "web"):
        door = Door(str(folder / "web"), str(folder / "links"), most=8)
        server = await asyncio.start_server(door.serve, "127.0.0.1", 0)
        port = server.sockets[0].getsockname()[1]
        left: list[asyncio.StreamWriter] = []
        head = b"POST /api/v1/vehicles/1/commands HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\n"
        for said in (b"", b"GET / HTT", head + b"half") * 10:
            _, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(said)
            await writer.drain()
            left.append(writer)
        async with httpx.AsyncClient(base_url=f"http://127.0.0.1:{port}", timeout=PATIENCE_S) as client:
            for _ in range(3):
                assert (await client.post("/", content=b"ab")).text == "web POST / 2 195"
        assert door.crowd.open <= 8
        for writer in left:
            writer.close()
        server.close()
        async with asyncio.timeout(PATIENCE_S):
            while door.crowd.open:
                await asyncio.sleep(0.01)


async def test_a_body_that_drips_ends(folder: Path) -> None:
    """Sent without a pause but for ever, a large body is not waited for longer than its speed allows."""
    patience = Patience(body_s=0.5, body_bytes_s=1000.0)
    async with (
        standing(application("web"), folder / "web"),
        opened(folder / "web", folder / "links", patience) as port,
    ):
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000\r\n\r\n")
        ended = asyncio.create_task(reader.read())
        async with asyncio.timeout(PATIENCE_S):
            while not ended.done():
                with contextlib.suppress(ConnectionError):
                    writer.write(b"x")
                    await writer.drain()
                await asyncio.sleep(0.05)
        with contextlib.suppress(ConnectionResetError):
            assert ended.result() == b""
        writer.close()


async def test_a_body_in_chunks_may_have_a_slow_answer(folder: Path) -> None:
    """Once its last chunk has come the client is waited for no more."""
    patience = Patience(body_s=0.2)

    async def slow(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.readuntil(b"0\r\n\r\n")
        await asyncio.sleep(0.5)
        writer.write(b"HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\nok")
        with contextlib.suppress(ConnectionError):
            writer.close()
            await writer.wait_closed()
        gone.set()

    gone = asyncio.Event()
    server = await asyncio.start_unix_server(slow, folder / "web")

    async def chunks() -> AsyncIterator[bytes]:
        yield b"a"
        yield b"b"

    door = Door(str(folder / "web"), str(folder / "links"), patience)
    before = await asyncio.start_server(door.serve, "127.0.0.1", 0)
    port = before.sockets[0].getsockname()[1]
    async with httpx.AsyncClient(base_url=f"http://127.0.0.1:{port}") as client:
        assert (await client.post("/", content=chunks())).text == "ok"
        await gone.wait()
    async with asyncio.timeout(PATIENCE_S):
        while door.crowd.open:
            await asyncio.sleep(0.01)
    before.close()
    server.close()


@pytest.mark.parametrize(("descriptors", "most"), [(1024, 480), (256, 96), (65_536, 600), (20, 8)])
def test_no_more_connections_than_there_are_descriptors_for(descriptors: int, most: int) -> None:
    """Each takes two, and some are for other things."""
    assert most_connections(600, descriptors) == most


def test_missing_descriptors_are_told_once(caplog: pytest.LogCaptureFixture) -> None:
    """However often accepting fails; other exceptions go where they went."""
    quiet, loop = Quiet(), asyncio.new_event_loop()
    for _ in range(100):
        quiet(loop, {"message": "accept", "exception": OSError(errno.EMFILE, "Too many open files")})
    assert len(caplog.records) == 1
    quiet(loop, {"message": "another matter", "exception": ValueError("x")})
    assert len(caplog.records) == 2
    loop.close()
