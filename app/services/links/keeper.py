"""Keeps a process that holds the links: finds the one there, starts one where there is none, and again."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import subprocess
import sys
import time
from typing import Any, Final

import structlog

from app.services.errors import LinkError
from app.services.links.client import LinksClient, LinksState
from app.services.links.place import Holder, Place
from app.services.links.relay import LogRelay

log = structlog.get_logger(__name__)

#: So long a process may take to begin, and to end.
START_S: Final = 60.0
END_S: Final = 20.0
_LOOK_S: Final = 1.0
_POLL_S: Final = 0.05
#: Seconds between one death and the next start, doubled each time up to the second figure.
_BACKOFF_S: Final = (0.5, 30.0)
#: One that has run so long begins anew with the shortest.
_STEADY_S: Final = 60.0
#: A process that does not answer for so long sends no heartbeats either: it is ended and started anew.
HUNG_S: Final = 30.0


class Keeper:
    """The process that holds the links of one database.

    Parameters
    ----------
    settings
        For a new process, as JSON.
    version, fingerprint
        Of what the process should be; another one is started anew unless a vehicle is in use.
    keep
        Whether the process stays when the service ends in good order.
    wishes
        Vehicles to connect wherever a process begins, as JSON values of ``greeting.Wishes``.
    """

    def __init__(
        self,
        place: Place,
        settings: str,
        version: str,
        fingerprint: str,
        *,
        keep: bool = False,
        wishes: dict[str, Any] | None = None,
    ) -> None:
        self.client = LinksClient(place.links)
        self._place = place
        self._settings = settings
        self._version = version
        self._fingerprint = fingerprint
        self._keep = keep
        self._wishes = wishes
        self._relay = LogRelay(place.log)
        self._relaying: asyncio.Task[None] | None = None
        self._watching: asyncio.Task[None] | None = None

    async def open(self) -> None:
        """Find the process, or start it; raises LinkError when it does not begin."""
        holder = self._place.holder()
        self._relay.skip()
        self._relaying = asyncio.create_task(self._relay.serve())
        if holder is not None:
            holder = await self._found(holder)
        if holder is None:
            await self._start()
        self._watching = asyncio.create_task(self._watch())

    async def greet(self) -> None:
        """Let it connect the vehicles wished for."""
        if self._wishes is not None:
            await self.client.greet(self._wishes)

    async def metrics(self) -> str:
        """Its figures for Prometheus; none while it does not answer."""
        try:
            return await self.client.metrics()
        except LinkError as error:
            log.warning("figures of the links not told", reason=str(error))
            return ""

    async def close(self) -> None:
        """End the process, or let it be where a vehicle is in use or it shall be kept; again is harmless."""
        if self._watching is not None:
            await _cancelled(self._watching)
            self._watching = None
            holder = self._place.holder()
            if holder is not None:
                await self._leave(holder)
        if self._relaying is not None:
            await _cancelled(self._relaying)
            self._relaying = None
            self._relay.copy()
        await self.client.close()

    async def _leave(self, holder: Holder) -> None:
        try:
            in_use = (await self.client.state()).in_use
        except LinkError as error:
            log.error("links not asked whether they are in use", reason=str(error), pid=holder.pid)
            in_use = ()
        if not self._keep and not in_use:
            await end_holder(self._place)
            return
        why = "as asked for" if self._keep else f"in use: {', '.join(in_use)}"
        log.warning(
            "links stay: serve again to find them, or end them with swathplan links --end",
            why=why,
            pid=holder.pid,
        )

    async def _found(self, holder: Holder) -> Holder | None:
        """What becomes of a process that is there already; None when it was ended."""
        state = await self._state_of(holder)
        if state is None:
            return None
        if holder.fingerprint == self._fingerprint:
            log.info("links found again", pid=holder.pid, vehicles=state.vehicles, in_use=state.in_use)
            return holder
        differs = {"pid": holder.pid, "version": holder.version, "wanted": self._version}
        if state.in_use:
            log.warning("links stay as they are while in use: other settings", in_use=state.in_use, **differs)
            return holder
        log.warning("links are begun anew: other settings", **differs)
        await end_holder(self._place)
        return None

    async def _state_of(self, holder: Holder) -> LinksState | None:
        """How a process stands that may just have begun; None when it was hung and is ended."""
        end_s = time.monotonic() + HUNG_S
        while True:
            try:
                return await self.client.state()
            except LinkError as error:
                if self._place.holder() is None:
                    return None
                if time.monotonic() > end_s:
                    log.error("links do not answer and are ended", pid=holder.pid, reason=str(error))
                    await _kill(self._place, holder)
                    return None
            await asyncio.sleep(_POLL_S)

    async def _start(self) -> None:
        self._place.lock.parent.mkdir(parents=True, exist_ok=True)
        await asyncio.to_thread(self._spawn)
        end_s = time.monotonic() + START_S
        while not (self._place.holder() is not None and await self.client.answers()):
            if time.monotonic() > end_s:
                words = self._relay.last_words()
                raise LinkError(f"the process that holds the links did not begin: {words}")
            await asyncio.sleep(_POLL_S)
        log.info("links begun", pid=getattr(self._place.holder(), "pid", None))

    def _spawn(self) -> None:
        # It detaches itself, and its beginning ends at once: nobody has to wait for it later.
        command = [sys.executable, "-m", "app.links"]
        with self._place.log.open("ab") as errors:
            self._place.log.chmod(0o600)
            subprocess.run(
                command, input=self._settings.encode(), stdout=subprocess.DEVNULL, stderr=errors, check=True
            )

    async def _watch(self) -> None:
        """Start it anew whenever it has died, or hangs."""
        wait_s, begun_s, answered_s = _BACKOFF_S[0], time.monotonic(), time.monotonic()
        while True:
            await asyncio.sleep(_LOOK_S)
            if await self.client.answers():
                answered_s = time.monotonic()
                continue
            holder = self._place.holder()
            if holder is not None:
                if time.monotonic() - answered_s < HUNG_S:
                    continue
                log.error("links do not answer and are ended", pid=holder.pid)
                await _kill(self._place, holder)
            wait_s = (
                _BACKOFF_S[0] if time.monotonic() - begun_s > _STEADY_S else min(2 * wait_s, _BACKOFF_S[1])
            )
            log.error("links have ended; they are begun anew", in_s=wait_s)
            await asyncio.sleep(wait_s)
            begun_s = time.monotonic()
            try:
                await self._start()
                await self.greet()
            except (LinkError, OSError, subprocess.CalledProcessError) as error:
                log.error("links not begun", reason=str(error))
            answered_s = time.monotonic()


async def end_holder(place: Place) -> None:
    """End the process that holds the links, by force where it does not listen."""
    holder = place.holder()
    if holder is None:
        return
    client = LinksClient(place.links)
    try:
        with contextlib.suppress(LinkError):
            await client.end()
    finally:
        await client.close()
    if not await _gone(place):
        log.error("links do not end and are killed", pid=holder.pid)
        await _kill(place, holder)


async def _kill(place: Place, holder: Holder) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.kill(holder.pid, signal.SIGKILL)
    await _gone(place)


async def _gone(place: Place) -> bool:
    end_s = time.monotonic() + END_S
    while place.holder() is not None:
        if time.monotonic() > end_s:
            return False
        await asyncio.sleep(_POLL_S)
    return True


async def _cancelled(task: asyncio.Task[None]) -> None:
    task.cancel()
    await asyncio.gather(task, return_exceptions=True)
