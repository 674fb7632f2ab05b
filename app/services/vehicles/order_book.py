"""What was ordered of one vehicle, and what became of it: done, refused, pending, overtaken, unknown."""

from __future__ import annotations

import asyncio
import uuid
from collections import deque
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Final, Literal

from app.services.errors import NotFoundError
from app.services.vehicles.audit import Entry
from planner.errors import Finding

OrderOutcome = Literal["done", "refused", "pending", "overtaken", "unknown"]

#: Orders that have an aircraft stop what it does, and that have it fly its mission.
STOPPING: Final = frozenset({"pause", "rtl", "land", "hold", "disarm"})
GOING: Final = frozenset({"start", "resume", "goto_item"})
#: Orders that make safe: nothing of the service's own holds them up.
SAFE: Final = STOPPING | {"sensor_off"}
#: Those of them that are given to a vehicle that has fallen silent, too: it may still hear.
UNHEARD: Final = frozenset({"rtl", "hold", "land", "sensor_off"})
#: Orders that make a vehicle fly a mission, and so not while one is being changed.
FLYING: Final = GOING | {"arm"}
_KEPT: Final = 50


@dataclass(slots=True)
class Order:
    """One flight command as it stands.

    Parameters
    ----------
    outcome
        ``pending``: not answered, or answered and not shown yet. ``unknown``: it may have been carried out.
    reason
        In words; empty where nothing is to be said.
    findings
        Of a refused one: the rule, and the way out.
    sent
        Whether the vehicle may have heard of it.
    entry
        Its entry in the audit.
    """

    command: str
    id: str = field(default_factory=lambda: str(uuid.uuid4()))
    given_at: datetime = field(default_factory=lambda: datetime.now(UTC))
    outcome: OrderOutcome = "pending"
    reason: str = "not answered yet"
    findings: tuple[Finding, ...] = ()
    sent: bool = False
    entry: Entry | None = None

    @property
    def unrecorded(self) -> str | None:
        """Why its entry is not written yet; None once it is."""
        return None if self.entry is None else self.entry.unrecorded

    def end(self, outcome: OrderOutcome, reason: str = "", findings: tuple[Finding, ...] = ()) -> None:
        """Say what became of it; what was said first stands."""
        if self.outcome == "pending":
            self.outcome, self.reason, self.findings = outcome, reason, findings


class OrderBook:
    """The latest orders of one vehicle; a newer one overtakes those under way that it makes senseless."""

    def __init__(self) -> None:
        self._orders: deque[Order] = deque(maxlen=_KEPT)
        self._tasks: dict[str, asyncio.Task[None]] = {}

    @property
    def latest(self) -> Order | None:
        """The one given last; None before the first."""
        return self._orders[-1] if self._orders else None

    def newest_first(self) -> tuple[Order, ...]:
        """The last fifty."""
        return tuple(reversed(self._orders))

    def get(self, order_id: str) -> Order:
        """One by its id; raises NotFoundError."""
        for order in self._orders:
            if order.id == order_id:
                return order
        raise NotFoundError("command", order_id)

    def begin(self, command: str) -> Order:
        """Note a new one, and stop those it overtakes."""
        for order in self._orders:
            if order.outcome == "pending" and _overtakes(command, order.command):
                order.end(
                    "overtaken", f"{command} was given before it was settled; it may have been carried out"
                )
                task = self._tasks.get(order.id)
                if task is not None:
                    task.cancel()
        order = Order(command)
        self._orders.append(order)
        return order

    def follow(self, order: Order, task: asyncio.Task[None]) -> None:
        """The task that carries an order out goes on, whoever waits for it."""
        self._tasks[order.id] = task
        task.add_done_callback(lambda _: self._tasks.pop(order.id, None))

    async def close(self) -> None:
        """Give up what is not settled."""
        tasks = tuple(self._tasks.values())
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


def _overtakes(newer: str, older: str) -> bool:
    if newer in STOPPING:
        return older in STOPPING | FLYING
    return newer in GOING and older in STOPPING | GOING
