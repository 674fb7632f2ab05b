"""A link with a client on it, and the simulated aircraft at its other end where one is asked for."""

from __future__ import annotations

import asyncio
import contextlib
import math
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlencode

from app.services.errors import LinkError, RefusedError
from app.services.vehicles import hints
from app.services.vehicles.simulated import SimulatedAircraft, SimulatorProcess, parse_simulated
from app.services.vehicles.times import DEFAULT_TIMES, LinkTimes
from mavlink import errors as mavlink_errors
from mavlink.encoding.payload import PayloadError, parse_payload
from mavlink.links.link import FORMS, open_link
from mavlink.links.replay import parse_replay
from mavlink.station.client import VehicleClient
from mavlink.station.forward.hub import Forwards
from mavlink.station.identity import SILENT
from mavlink.wire.signing import Signing
from planner.errors import Finding

#: Latitude, longitude in degrees, metres above sea level.
Home = tuple[float, float, float]

#: How long a heartbeat is waited for where nobody says.
CONNECT_S = 10.0

_FORMS = ("udpin", "udpout", "tcp", "tcpin", "serial", "replay")


def is_replay(url: str) -> bool:
    """Whether an address names a recording."""
    return url.partition(":")[0] == "replay"


def replayed_plan(url: str) -> tuple[str, str | None, str | None]:
    """A ``replay:`` address without its options ``plan`` and ``payload``, and these two.

    They are the id of the plan that was flown, and how the sensor was switched.

    Raises
    ------
    RefusedError
        The address is malformed, or the payload not understood.
    """
    try:
        path, options = parse_replay(url)
    except mavlink_errors.AddressError as error:
        raise _refused(error, "write e.g. replay:flight.tlog?speedup=10") from error
    plan_id, payload = options.pop("plan", None), options.pop("payload", None)
    if payload is not None:
        try:
            parse_payload(payload)
        except PayloadError as error:
            fix = "write e.g. payload=relay:0 or payload=servo:5:2000:1000"
            raise RefusedError(str(error), (Finding("url", "payload", str(error), fix),)) from error
    return f"replay:{path}" + (f"?{urlencode(options)}" if options else ""), plan_id, payload


def _refused(error: mavlink_errors.AddressError, fix: str) -> RefusedError:
    return RefusedError(str(error), (Finding("url", "link-address", str(error), fix),))


def simulated_of(url: str) -> SimulatedAircraft | None:
    """What a ``sim:`` address asks for; None for other addresses, RefusedError for malformed ones."""
    form = url.partition(":")[0]
    if form == "sim":
        return parse_simulated(url)
    if form not in _FORMS:
        message = f"{url[:80]} is no link address"
        if form in ("http", "https"):
            message += ": a vehicle's is meant, not the service's"
        raise RefusedError(message, (Finding("url", "link-address", message, f"write {FORMS} or sim:"),))
    return None


@dataclass(frozen=True, slots=True)
class Connection:
    """An open link."""

    client: VehicleClient
    simulator: SimulatorProcess | None = None

    async def close(self) -> None:
        """Close the link and end the simulator."""
        try:
            await self.client.close()
        finally:
            if self.simulator is not None:
                await self.simulator.stop()


async def connect(
    url: str,
    home: Home | None,
    timeout_s: float,
    tap: Callable[[bytes], None] | None = None,
    forwards: Forwards | None = None,
    vehicle_system: int = 0,
    times: LinkTimes = DEFAULT_TIMES,
    signing: Signing | None = None,
) -> Connection:
    """Open the link, start the simulator where one is asked for, wait for a heartbeat.

    A vehicle that stays silent is not an error: the client goes on listening.

    Parameters
    ----------
    home
        Where a simulated aircraft stands whose address does not say.
    tap
        Called with every frame of the link.
    forwards
        Other ground stations that hear the vehicle.
    vehicle_system
        The system id to talk to; 0 takes the first autopilot heard.
    times
        How patient its client is.
    signing
        Signs and verifies; None: nothing is signed.

    Raises
    ------
    RefusedError
        The address is malformed.
    LinkError
        The link cannot be opened, or the simulator ended.
    """
    aircraft = simulated_of(url)
    if is_replay(url):
        url, *_ = replayed_plan(url)
    try:
        link = await open_link(url if aircraft is None else "tcpin:127.0.0.1:0")
    except mavlink_errors.AddressError as error:
        raise _refused(error, f"write {FORMS} or sim:") from error
    except mavlink_errors.LinkError as error:
        raise LinkError(f"{error}{hints.shut(url)}") from error
    client = VehicleClient(
        link,
        tap=tap,
        forwards=forwards,
        vehicle_system=vehicle_system,
        settings=times.transfers,
        lost_after_s=times.lost_after_s,
        signing=signing,
    )
    try:
        simulator = None
        if aircraft is not None:
            standing = aircraft if aircraft.home is not None else aircraft.at(home)
            simulator = await SimulatorProcess.start(standing, int(link.url.rpartition(":")[2]))
        await _first_heartbeat(client, simulator, timeout_s)
    except BaseException:
        await _to_the_end(Connection(client, simulator).close())
        raise
    return Connection(client, simulator)


async def _first_heartbeat(
    client: VehicleClient, simulator: SimulatorProcess | None, timeout_s: float
) -> None:
    """Wait for a heartbeat, but not while another aircraft answers, or for a simulator that has ended."""
    hearing = asyncio.create_task(client.connect(timeout_s))
    # Ended by the first of the others, and not by its own time.
    other = asyncio.create_task(client.wait_for(lambda state: state.other_system is not None, math.inf))
    ending = asyncio.create_task(simulator.wait()) if simulator is not None else None
    try:
        await asyncio.wait(
            [task for task in (hearing, other, ending) if task is not None],
            return_when=asyncio.FIRST_COMPLETED,
        )
        if simulator is not None and not hearing.done():
            await simulator.raise_last_words()
        if client.state.other_system is not None:
            return
        with contextlib.suppress(mavlink_errors.VehicleNotFoundError):
            await hearing
    except mavlink_errors.NotConnectedError as error:
        raise LinkError(str(error)) from error
    finally:
        tasks = [task for task in (hearing, other, ending) if task is not None]
        # All of them before any is waited for: that may be cancelled too.
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


#: Closings that go on although whoever waited for them was cancelled; tasks nobody holds may be collected.
_closing: set[asyncio.Task[None]] = set()


async def _to_the_end(closing: Coroutine[Any, Any, None]) -> None:
    """Wait for a closing, which a second cancellation does not cut short: a simulator would outlive it."""
    task = asyncio.create_task(closing)
    _closing.add(task)
    task.add_done_callback(_closing.discard)
    await asyncio.shield(task)


@asynccontextmanager
async def connected(
    url: str, home: Home | None, timeout_s: float, signing: Signing | None = None
) -> AsyncIterator[VehicleClient]:
    """A client of a vehicle that has been heard; raises LinkError when it stays silent."""
    connection = await connect(url, home, timeout_s, signing=signing)
    try:
        if not connection.client.state.connected:
            if connection.client.absence != SILENT:
                raise LinkError(connection.client.absence)
            raise LinkError(f"no autopilot was heard on {url} within {timeout_s:g} s{hints.silent(url)}")
        yield connection.client
    finally:
        await connection.close()
