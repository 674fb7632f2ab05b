"""What must be so before a driver begins anything, and the words for it where it is not."""

from __future__ import annotations

import math
from collections.abc import Callable

from mavlink.errors import BusyError, DoubtError, NotConnectedError, ReadOnlyError
from mavlink.links.link import Link
from mavlink.state.telemetry import VehicleState
from mavlink.station.identity import SILENT, Identity
from mavlink.station.trust import Trust
from mavlink.station.under_way import UnderWay


class Requirements:
    """The part of a driver that says no."""

    state: VehicleState
    read_only: bool
    _link: Link
    _failure: str | None
    _identity: Identity
    _trust: Trust
    _under_way: UnderWay
    _clock: Callable[[], float]
    _heard_s: float

    @property
    def silent_s(self) -> float:
        """How long nothing was heard of the vehicle; infinite before its first word."""
        return self._clock() - self._heard_s

    def require_free(self) -> None:
        """Raise BusyError when a transfer is under way, and what ``require_connected`` raises."""
        self.require_connected()
        if self._under_way.transferring:
            raise BusyError("another transfer with this vehicle is under way")

    def require_connected(self) -> None:
        """Raise NotConnectedError unless the vehicle is there, ReadOnlyError when it is a recording."""
        if self.read_only:
            raise ReadOnlyError(f"{self._link.url} is a recording: it takes no transfers and no commands")
        if self._failure is not None:
            raise NotConnectedError(self._failure)
        if not self.state.connected:
            raise NotConnectedError(self.absence)

    def require_reachable(self) -> None:
        """Raise as ``require_connected``, but not of a vehicle that has only fallen silent: it may hear."""
        silent = self._failure is None and not self.read_only and not self.state.connected
        if silent and self._why_absent == SILENT and math.isfinite(self.silent_s):
            return
        self.require_connected()

    @property
    def absence(self) -> str:
        """Why a vehicle that is not connected cannot be talked to."""
        told = self._why_absent
        if told == SILENT and math.isfinite(self.silent_s):
            return f"{SILENT}: it was last heard {self.silent_s:.0f} s ago, and nothing is sent"
        return told

    @property
    def _why_absent(self) -> str:
        return self._failure or self._trust.absence or self._identity.absence(self.state)

    def require_certain(self) -> None:
        """Raise DoubtError unless the vehicle meant hears, and it alone; NotConnectedError without one."""
        self.require_connected()
        doubt = self.state.doubt
        if doubt is not None:
            raise DoubtError(doubt.rule, doubt.message, doubt.fix)
