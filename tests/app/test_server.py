"""The listening socket."""

from __future__ import annotations

import socket

import uvicorn

from app.server import listen


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
