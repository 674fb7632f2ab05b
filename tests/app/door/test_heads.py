"""Heads of HTTP messages, as the door reads and writes them; h11 is the authority."""

from __future__ import annotations

import h11
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.door.heads import BadHeadError, read_answer, read_request

TOKEN = st.text("abcdefghijklmnopqrstuvwxyz-", min_size=1, max_size=12).map(lambda text: "x-" + text)
VALUE = st.text(st.characters(min_codepoint=33, max_codepoint=126), max_size=20)
FIELDS = st.lists(st.tuples(TOKEN, VALUE), max_size=5)


def head_of(*lines: str) -> bytes:
    """A head without its empty line."""
    return "\r\n".join(lines).encode()


def parsed(raw: bytes) -> h11.Request:
    """What h11 reads."""
    connection = h11.Connection(h11.SERVER)
    connection.receive_data(raw)
    event = connection.next_event()
    assert isinstance(event, h11.Request)
    return event


@given(FIELDS, st.integers(0, 10**9), st.booleans())
def test_a_request_passed_on_says_the_same(fields: list[tuple[str, str]], length: int, keeps: bool) -> None:
    """h11 reads method, target and every field that is not of the connection as they were sent."""
    lines = ["POST /api/v1/plans?wait=3 HTTP/1.1", "Host: localhost", f"Content-Length: {length}"]
    lines += [f"{name}: {value}" for name, value in fields]
    lines += ["Connection: keep-alive" if keeps else "Connection: close", "Keep-Alive: timeout=5"]
    request = read_request(head_of(*lines))
    sent, passed = parsed(head_of(*lines) + b"\r\n\r\n"), parsed(request.passed_on())
    assert (request.path, request.length, request.keeps) == (b"/api/v1/plans", length, keeps)
    assert (passed.method, passed.target, passed.http_version) == (
        sent.method,
        sent.target,
        sent.http_version,
    )
    own = {b"connection", b"keep-alive"}
    assert [f for f in passed.headers if f[0] not in own] == [f for f in sent.headers if f[0] not in own]
    assert (b"connection", b"close") in passed.headers


@pytest.mark.parametrize(
    ("target", "path"),
    [
        (b"/api/v1/vehicles", b"/api/v1/vehicles"),
        (b"/api/v1/vehicles?x=/", b"/api/v1/vehicles"),
        (b"http://localhost:8000/api/v1/vehicles/1?x", b"/api/v1/vehicles/1"),
        (b"http://localhost", b"/"),
    ],
)
def test_the_path_is_what_stands_before_the_query(target: bytes, path: bytes) -> None:
    """In either form of a request's target (RFC 9112, 3.2)."""
    assert read_request(b"GET " + target + b" HTTP/1.1\r\nHost: localhost").path == path


@pytest.mark.parametrize(
    "lines",
    [
        ("GET / HTTP/2.0",),
        ("GET /",),
        ("GET  / HTTP/1.1",),
        ("POST / HTTP/1.1", "Content-Length: 3", "Transfer-Encoding: chunked"),
        ("POST / HTTP/1.1", "Content-Length: 3", "Content-Length: 4"),
        ("POST / HTTP/1.1", "Content-Length: -1"),
        ("POST / HTTP/1.1", "Content-Length: 3, 3"),
        ("POST / HTTP/1.1", "Transfer-Encoding: gzip, chunked"),
        ("POST / HTTP/1.1", "Transfer-Encoding : chunked"),
        ("GET / HTTP/1.1", "X-Long: a", " folded"),
        ("GET / HTTP/1.1", "no colon"),
        ("GET / HTTP/1.1", "X: a\rb"),
        ("GET / HTTP/1.1", "X: a\0b"),
    ],
)
def test_what_two_readers_could_read_differently_is_refused(lines: tuple[str, ...]) -> None:
    """Where a body ends, or a field begins, must be beyond doubt."""
    with pytest.raises(BadHeadError):
        read_request(head_of(*lines))


def test_answers_tell_how_their_bodies_end() -> None:
    """By length, in chunks, or with the connection; interim ones are told apart."""
    assert read_answer(b"HTTP/1.1 100 Continue").interim
    by_length = read_answer(b"HTTP/1.1 200 OK\r\ncontent-length: 5\r\nconnection: close")
    assert (by_length.length, by_length.chunked, by_length.interim) == (5, False, False)
    assert by_length.passed_on(keeps=True) == b"HTTP/1.1 200 OK\r\ncontent-length: 5\r\n\r\n"
    assert by_length.passed_on(keeps=False).endswith(b"connection: close\r\n\r\n")
    assert read_answer(b"HTTP/1.1 200 OK\r\ntransfer-encoding: chunked").chunked
    assert read_answer(b"HTTP/1.1 200 ").length is None
    with pytest.raises(BadHeadError):
        read_answer(b"SSH-2.0-x")
