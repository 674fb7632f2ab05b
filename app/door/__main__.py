"""``python -m app.door FD WEB LINKS``: the door on a listening socket, open while standard input is."""

from __future__ import annotations

import asyncio
import contextlib
import resource
import signal
import socket
import sys

from app.door.crowd import most_connections
from app.door.door import MOST_CONNECTIONS, Door
from app.door.quiet import Quiet
from app.priority import go_first


async def _serve(listener: socket.socket, web: str, links: str) -> None:
    ending = asyncio.Event()
    loop = asyncio.get_running_loop()
    loop.add_signal_handler(signal.SIGTERM, ending.set)
    reader = asyncio.StreamReader()
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), sys.stdin)
    soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    most = most_connections(MOST_CONNECTIONS, soft)
    loop.set_exception_handler(Quiet())
    door = Door(web, links, most=most)
    server = await asyncio.start_server(door.serve, sock=listener, backlog=min(most, 1024))
    sys.stdout.write("open\n")
    sys.stdout.flush()
    hearing = asyncio.create_task(reader.read())
    told = asyncio.create_task(ending.wait())
    await asyncio.wait((hearing, told), return_when=asyncio.FIRST_COMPLETED)
    server.close()


def main() -> None:
    """Run the door."""
    go_first()
    fd, web, links = sys.argv[1:]
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    with contextlib.suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    asyncio.run(_serve(socket.socket(fileno=int(fd)), web, links))


if __name__ == "__main__":
    main()
