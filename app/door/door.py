"""Connections of clients, and behind each of their requests one to the process that answers it."""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
from dataclasses import dataclass
from typing import Final

from app.door.crowd import Crowd
from app.door.heads import END, MOST_BYTES, AnswerHead, BadHeadError, RequestHead, read_answer, read_request
from app.door.lanes import CrowdedError, Lanes, lane_of

log = logging.getLogger(__name__)

#: More connections than the first are served hurriedly, more than the second not at all.
HURRIED_CONNECTIONS: Final = 200
MOST_CONNECTIONS: Final = 600
_CHUNK_BYTES: Final = 1 << 16
#: A body up to this size is taken in whole before its request gets its turn: half of one holds up nobody.
_EARLY_BYTES: Final = 1 << 16
_LAST_CHUNK: Final = b"0\r\n\r\n"


@dataclass(frozen=True, slots=True)
class Patience:
    """How long a client may take for its next request, a head, a part of a body, of an answer.

    Parameters
    ----------
    hurried_s
        Stands for the first two where there are many clients.
    body_bytes_s
        A body may take ``body_s`` and, beyond that, as long as it does at this speed.
    """

    idle_s: float = 60.0
    head_s: float = 15.0
    hurried_s: float = 3.0
    body_s: float = 30.0
    answer_s: float = 60.0
    body_bytes_s: float = 10_000.0


class _Incoming:
    """What comes over a connection: heads, and what is behind them."""

    def __init__(self, reader: asyncio.StreamReader) -> None:
        self._reader = reader
        self.held = b""
        #: Bytes of the body under way that have not been passed on; None where nobody knows.
        self.left: int | None = 0

    async def more(self) -> bool:
        """Take in what comes next; False at the end."""
        chunk = await self._reader.read(_CHUNK_BYTES)
        self.held += chunk
        return bool(chunk)

    async def head(self) -> bytes | None:
        """The next head; None at the end. Raises BadHeadError for one that is too long."""
        self.held = self.held.lstrip(b"\r\n")
        while (end := END.search(self.held)) is None:
            if len(self.held) > MOST_BYTES:
                raise BadHeadError(f"the headers are longer than {MOST_BYTES} bytes")
            if not await self.more():
                return None
        head, self.held = self.held[: end.start()], self.held[end.end() :]
        return head

    async def hold(self, size: int) -> bool:
        """Take in so much; False when the end comes before."""
        while len(self.held) < size:
            if not await self.more():
                return False
        return True

    async def part(self, most: int) -> bytes:
        """Some bytes of a body; none at the end."""
        if not self.held and not await self.more():
            return b""
        part, self.held = self.held[:most], self.held[most:]
        return part


class Door:
    """Hands requests on.

    Parameters
    ----------
    web, links
        Paths of the sockets of the two processes.
    most
        So many connections are open at once.
    """

    def __init__(
        self, web: str, links: str, patience: Patience = Patience(), most: int = MOST_CONNECTIONS
    ) -> None:
        self._web = web
        self._links = links
        self._patience = patience
        self._lanes = Lanes()
        self.crowd = Crowd(most)

    async def serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Serve one client's connection to its end."""
        try:
            with self.crowd.connected() as room:
                client = _Incoming(reader)
                if not room:
                    detail = "too many connections are open; try again later"
                    await _refuse(writer, b"/", 503, "overloaded", "No room for more work now", detail)
                while room and await self._exchange(client, writer):
                    pass
        except (OSError, TimeoutError):
            pass  # the client is gone, or too slow to be waited for
        except asyncio.CancelledError:
            pass  # it gives way to another, or the door ends: the streams' own code would log either
        finally:
            writer.close()

    async def _exchange(self, client: _Incoming, writer: asyncio.StreamWriter) -> bool:
        """One request and its answer; whether the connection goes on."""
        hurried_s = self._patience.hurried_s if self.crowd.open > HURRIED_CONNECTIONS else None
        with self.crowd.waiting():
            async with asyncio.timeout(hurried_s or self._patience.idle_s):
                if not client.held and not await client.more():
                    return False
        try:
            with self.crowd.waiting():
                async with asyncio.timeout(hurried_s or self._patience.head_s):
                    head = await client.head()
                if head is None:
                    return False
                request = read_request(head)
                if request.length is not None and request.length <= _EARLY_BYTES and not request.expects:
                    async with asyncio.timeout(self._patience.body_s):
                        if not await client.hold(request.length):
                            return False
        except BadHeadError as error:
            await _refuse(writer, b"/", 400, "bad-request", "Bad Request", str(error))
            return False
        except TimeoutError:
            await _refuse(writer, b"/", 408, "request-timeout", "Request Timeout", "the request did not come")
            return False
        lane = lane_of(request)
        try:
            async with self._lanes.turn(lane):
                return await self._pass_on(request, client, writer, self._links if lane.links else self._web)
        except CrowdedError as error:
            detail = f"{error}; try again later"
            await _refuse(writer, request.path, 503, "overloaded", "No room for more work now", detail)
            return False

    async def _pass_on(
        self, request: RequestHead, client: _Incoming, writer: asyncio.StreamWriter, path: str
    ) -> bool:
        try:
            from_behind, to_behind = await asyncio.open_unix_connection(path)
        except OSError:
            await _refuse(
                writer, request.path, 503, "starting", "Not there now", _absence(path == self._links)
            )
            return False
        to_behind.write(request.passed_on())
        sending = asyncio.create_task(self._send_body(request, client, to_behind))
        answering = asyncio.create_task(self._answer(request, _Incoming(from_behind), writer))
        try:
            await asyncio.wait((sending, answering), return_when=asyncio.FIRST_COMPLETED)
            if not answering.done():
                sending.result()
                return False  # the client has gone, and nobody waits for the answer
            return answering.result() and client.left == 0
        finally:
            for task in (sending, answering):
                task.cancel()
            await asyncio.gather(sending, answering, return_exceptions=True)
            to_behind.transport.abort()

    async def _send_body(
        self, request: RequestHead, client: _Incoming, to_behind: asyncio.StreamWriter
    ) -> None:
        """Pass the body on, then wait until the client goes away."""
        client.left = request.length
        moment_s = asyncio.get_running_loop().time
        slowest_s, tail = moment_s() + self._patience.body_s, b""
        while (client.left is None and tail != _LAST_CHUNK) or (client.left is not None and client.left > 0):
            async with asyncio.timeout(min(self._patience.body_s, slowest_s - moment_s())):
                part = await client.part(_CHUNK_BYTES if client.left is None else client.left)
            if not part:
                return
            slowest_s += len(part) / self._patience.body_bytes_s
            tail = (tail + part)[-len(_LAST_CHUNK) :]
            client.left = None if client.left is None else client.left - len(part)
            await _hand_on(part, to_behind)
        # What looked like the last chunk may have been a piece of one; no time is measured from there on.
        while client.left is None and (part := await client.part(_CHUNK_BYTES)):
            await _hand_on(part, to_behind)
        while client.left is not None and len(client.held) < MOST_BYTES:
            if not await client.more():
                return
        if client.left is not None:
            await asyncio.Event().wait()

    async def _answer(self, request: RequestHead, behind: _Incoming, writer: asyncio.StreamWriter) -> bool:
        """Pass the answer on; whether the connection may go on."""
        while True:
            try:
                head = await behind.head()
                answer = None if head is None else read_answer(head)
            except (ConnectionError, BadHeadError):
                answer = None
            if answer is None:
                detail = "the process that was to answer has ended; nobody can tell what it has done"
                await _refuse(writer, request.path, 503, "ended", "Ended meanwhile", detail)
                return False
            if not answer.interim:
                break
            writer.write(answer.passed_on(keeps=True))
        bare = request.method == b"HEAD" or answer.status in (204, 304)
        ends = bare or answer.chunked or answer.length is not None
        keeps = request.keeps and ends
        writer.write(answer.passed_on(keeps=keeps))
        if not await self._answer_body(answer, behind, writer) and not bare:
            writer.transport.abort()  # cut short, which the client must not take for the whole
            return False
        return keeps

    async def _answer_body(self, answer: AnswerHead, behind: _Incoming, writer: asyncio.StreamWriter) -> bool:
        """Pass on all that comes; whether it was all there is."""
        size, tail = 0, b""
        while part := await behind.part(_CHUNK_BYTES):
            size += len(part)
            tail = (tail + part)[-5:]
            writer.write(part)
            async with asyncio.timeout(self._patience.answer_s):
                await writer.drain()
        async with asyncio.timeout(self._patience.answer_s):
            await writer.drain()
        return tail == _LAST_CHUNK if answer.chunked else answer.length in (None, size)


async def _hand_on(part: bytes, to_behind: asyncio.StreamWriter) -> None:
    # Who has answered already reads no more; the answer is on its way.
    with contextlib.suppress(ConnectionError):
        to_behind.write(part)
        await to_behind.drain()


def _absence(links: bool) -> str:
    if links:
        return "the process that holds the links to the vehicles is being started; try again in some seconds"
    return "the service is starting or ending; try again in some seconds"


async def _refuse(
    writer: asyncio.StreamWriter, path: bytes, status: int, kind: str, title: str, detail: str
) -> None:
    """Answer with a problem document (RFC 9457), the last of the connection."""
    problem = {
        "type": f"urn:problem-type:swathplan:{kind}",
        "title": title,
        "status": status,
        "detail": detail,
        "instance": path.decode(errors="replace"),
        "errors": [],
    }
    body = json.dumps(problem).encode()
    retry = "Retry-After: 2\r\n" if status == 503 else ""
    head = (
        f"HTTP/1.1 {status} {title}\r\nContent-Type: application/problem+json\r\n{retry}"
        f"Content-Length: {len(body)}\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n"
    )
    writer.write(head.encode() + body)
    async with asyncio.timeout(5.0):
        await writer.drain()
