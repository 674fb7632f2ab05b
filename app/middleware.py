"""What stands round every request: its id and log line, the guard at the door, the cap on bodies.

Plain ASGI, since a streaming answer must pass through untouched.
"""

from __future__ import annotations

import asyncio
import contextlib
import re
import time
import uuid
from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from typing import Final
from urllib.parse import SplitResult, urlsplit

import structlog
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.hosts import is_loopback
from app.problems import MEDIA_TYPE, problem_body
from app.services.metrics import REQUEST_SECONDS, REQUESTS
from app.services.presence import LEFT

log = structlog.get_logger("app.access")

REQUEST_ID = re.compile(r"[A-Za-z0-9._-]{1,64}")
#: Of each answer that says nothing else: it is no page, so a browser shows nothing of it, runs nothing, and
#: shows it in no other page.
SAFE_HEADERS: Final = {
    "content-security-policy": "default-src 'none'; frame-ancestors 'none'",
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
}
#: A body where none is read is not kept.
_HELD_MESSAGES: Final = 4
#: Any other word may be sent as a method; figures are not kept for each.
_METHODS: Final = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
#: A body over the cap is read to its end, and dropped, up to this many times the cap: a client that is
#: still sending does not look for an answer.
DRAIN_FACTOR = 20
#: Bodies over the common cap that are held at once; more are told to come again, after so long.
MOST_LARGE, RETRY_AFTER_S = 3, 5


async def _answer(
    scope: Scope,
    send: Send,
    status: int,
    kind: str,
    title: str,
    detail: str,
    entries: list[dict[str, str]],
    retry_after_s: int | None = None,
) -> None:
    body = problem_body(scope["path"], status, kind, title, detail, list(entries))
    headers = [
        (b"content-type", MEDIA_TYPE.encode()),
        (b"content-length", str(len(body)).encode()),
    ]
    if retry_after_s is not None:
        headers.append((b"retry-after", str(retry_after_s).encode()))
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})


class RequestLog:
    """Gives each request an id, logs it, counts it, and turns what nobody caught into a bare 500."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        given = Headers(scope=scope).get("x-request-id", "")
        request_id = given if REQUEST_ID.fullmatch(given) else uuid.uuid4().hex
        structlog.contextvars.clear_contextvars()
        structlog.contextvars.bind_contextvars(request_id=request_id)
        status = 0
        started_s = time.perf_counter()

        async def send_with_id(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                headers = MutableHeaders(scope=message)
                headers["x-request-id"] = request_id
                for name, value in SAFE_HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        try:
            await self._app(scope, receive, send_with_id)
        except asyncio.CancelledError:
            # The server gives up what is not answered when it ends; left to it, that is a bare 500.
            if status:
                raise
            detail = "the service ends; nobody can tell whether this was carried out"
            await _answer(scope, send_with_id, 503, "ending", "The service ends", detail, [])
        except Exception as error:
            log.error("request failed", path=scope["path"], exc_info=error)
            if status:
                raise
            detail = f"the service failed; its log tells more under request id {request_id}"
            await _answer(scope, send_with_id, 500, "internal", "Internal error", detail, [])
        finally:
            took_s = time.perf_counter() - started_s
            route = getattr(scope.get("route"), "path", "unmatched")
            method = scope["method"] if scope["method"] in _METHODS else "other"
            REQUESTS.labels(method=method, route=route, status=str(status)).inc()
            REQUEST_SECONDS.labels(route=route).observe(took_s)
            level = "debug" if route.startswith(("/health", "/metrics", "/links")) else "info"
            getattr(log, level)(
                "request", method=scope["method"], path=scope["path"], status=status, took_s=round(took_s, 4)
            )


class Guard:
    """Refuses what another web page makes a browser send here.

    The service knows no users, so any page open in the operator's browser could otherwise command vehicles:
    by name rebinding (hence the check of Host) or by a plain cross-site form (hence that of Origin). Pages of
    other services of this machine are other pages too: our own come from the name and port they speak to.
    """

    def __init__(self, app: ASGIApp, allowed_hosts: Sequence[str], allowed_origins: Sequence[str]) -> None:
        self._app = app
        self._hosts = frozenset(name.lower() for name in allowed_hosts)
        self._origins = frozenset(allowed_origins)

    def _known_host(self, host: str) -> bool:
        parts = _parts("//" + host)
        name = None if parts is None else parts.hostname
        return name is not None and (is_loopback(name) or name in self._hosts)

    def _known_origin(self, origin: str, host: str) -> bool:
        parts = _parts(origin.lower())
        if parts is None or parts.scheme not in _WEB_PORTS:
            return False
        return origin.lower() in self._origins or _place(parts) == _place(_parts(f"{parts.scheme}://{host}"))

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if scope["type"] == "http":
            headers = Headers(scope=scope)
            host, origin = headers.get("host", ""), headers.get("origin")
            if not self._known_host(host):
                message = "the Host header names none of this service's hosts"
                fix = "address the service by its own name, or list the name in SWATHPLAN_ALLOWED_HOSTS"
                entry = {"feature": "host", "rule": "host-unknown", "message": message, "fix": fix}
                await _answer(
                    scope, send, 421, "misdirected-request", "Refused at the door", message, [entry]
                )
                return
            if origin is not None and not self._known_origin(origin, host):
                message = f"a page of {origin[:200]} made this request, not one of the service itself"
                fix = "open the service's own map, or list the page's origin in SWATHPLAN_ALLOWED_ORIGINS"
                entry = {"feature": "origin", "rule": "origin-unknown", "message": message, "fix": fix}
                await _answer(scope, send, 403, "forbidden", "Refused at the door", message, [entry])
                return
        await self._app(scope, receive, send)


#: Ports that addresses leave out.
_WEB_PORTS: Final = {"http": 80, "https": 443}


def _parts(url: str) -> SplitResult | None:
    try:
        parts = urlsplit(url)
        _ = parts.hostname, parts.port
    except ValueError:
        return None
    return parts


def _place(parts: SplitResult | None) -> tuple[str | None, int | None] | None:
    """Name and port of an address."""
    return parts and (parts.hostname, parts.port or _WEB_PORTS[parts.scheme])


class BodyCap:
    """Reads each body up to a cap before the application sees it; more is a 422.

    ``larger``: caps of their own of some paths, with ``*`` for a part of one. Of the bodies that are over the
    common cap there are few at once, since each is held whole; one more is a 429.
    """

    def __init__(self, app: ASGIApp, max_bytes: int, larger: Mapping[str, int] | None = None) -> None:
        self._app = app
        self._max_bytes = max_bytes
        self._larger = larger or {}
        self._held = 0

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if scope["type"] != "http" or scope["method"] in ("GET", "HEAD", "OPTIONS"):
            await _answered(self._app, scope, receive, send)
            return
        with contextlib.ExitStack() as holding:
            await self._serve(scope, receive, send, holding)

    async def _serve(self, scope: Scope, receive: Receive, send: Send, holding: contextlib.ExitStack) -> None:
        path = scope["path"]
        larger = [most for pattern, most in self._larger.items() if fnmatchcase(path, pattern)]
        max_bytes = max(larger, default=self._max_bytes)
        chunks: list[bytes] = []
        size = 0
        more, is_held, has_room = True, False, True
        while more and size <= max_bytes * DRAIN_FACTOR:
            message = await receive()
            if message["type"] == "http.disconnect":
                return
            chunk = message.get("body", b"")
            size += len(chunk)
            if size > self._max_bytes and not is_held:
                is_held, has_room = True, self._held < MOST_LARGE
                if has_room:
                    holding.enter_context(self._one_more())
                else:
                    chunks.clear()
            if size <= max_bytes and has_room:
                chunks.append(chunk)
            more = message.get("more_body", False)
        if size > max_bytes:
            detail = f"the body is larger than {max_bytes} bytes"
            fix = "send less: fewer vertices, fewer decimals, or several scenarios; cut a raster to the area"
            entry = {"feature": "body", "rule": "body-too-large", "message": detail, "fix": fix}
            await _answer(scope, send, 422, "refused", "The input is refused", detail, [entry])
            return
        if not has_room:
            detail = f"{MOST_LARGE} large files are being taken in already; send them one after the other"
            entry = {"feature": "body", "rule": "large-bodies", "message": detail, "fix": "send it again"}
            title = "No room for more work now"
            await _answer(scope, send, 429, "overloaded", title, detail, [entry], RETRY_AFTER_S)
            return
        body: bytes | None = b"".join(chunks)
        chunks.clear()

        async def replay() -> Message:
            nonlocal body
            if body is not None:
                whole, body = body, None
                return {"type": "http.request", "body": whole, "more_body": False}
            return await receive()

        await _answered(self._app, scope, replay, send)

    @contextlib.contextmanager
    def _one_more(self) -> Iterator[None]:
        self._held += 1
        try:
            yield
        finally:
            self._held -= 1


async def _answered(app: ASGIApp, scope: Scope, receive: Receive, send: Send) -> None:
    """Have a request answered; that its client goes meanwhile is noted, for what is computed to end."""
    if scope["type"] != "http":
        await app(scope, receive, send)
        return
    messages: asyncio.Queue[Message] = asyncio.Queue()
    left = asyncio.Event()

    async def watch() -> None:
        while not left.is_set():
            message = await receive()
            if message["type"] == "http.disconnect":
                left.set()
            elif messages.qsize() < _HELD_MESSAGES:
                messages.put_nowait(message)

    async def told() -> Message:
        hearing, leaving = asyncio.create_task(messages.get()), asyncio.create_task(left.wait())
        try:
            await asyncio.wait((hearing, leaving), return_when=asyncio.FIRST_COMPLETED)
            return hearing.result() if hearing.done() else {"type": "http.disconnect"}
        finally:
            hearing.cancel()
            leaving.cancel()

    token = LEFT.set(left)
    watching = asyncio.create_task(watch())
    try:
        await app(scope, told, send)
    finally:
        LEFT.reset(token)
        watching.cancel()
        await asyncio.gather(watching, return_exceptions=True)
