"""Upload, read back, compare: what the vehicle really holds afterwards.

An acknowledgement is not enough: ArduPilot acknowledges fences it then drops, and PX4 acknowledges an item
repeated after it gave the upload up. A refusal is not enough either: ArduPilot keeps part of a refused list.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, Literal, Protocol

from mavlink.dialects.compare import Difference
from mavlink.errors import BusyError, NotConnectedError, TransferFailedError
from mavlink.transfer.machine import Progress
from mavlink.transfer.outcome import Accepted, Outcome, Refused, Unknown
from mavlink.wire.items import Command, MissionItem, MissionResult, MissionType

Compare = Callable[[tuple[MissionItem, ...], tuple[MissionItem, ...]], Sequence[Difference]]

# ArduPilot denies downloads until it has given up an upload whose items stopped coming: 8 s.
_DENIED_TRIES: Final = 6
_DENIED_PAUSE_S: Final = 2.0
# On a radio that loses a fifth of everything each way, every third read-back of 300 items fails.
_SILENT_TRIES: Final = 3
# ArduPilot looks ten times a second whether FENCE_TOTAL has become 0, and then wipes whatever fence it finds.
# The total counts corners and circles and stays 0 below three: a short fence sent right behind the clearing
# would be wiped, even after it was read back.
_CLEARED_PAUSE_S: Final = 0.5
_SHORT_FENCE: Final = 3


@dataclass(frozen=True, slots=True)
class VerifiedUpload:
    """An upload and what came of it.

    Parameters
    ----------
    outcome
        As the vehicle answered; accepted also when no answer came but the read-back equals what was meant.
    held
        Read back; None when that failed too.
    differences
        Between meant and held.
    resolved_from
        The unknown outcome in whose place the read-back put a known one.
    objections
        Why the vehicle will not fly the mission it holds, in its events' words; PX4 acknowledges it first.
    """

    outcome: Outcome
    held: tuple[MissionItem, ...] | None
    differences: tuple[Difference, ...] = ()
    resolved_from: Unknown | None = None
    objections: tuple[str, ...] = ()

    @property
    def status(self) -> Literal["stored", "different", "refused", "unknown", "rejected"]:
        """How it stands.

        ``stored``: the vehicle holds what was meant. ``different``: it holds something else. ``rejected``: it
        holds what was meant, and will not fly it.
        """
        if self.outcome.kind == "refused":
            return "refused"
        if self.held is None:
            return "unknown"
        if self.differences:
            return "different"
        return "rejected" if self.objections else "stored"


@dataclass(frozen=True, slots=True)
class Pending:
    """An upload of which nobody knows what came."""

    items: tuple[MissionItem, ...]
    mission_type: MissionType
    compare: Compare
    outcome: Outcome


class Transfers(Protocol):
    """What is needed of a vehicle's client."""

    async def upload(
        self,
        items: Sequence[MissionItem],
        mission_type: MissionType,
        progress: Callable[[Progress], None] | None = None,
    ) -> Outcome:
        """Upload without reading back."""

    async def update(
        self, items: Sequence[MissionItem], progress: Callable[[Progress], None] | None = None
    ) -> Outcome:
        """Replace some items of the mission without reading back."""

    async def download(self, mission_type: MissionType) -> tuple[MissionItem, ...]:
        """What the vehicle holds."""

    async def clear(self, mission_type: MissionType) -> Outcome:
        """Empty a list."""


async def upload_and_verify(
    vehicle: Transfers,
    items: Sequence[MissionItem],
    mission_type: MissionType,
    compare: Compare,
    progress: Callable[[Progress], None] | None,
) -> VerifiedUpload:
    """Upload, read back and compare; a fence is cleared first.

    ArduPilot acknowledges circles uploaded over a stored polygon and is then left with no fence at all.
    """
    if mission_type is MissionType.FENCE:
        cleared = await vehicle.clear(mission_type)
        if cleared.kind == "unknown":
            return await resolve(vehicle, Pending(tuple(items), mission_type, compare, cleared))
        if cleared.kind == "refused":
            return await _read_back(vehicle, Pending(tuple(items), mission_type, compare, cleared))
        if 0 < sum(item.command != Command.NAV_FENCE_RETURN_POINT for item in items) < _SHORT_FENCE:
            await asyncio.sleep(_CLEARED_PAUSE_S)
    outcome = await vehicle.upload(items, mission_type, progress)
    return await resolve(vehicle, Pending(tuple(items), mission_type, compare, outcome))


async def update_and_verify(
    vehicle: Transfers,
    items: Sequence[MissionItem],
    changed: range,
    compare: Compare,
    progress: Callable[[Progress], None] | None,
) -> VerifiedUpload:
    """Replace the items of a range by those of a mission, read the whole mission back and compare."""
    outcome = await vehicle.update(items[changed.start : changed.stop], progress)
    return await resolve(vehicle, Pending(tuple(items), MissionType.MISSION, compare, outcome))


async def resolve(vehicle: Transfers, pending: Pending) -> VerifiedUpload:
    """Read back and compare.

    A silent success becomes accepted, an unread acknowledgement unknown, and an error after the last item a
    refusal, once it is seen that the vehicle does not hold what was meant.
    """
    result = await _read_back(vehicle, pending)
    if result.held is None and result.outcome.kind == "accepted":
        return VerifiedUpload(Unknown("not-read-back"), None)
    if not isinstance(result.outcome, Unknown) or result.held is None:
        return result
    if not result.differences:
        return VerifiedUpload(Accepted(), result.held, (), result.outcome)
    if result.outcome.reason == "error-at-end":
        return VerifiedUpload(Refused(MissionResult.ERROR), result.held, result.differences, result.outcome)
    return result


async def _read_back(vehicle: Transfers, pending: Pending) -> VerifiedUpload:
    silent = 0
    for _ in range(_DENIED_TRIES):
        try:
            held = await vehicle.download(pending.mission_type)
        except (NotConnectedError, BusyError):
            return VerifiedUpload(pending.outcome, None)
        except TransferFailedError as error:
            if isinstance(error.outcome, Refused) and error.outcome.result == MissionResult.DENIED:
                await asyncio.sleep(_DENIED_PAUSE_S)
                continue
            silent += isinstance(error.outcome, Unknown) and error.outcome.reason == "timeout"
            if 0 < silent < _SILENT_TRIES:
                continue
            return VerifiedUpload(pending.outcome, None)
        differences = tuple(pending.compare(pending.items, held))
        return VerifiedUpload(pending.outcome, held, differences)
    return VerifiedUpload(pending.outcome, None)
