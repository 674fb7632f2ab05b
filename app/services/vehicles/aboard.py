"""What should be on board by what was sent from here, and whether it is: asked before it is flown."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import structlog

from app.services.records import HeldMission
from mavlink.dialects.compare import Difference
from mavlink.errors import TransferFailedError
from mavlink.state.telemetry import VehicleState
from mavlink.wire.items import MissionItem, MissionType

if TYPE_CHECKING:
    from app.services.vehicles.vehicle import Vehicle

log = structlog.get_logger(__name__)

#: Orders that have an aircraft fly what it holds, or make it ready to.
ASKED: Final = frozenset({"start", "arm"})
#: The number of items is reported once a second; one report may be older than an upload, no more.
_REPORTED_S: Final = 3.0
#: Another operation is waited for so long.
_LOOKS: Final = 600
_LOOK_S: Final = 0.05
_FRESH_S: Final = 5.0

Compare = Callable[[tuple[MissionItem, ...], tuple[MissionItem, ...]], tuple[Difference, ...]]


class NotAboardError(Exception):
    """The vehicle does not hold what was sent to it, or nobody can tell."""

    def __init__(self, rule: str, message: str, fix: str) -> None:
        self.rule, self.message, self.fix = rule, message, fix
        super().__init__(message)


@dataclass(frozen=True, slots=True)
class Meant:
    """The mission of a plan as it was read back from the vehicle, and how another one is compared with it."""

    held: HeldMission
    items: tuple[MissionItem, ...]
    compare: Compare


class Aboard:
    """Watches one vehicle for signs that it holds something else than was sent to it.

    Attributes
    ----------
    meant
        What was sent and read back last; None where nothing was, or where that is not known.
    asked_s
        When it was last asked, and held what was meant, in the link's clock.
    """

    def __init__(self) -> None:
        self.meant: Meant | None = None
        self.asked_s = -math.inf
        self._restarts = 0
        # Since when another number of items than which is reported, and whether that was told.
        self._strange: tuple[int | None, float, bool] | None = None

    def fresh(self, now_s: float) -> bool:
        """Whether it was asked so lately that asking again tells nothing: ``start`` follows on ``arm``."""
        return now_s < self.asked_s + _FRESH_S

    def lost(self, state: VehicleState, now_s: float) -> str | None:
        """Why what it holds has to be read anew, told once; None where nothing speaks for it."""
        if state.restarts != self._restarts or not state.connected:
            self.asked_s = -math.inf
        if state.restarts != self._restarts:
            again = state.restarts > self._restarts
            self._restarts = state.restarts
            if again:
                return "it has started anew"
        expected = None if self.meant is None else len(self.meant.items)
        gone = bool(expected) and state.mission_state == "none"
        other = expected is not None and state.mission_total not in (None, expected)
        if not (gone or other):
            self._strange = None
            return None
        if self._strange is None or self._strange[0] != expected:
            self._strange = expected, now_s, False
        _, since_s, said = self._strange
        if said or now_s < since_s + _REPORTED_S:
            return None
        self._strange = expected, since_s, True
        return "it holds no mission" if gone else f"it holds {state.mission_total} items, not {expected}"


async def require_aboard(vehicle: Vehicle) -> None:
    """Ask the vehicle what it holds; nothing is asked where nothing was sent from here.

    Of a mission that was read back since the vehicle was last lost, started or changed by anybody, the number
    of items and the vehicle's own id are asked; every other one is read whole.

    Raises
    ------
    NotAboardError
        It holds something else than was sent, or does not tell.
    """
    if vehicle.sent is None:
        return
    meant = vehicle.aboard.meant
    if meant is None:
        raise NotAboardError(
            "mission-unknown",
            f"plan {vehicle.sent.plan_id} was sent to the vehicle, and never read back whole as it was meant",
            "upload it again; or clear the mission; or order it with as_held to fly whatever is held",
        )
    if vehicle.standing()[0] == "held" and vehicle.aboard.fresh(vehicle.client.now_s):
        return
    # What else is read of it ends by itself; whoever ordered this waits no longer than for an answer.
    for _ in range(_LOOKS):
        if vehicle.turns.operation is None:
            break
        await asyncio.sleep(_LOOK_S)
    try:
        async with vehicle.turns.busy("asking what is on board"):
            if vehicle.standing()[0] == "held" and await _counted(vehicle, meant):
                return
            found = await vehicle.client.download(MissionType.MISSION)
    except TransferFailedError as error:
        raise NotAboardError(
            "mission-unread",
            f"the vehicle does not tell what it holds: {error}",
            "send it again; or order it with as_held to fly whatever is held",
        ) from error
    differences = meant.compare(meant.items, found)
    if differences:
        vehicle.holds_unknown()
    else:
        vehicle.client.recognise(MissionType.MISSION)
    vehicle.found(not differences)
    vehicle.tell()
    if not differences:
        return
    log.warning("not on board", vehicle=vehicle.name, plan_id=meant.held.plan_id, held=len(found))
    what = "no mission" if not found else f"another mission of {len(found)} items"
    raise NotAboardError(
        "mission-differs",
        f"the vehicle holds {what}, and not the {len(meant.items)} items of plan {meant.held.plan_id}: "
        f"{differences[0]}",
        "upload the plan again; or order it with as_held to fly what is held",
    )


async def _counted(vehicle: Vehicle, meant: Meant) -> bool:
    """Whether the number of items, and the id where there is one, are those of what was read back."""
    count, list_id = await vehicle.client.count_held()
    known = vehicle.sent_id
    same = count == len(meant.items) and (known is None or list_id in (None, known))
    vehicle.aboard.asked_s = vehicle.client.now_s if same else -math.inf
    return same
