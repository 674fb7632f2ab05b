"""The service as a process: one socket, one event loop, an orderly end."""

from __future__ import annotations

import asyncio
import hashlib
import socket
from collections.abc import Callable, Coroutine, Mapping
from dataclasses import dataclass
from typing import Any

import structlog
import uvicorn
from fastapi import FastAPI

from app.apart import keeper_of
from app.doorkeeper import DoorProcess
from app.logging import configure
from app.main import create_app
from app.services.documents import write_json
from app.services.errors import ServiceError
from app.services.house import House
from app.services.limits import Limits
from app.services.links.keeper import Keeper
from app.services.links.place import place_of
from app.services.vehicles.greeting import Wishes, greet
from app.serving import GRACE_S, Server, private_socket
from app.settings import Settings

log = structlog.get_logger(__name__)

#: So many connections wait to be accepted while nobody does.
BACKLOG = 1024


class StartError(Exception):
    """The service could not start; the message says why."""


@dataclass(frozen=True, slots=True)
class Welcome(Wishes):
    """What a fresh service does by itself: connect vehicles, plan a scenario."""

    scenario: Mapping[str, Any] | None = None


async def _begin(house: House, welcome: Welcome, announced: Callable[[], None]) -> None:
    """Whoever comes once it is announced finds the sample among the plans, if only queued."""
    try:
        if welcome.scenario is not None:
            await _plan_sample(house, welcome.scenario)
    except ServiceError as error:
        log.error("the scenario is not planned", reason=str(error))
    announced()
    if house.keeper is None:
        await greet(house.fleet, welcome)
        return
    try:
        await house.keeper.greet()
    except ServiceError as error:
        log.error("start-up wish not fulfilled", reason=str(error))


async def _plan_sample(house: House, scenario: Mapping[str, Any]) -> None:
    # The key keeps restarts from planning the same sample again and again.
    key = "start-" + hashlib.sha256(write_json(scenario).encode()).hexdigest()[:32]
    record = await house.planning.submit(scenario, key)
    if record.state in ("failed", "cancelled"):
        await house.planning.submit(scenario)


def _house_apart(limits: Limits, keeper: Keeper) -> House:
    return House(limits, keeper=keeper)


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

    The links to the vehicles are held in this process.

    Raises
    ------
    StartError
        The port is taken, or the services cannot be opened.
    """
    configure(settings.log_level)
    app = create_app(settings, build_house)
    config = _config(app, settings)
    listener = listen(config)
    address = _address(settings, listener)

    async def listening() -> None:
        await _begin(app.state.house, welcome, lambda: announce(address))

    _run(app, Server(config, listening, app_ending(app)), listener)


def run_apart(
    settings: Settings,
    welcome: Welcome,
    announce: Callable[[str], None],
    build_house: Callable[[Limits, Keeper], House] = _house_apart,
    *,
    keep_links: bool = False,
) -> None:
    """The same with the links in a process of their own, and a door before both that goes to either.

    Parameters
    ----------
    keep_links
        Whether that process stays when this one ends in good order; it stays anyway while a vehicle is armed.

    Raises
    ------
    StartError
        As ``run_server``, and when the process of the links does not begin.
    """
    configure(settings.log_level)
    wishes = Wishes(welcome.simulated, welcome.sim_url, welcome.vehicle, welcome.forward)
    keeper = keeper_of(settings, wishes, keep=keep_links)
    app = create_app(settings, lambda limits: build_house(limits, keeper))
    config = _config(app, settings)
    listener = listen(config)
    listener.listen(BACKLOG)
    address = _address(settings, listener)
    place = place_of(settings.database)
    door = DoorProcess(listener, place)

    async def listening() -> None:
        await door.open()
        begun = _begin(app.state.house, welcome, lambda: announce(address))
        await asyncio.gather(begun, door.watch())

    with listener:
        try:
            place.web.parent.mkdir(parents=True, exist_ok=True)
            _run(app, Server(config, listening, app_ending(app)), private_socket(place.web))
        finally:
            door.close()
            place.web.unlink(missing_ok=True)


def app_ending(app: FastAPI) -> Callable[[], Coroutine[Any, Any, None]]:
    """What an application's services do before its server ends."""

    async def ending() -> None:
        await app.state.house.let_go()

    return ending


def _config(app: FastAPI, settings: Settings) -> uvicorn.Config:
    return uvicorn.Config(
        app,
        host=settings.host,
        port=settings.port,
        log_config=None,
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=GRACE_S,
        # More than the door lets through: a head that is too long is refused there, in words.
        h11_max_incomplete_event_size=1 << 18,
    )


def _address(settings: Settings, listener: socket.socket) -> str:
    name = f"[{settings.host}]" if ":" in settings.host else settings.host
    return f"http://{name}:{listener.getsockname()[1]}"


def _run(app: FastAPI, server: Server, listener: socket.socket) -> None:
    try:
        server.run(sockets=[listener])
    except SystemExit as error:  # uvicorn's end after a failed start
        raise StartError(f"the service cannot start: {app.state.start_failure}") from error
