"""Whose turn it is at a vehicle: one operation at a time, and no order to fly while its mission changes."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from typing import Any

from app.services.errors import BusyError, ConflictError, LinkError, UnsafeError
from mavlink import errors as mavlink_errors
from mavlink.station.forward.hub import Forwards
from planner.errors import Finding


class Turns:
    """What is at work on a vehicle, and which orders are not answered yet.

    Parameters
    ----------
    name
        The vehicle's, for refusals.
    replay
        It is a recording, on which nothing can work.
    forwards
        Other ground stations, which take their turns too.

    Attributes
    ----------
    operation
        What is at work now.
    changing
        Whether it changes what the vehicle holds.
    progress
        Of an upload at work: part, done, total.
    """

    def __init__(self, name: str, replay: bool, forwards: Forwards) -> None:
        self.operation: str | None = None
        self.changing = False
        self.progress: dict[str, Any] | None = None
        self._name = name
        self._replay = replay
        self._forwards = forwards
        self._orders: list[str] = []

    def require_orders(self, what: str) -> None:
        """Raise ConflictError for a recording, which takes none."""
        if self._replay:
            raise ConflictError(
                f"{self._name} is a recording: it takes no transfers and no commands ({what})"
            )

    @asynccontextmanager
    async def busy(self, operation: str, *, changes: bool = False) -> AsyncIterator[None]:
        """One operation at a time; raises BusyError naming the one at work.

        Parameters
        ----------
        changes
            Whether it changes what the vehicle holds; then no order to fly may be under way.
        """
        self.require_orders(operation)
        if self.operation is not None:
            raise BusyError(f"{self._name} is busy: {self.operation}")
        if changes and self._orders:
            raise BusyError(f"{self._name} is busy: the order {self._orders[0]} is not answered yet")
        self.operation, self.changing = operation, changes
        try:
            with self._forwards.reserved(changes=changes):
                yield
        except mavlink_errors.BusyError as error:
            raise BusyError(f"{self._name} is busy: {error}") from error
        except mavlink_errors.DoubtError as error:
            finding = Finding("vehicle", error.rule, error.message, error.fix)
            raise UnsafeError(f"{self._name}: {error}; no override helps", (finding,)) from error
        except (mavlink_errors.NotConnectedError, mavlink_errors.LinkError) as error:
            raise LinkError(f"{self._name}: {error}") from error
        finally:
            self.operation = None
            self.changing = False
            self.progress = None

    @contextmanager
    def ordering(self, order: str) -> Iterator[None]:
        """An order to fly is under way; raises BusyError while what is to be flown is being changed."""
        if self.changing:
            raise BusyError(f"{self._name} is busy: {self.operation}; {order} waits for its end")
        station = self._forwards.changing
        if station is not None:
            raise BusyError(
                f"{self._name} is busy: another ground station (system {station}) is changing its mission; "
                f"{order} waits for its end"
            )
        self._orders.append(order)
        try:
            yield
        finally:
            self._orders.remove(order)
