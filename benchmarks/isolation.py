"""Heartbeats to a vehicle, and orders to it, while every endpoint of the service is kept busy.

A fresh service (``swathplan serve``), an aircraft that only listens and answers
(``benchmarks.listening_aircraft``), and clients that saturate all endpoints (``benchmarks.request_flood``),
each in a process of its own. Orders go over HTTP as anybody's do, each over a new connection, by turns
``hold``, ``resume`` and ``rtl``; each is timed from the request to the answer that the aircraft shows it. Run
as ``python -m benchmarks.isolation``; prints JSON lines: one without load, one with.

On a machine that is busy otherwise (``machine_load``: how many processes want to run) the others are measured
too. What measures, and the aircraft, go first where the system lets them: their waits are not the service's.
"""

from __future__ import annotations

import http.client
import json
import os
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from app.priority import go_first

ROOT = Path(__file__).resolve().parents[1]
#: What is promised: seconds between two heartbeats, milliseconds from an order to its answer.
GAPS_S = (0.8, 1.2)
ANSWERED_MS = 100.0
PAUSE_S = 0.2
COMMANDS = ("hold", "resume", "rtl")
VEHICLES = "/api/v1/vehicles"


def free_port() -> int:
    """A UDP port that nobody holds."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def ask(address: str, method: str, path: str, body: Any = None) -> tuple[int, Any]:
    """Status and JSON of one request over a connection of its own."""
    connection = http.client.HTTPConnection(urlsplit(address).netloc, timeout=60.0)
    try:
        text = None if body is None else json.dumps(body)
        connection.request(method, path, text, {"Content-Type": "application/json"})
        answer = connection.getresponse()
        return answer.status, json.loads(answer.read() or b"null")
    finally:
        connection.close()


class Listening:
    """The aircraft's process, and what it has told."""

    def __init__(self, port: int) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "benchmarks.listening_aircraft", str(port)],
            cwd=ROOT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        self.heartbeats_s: list[float] = []
        self.orders_s: list[float] = []
        self._reading = threading.Thread(target=self._read)
        self._reading.start()

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            told = json.loads(line)
            (self.heartbeats_s if told["what"] == "heartbeat" else self.orders_s).append(told["at_s"])

    def gaps_s(self, since_s: float, until_s: float) -> list[float]:
        """Between heartbeats of a time, and from the last one to its end."""
        heard = [at_s for at_s in tuple(self.heartbeats_s) if since_s <= at_s <= until_s]
        return [after - before for before, after in pairwise(heard)]

    def close(self) -> None:
        """End it."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.close()
        self._process.wait()
        self._reading.join()
        self._process.stdout.close()


@contextmanager
def served(folder: Path) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """Address and process of a service of its own; the process that holds its links ends with it."""
    database = ["--database", str(folder / "plans.db")]
    command = [sys.executable, "-m", "app.cli", "serve", "--port", "0", "--json", *database]
    environment = os.environ | {"SWATHPLAN_LOG_LEVEL": "error"}
    with subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True) as service:
        try:
            assert service.stdout is not None
            yield json.loads(service.stdout.readline())["address"], service
        finally:
            service.terminate()
            service.wait()
            # Armed, the aircraft keeps it.
            ending = [sys.executable, "-m", "app.cli", "links", "--end", *database]
            subprocess.run(ending, cwd=ROOT, stdout=subprocess.DEVNULL, check=True)


def connect(address: str, port: int) -> str:
    """The id of the aircraft, connected."""
    body = {"name": "uav", "url": f"udpin:127.0.0.1:{port}"}
    status, vehicle = ask(address, "POST", VEHICLES, body)
    if status != 201 or not vehicle["connected"]:
        raise RuntimeError(f"the aircraft was not connected: {vehicle}")
    return str(vehicle["id"])


def measure(address: str, vehicle_id: str, aircraft: Listening, seconds: float) -> dict[str, Any]:
    """Order by turns for so long; what came of it."""
    begun_s = time.monotonic()
    took_ms, reached_ms = [], []
    while time.monotonic() - begun_s < seconds:
        command = COMMANDS[len(took_ms) % len(COMMANDS)]
        count, sent_s = len(aircraft.orders_s), time.monotonic()
        status, told = ask(address, "POST", f"{VEHICLES}/{vehicle_id}/commands", {"command": command})
        took_ms.append((time.monotonic() - sent_s) * 1000.0)
        if status != 200 or told["outcome"] != "done":
            raise RuntimeError(f"{command} was not carried out: {told}")
        while len(aircraft.orders_s) == count:
            time.sleep(0.001)
        reached_ms.append((aircraft.orders_s[count] - sent_s) * 1000.0)
        time.sleep(PAUSE_S)
    gaps_s = aircraft.gaps_s(begun_s, time.monotonic())
    return {
        "seconds": time.monotonic() - begun_s,
        "heartbeats": len(gaps_s) + 1,
        "gap_least_s": min(gaps_s),
        "gap_most_s": max(gaps_s),
        "commands": len(took_ms),
        "answered_median_ms": float(np.median(took_ms)),
        "answered_p95_ms": float(np.percentile(took_ms, 95)),
        "answered_most_ms": max(took_ms),
        "reached_most_ms": max(reached_ms),
        "within": GAPS_S[0] <= min(gaps_s) and max(gaps_s) <= GAPS_S[1] and max(took_ms) <= ANSWERED_MS,
        "machine_load": os.getloadavg()[0],
        "cores": os.cpu_count(),
    }


@contextmanager
def flooded(address: str, vehicle_id: str, clients: int) -> Iterator[dict[str, int]]:
    """All endpoints kept busy meanwhile; afterwards how many answers there were of each status."""
    # Uploads to the vehicle itself would have its orders refused, as they should be.
    silent = {"name": f"silent-{free_port()}", "url": f"udpin:127.0.0.1:{free_port()}", "timeout_s": 0.1}
    _, other = ask(address, "POST", VEHICLES, silent)
    command = [sys.executable, "-m", "benchmarks.request_flood", address, str(clients)]
    command += [vehicle_id, other["id"]]
    with subprocess.Popen(
        command,
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as flood:
        answers: dict[str, int] = {}
        try:
            yield answers
        finally:
            out, _ = flood.communicate("")
            answers |= json.loads(out)


def run(seconds: float = 60.0, clients: int = 64) -> Iterator[dict[str, Any]]:
    """A row without load, and one with.

    Parameters
    ----------
    seconds
        Of the row with load; the other takes a sixth of it.
    clients
        How many send requests at once.
    """
    with tempfile.TemporaryDirectory() as name, served(Path(name)) as (address, _):
        go_first()
        port = free_port()
        aircraft = Listening(port)
        try:
            vehicle_id = connect(address, port)
            calm = measure(address, vehicle_id, aircraft, seconds / 6.0)
            yield {"benchmark": "isolation", "clients": 0, "requests": 0, "answers": {}, **calm}
            with flooded(address, vehicle_id, clients) as answers:
                time.sleep(min(2.0, seconds / 10.0))
                busy = measure(address, vehicle_id, aircraft, seconds)
            total = sum(answers.values())
            row = {"benchmark": "isolation", "clients": clients, "requests": total, "answers": answers}
            yield row | busy
        finally:
            aircraft.close()


if __name__ == "__main__":
    for row in run():
        sys.stdout.write(json.dumps(row) + "\n")
        sys.stdout.flush()
