"""The service as a process: one socket, one event loop, an orderly end."""

from __future__ import annotations

import asyncio
import hashlib
import socket
from collections.abc import Callable, Coroutine, Mapping
from dataclasses import dataclass
from itertools import count
from typing import Any

import structlog
import uvicorn

from app.logging import configure
from app.main import create_app
from app.services.documents import write_json
from app.services.errors import ServiceError
from app.services.house import House, Limits
from app.settings import Settings

log = structlog.get_logger(__name__)

#: Open event streams are cut this long after the signal to end.
GRACE_S = 5


class StartError(Exception):
    """The service could not start; the message says why."""


@dataclass(frozen=True, slots=True)
class Welcome:
    """What a fresh service does by itself: connect vehicles, plan a scenario.

    Parameters
    ----------
    vehicle
        Address of a vehicle to connect unless it is known already; kept for the next start.
    forward
        Where to forward its link to, or else that of the simulated aircraft: addresses, and whether stations
        there may command.
    """

    simulated: int = 0
    sim_url: str = "sim:"
    scenario: Mapping[str, Any] | None = None
    vehicle: str | None = None
    forward: tuple[tuple[str, bool], ...] = ()


async def _greet(house: House, welcome: Welcome) -> None:
    try:
        if welcome.scenario is not None:
            await _plan_sample(house, welcome.scenario)
        forward = welcome.forward
        if welcome.vehicle is not None:
            await _connect(house, welcome.vehicle, forward)
            forward = ()
        for number in range(1, welcome.simulated + 1):
            await house.fleet.connect(f"sim-{number}", welcome.sim_url, keep=False, forward=forward)
    except ServiceError as error:
        log.error("start-up wish not fulfilled", reason=str(error))


async def _connect(house: House, url: str, forward: tuple[tuple[str, bool], ...]) -> None:
    """Connect a vehicle; one known from before is only forwarded, where that is wished for."""
    known = {vehicle.url: vehicle for vehicle in house.fleet.all()}
    if url in known:
        if forward:
            await house.fleet.forward(known[url].id, forward)
        return
    names = {vehicle.name for vehicle in known.values()}
    name = next(name for number in count(1) if (name := f"uav-{number}") not in names)
    await house.fleet.connect(name, url, forward=forward)


async def _plan_sample(house: House, scenario: Mapping[str, Any]) -> None:
    # The key keeps restarts from planning the same sample again and again.
    key = "start-" + hashlib.sha256(write_json(scenario).encode()).hexdigest()[:32]
    record = await house.planning.submit(scenario, key)
    if record.state in ("failed", "cancelled"):
        await house.planning.submit(scenario)


class _Server(uvicorn.Server):
    """Tells when it listens, then greets."""

    def __init__(
        self,
        config: uvicorn.Config,
        listening: Callable[[], Coroutine[Any, Any, None]],
        ending: Callable[[], Coroutine[Any, Any, None]],
    ) -> None:
        super().__init__(config)
        self._listening = listening
        self._ending = ending
        self._greeting: asyncio.Task[None] | None = None

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if self.started:
            self._greeting = asyncio.create_task(self._listening())

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        # Before the services close: what is still being connected would outlive them.
        if self._greeting is not None:
            self._greeting.cancel()
            await asyncio.gather(self._greeting, return_exceptions=True)
        # Requests that wait for a vehicle get their answer now; in GRACE_S they would be cut.
        await self._ending()
        await super().shutdown(sockets)


def listen(config: uvicorn.Config) -> socket.socket:
    """The listening socket; what is accepted from it sends at once, however little there is to send.

    asyncio sets TCP_NODELAY by itself on sockets of protocol TCP alone, and uvicorn's names none: answers on
    a connection that is kept would wait some 40 ms for the client's acknowledgement (RFC 896, RFC 1122).

    Raises
    ------
    StartError
        The port is taken.
    """
    try:
        listener = config.bind_socket()
    except SystemExit as error:  # uvicorn ends the process after logging what the system said
        reason = f"{config.host} port {config.port} cannot be listened on: {error.__context__}"
        raise StartError(f"{reason}. Choose another with --port") from error
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return listener


def run_server(
    settings: Settings,
    welcome: Welcome,
    announce: Callable[[str], None],
    build_house: Callable[[Limits], House] = House,
) -> None:
    """Serve until a signal; ``announce`` gets the address once requests are answered.

    Raises
    ------
    StartError
        The port is taken, or the services cannot be opened.
    """
    configure(settings.log_level)
    app = create_app(settings, build_house)
    config = uvicorn.Config(
        app,
        host=settings.host,
        port=settings.port,
        log_config=None,
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=GRACE_S,
    )
    listener = listen(config)
    port = listener.getsockname()[1]
    name = f"[{settings.host}]" if ":" in settings.host else settings.host

    def listening() -> Coroutine[Any, Any, None]:
        announce(f"http://{name}:{port}")
        return _greet(app.state.house, welcome)

    async def ending() -> None:
        await app.state.house.fleet.close()

    server = _Server(config, listening, ending)
    try:
        server.run(sockets=[listener])
    except SystemExit as error:  # uvicorn's end after a failed start
        raise StartError(f"the service cannot start: {app.state.start_failure}") from error
