"""Bounds of plans that are done: looked for one after the other, where no plan waits for a worker."""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import Awaitable, Callable
from pathlib import Path

import structlog

log = structlog.get_logger(__name__)


class Bounder:
    """Plans that wait for their bound.

    Parameters
    ----------
    bound
        Bounds the plan of an id, or says False; ends early once there is no file any more at the path.
    told
        Told of each plan that waits for nothing any more.
    room
        Whether a worker is free that no plan waits for.
    """

    def __init__(
        self,
        bound: Callable[[str, str], Awaitable[bool]],
        told: Callable[[str], Awaitable[None]],
        room: Callable[[], bool],
    ) -> None:
        self._bound = bound
        self._told = told
        self._room = room
        self._waiting: dict[str, None] = {}
        self._changed = asyncio.Event()
        self._wanted: Path | None = None

    def __contains__(self, plan_id: str) -> bool:
        return plan_id in self._waiting

    def add(self, plan_id: str) -> None:
        """Bound a plan when there is room."""
        self._waiting[plan_id] = None
        self._changed.set()

    def drop(self, plan_id: str) -> None:
        """Not to bound a plan any more."""
        self._waiting.pop(plan_id, None)

    def look(self) -> None:
        """Look again whether there is room: a plan has come, or has ended."""
        if self._wanted is not None and not self._room():
            self._wanted.unlink(missing_ok=True)
        self._changed.set()

    async def serve(self) -> None:
        """Bound plans, until cancelled."""
        while True:
            await self._changed.wait()
            self._changed.clear()
            while self._waiting and self._room():
                await self._next(next(iter(self._waiting)))

    async def _next(self, plan_id: str) -> None:
        with tempfile.TemporaryDirectory(prefix="swathplan-") as folder:
            wanted = self._wanted = Path(folder) / "wanted"
            wanted.touch()
            try:
                if not await self._bound(plan_id, str(wanted)) and not wanted.exists():
                    # It made room, and is looked for anew: the same scenario has the same bound.
                    return
                self.drop(plan_id)
            except Exception as error:
                # A plan is good without a bound; the next ones may still get theirs.
                log.error("plan has no bound", plan_id=plan_id, exc_info=error)
                self.drop(plan_id)
            finally:
                self._wanted = None
        await self._told(plan_id)
