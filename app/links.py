"""``python -m app.links``: the process that holds the links to the vehicles, apart from all other work.

It takes its settings as JSON from standard input and detaches itself: whoever started it may die. What it
shares with the service is the database file; what it is asked comes over a socket beside that file.
"""

from __future__ import annotations

import asyncio
import os
import sys
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Final

from app.priority import go_first

if TYPE_CHECKING:
    from pathlib import Path

    from fastapi import FastAPI

    from app.services.links.place import Lock, Place
    from app.settings import Settings

_LOOK_S: Final = 5.0
#: Nobody asking and nothing heard of any vehicle but simulated ones for so long, it ends by itself.
IDLE_S: Final = 900.0
#: A log that has grown to this is kept as ``.1``, and begun anew.
MOST_LOG_BYTES: Final = 10_000_000


def main() -> None:
    """Detach, then hold links until told to end."""
    text = sys.stdin.read()
    if os.fork():
        # Without the interpreter's end: what is written at it belongs to the child.
        os._exit(0)
    os.setsid()
    go_first()

    import json

    import structlog

    from app.apart import fingerprint_of
    from app.logging import configure
    from app.services.links.place import Holder, Lock, PlaceTakenError, place_of
    from app.settings import Settings
    from app.version import VERSION

    settings = Settings(**json.loads(text))
    configure(settings.log_level, threaded=True)
    log = structlog.get_logger(__name__)
    place = place_of(settings.database)
    try:
        lock = Lock(place, Holder(os.getpid(), VERSION, fingerprint_of(settings)))
    except PlaceTakenError as error:
        log.error("links not held", reason=str(error))
        sys.exit(1)
    try:
        _hold(settings, place, lock)
    finally:
        place.links.unlink(missing_ok=True)
        lock.release()


def _hold(settings: Settings, place: Place, lock: Lock) -> None:
    import uvicorn

    from app.serving import GRACE_S, Server, private_socket

    app = links_app(settings)
    config = uvicorn.Config(
        app, log_config=None, access_log=False, server_header=False, timeout_graceful_shutdown=GRACE_S
    )

    async def listening() -> None:
        await _until_idle(app, place, lock)
        server.should_exit = True

    async def ending() -> None:
        await app.state.house.fleet.close()

    server = Server(config, listening, ending)
    app.state.end = lambda: setattr(server, "should_exit", True)
    server.run(sockets=[private_socket(place.links)])


def links_app(settings: Settings) -> FastAPI:
    """The application of the process: vehicles, and what the service asks."""
    from app.assembly import assemble, limits_of
    from app.routers import links, vehicles
    from app.services.links.house import LinksHouse

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        house = LinksHouse(limits_of(settings))
        app.state.house = house
        try:
            await house.open()
            yield
        finally:
            await house.close()

    return assemble(settings, lifespan, (vehicles.router, links.router), openapi_url=None)


async def _until_idle(app: FastAPI, place: Place, lock: Lock) -> None:
    """Return when nobody finds this process any more, or nobody needs it."""
    import structlog

    log = structlog.get_logger(__name__)
    house = app.state.house
    while True:
        await asyncio.sleep(_LOOK_S)
        _roll(place.log)
        fleet = house.fleet
        if fleet.heard():
            house.needed_s = time.monotonic()
        if not lock.stands and not fleet.in_use():
            log.warning("links end: their database has been removed")
            return
        if time.monotonic() - house.needed_s > IDLE_S:
            log.warning("links end: nobody has asked and no vehicle was heard", for_s=IDLE_S)
            return


def _roll(path: Path) -> None:
    """Begin the log anew where it has grown large."""
    if path.exists() and path.stat().st_size > MOST_LOG_BYTES:
        path.replace(path.with_name(path.name + ".1"))
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
        os.dup2(descriptor, 2)
        os.close(descriptor)


if __name__ == "__main__":
    main()
