"""Vehicles that a test makes heard, and lets fall silent, from outside the service."""

from __future__ import annotations

import socket
import threading
import time
from types import TracebackType
from typing import Self

import httpx

from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message
from tests.app.browser.conftest import Service
from tests.patience import PATIENCE_S

PAUSE_S = 0.1


def vehicles_of(service: Service) -> dict[str, str]:
    """Where each vehicle of the service is, by name."""
    known = service.get("/api/v1/vehicles").json()["vehicles"]
    return {vehicle["name"]: f"{service.address}/api/v1/vehicles/{vehicle['id']}" for vehicle in known}


def free_port() -> int:
    """A UDP port that nobody holds."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Air:
    """A vehicle of the service, heard from the beginning until it falls silent; let go at the end."""

    def __init__(self, service: Service, name: str, system_id: int) -> None:
        self._port = free_port()
        self._codec = Codec(system_id, 1)
        there = {"name": name, "url": f"udpin:127.0.0.1:{self._port}", "timeout_s": 0.1}
        made = httpx.post(f"{service.address}/api/v1/vehicles", json=there, timeout=PATIENCE_S)
        assert made.status_code == 201
        self._place = f"{service.address}/api/v1/vehicles/{made.json()['id']}"
        self._began_s = time.monotonic()
        self._silent = threading.Event()
        self._sending = threading.Thread(target=self._send)

    def __enter__(self) -> Self:
        self._sending.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        self.fall_silent()
        httpx.delete(self._place, timeout=PATIENCE_S)

    def fall_silent(self) -> None:
        """Send nothing any more."""
        self._silent.set()
        self._sending.join()

    def _send(self) -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as air:
            while not self._silent.wait(PAUSE_S):
                for message in self._messages():
                    air.sendto(self._codec.pack(message), ("127.0.0.1", self._port))

    def _messages(self) -> tuple[Message, ...]:
        boot_ms = int((time.monotonic() - self._began_s) * 1000.0) + 1000
        place = {"lat": 335_000_000, "lon": -1_177_000_000, "alt": 100_000, "relative_alt": 50_000}
        moving = {"vx": 0, "vy": 0, "vz": 0, "hdg": 9000}
        return (
            Message("HEARTBEAT", {"type": 1, "autopilot": 3}),
            Message("GLOBAL_POSITION_INT", {"time_boot_ms": boot_ms} | place | moving),
        )
