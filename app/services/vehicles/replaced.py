"""A mission replaced in flight: where the aircraft goes on, and what of the new one it does not fly."""

from __future__ import annotations

from dataclasses import dataclass

from mavlink.dialects.mission import Mission
from mavlink.encoding.options import DEFAULT_PAYLOAD
from mavlink.encoding.payload import parse_payload
from mavlink.state.modes import RETURN_MODES, WAITING_MODES
from mavlink.state.passes import LeadIn, lead_in, passes_of
from mavlink.station.client import VehicleClient
from mavlink.wire.items import MissionType
from planner.plan import Plan

#: Modes in which it is not on a mission; where one ends too soon ArduPilot returns, PX4 waits.
OFF_ITS_MISSION = RETURN_MODES | WAITING_MODES
#: The vehicle tells its current item at least once a second; a new list shows there behind its upload.
TELLING_S = 2.0


@dataclass(frozen=True, slots=True)
class Replaced:
    """What a flying aircraft makes of a new mission.

    Parameters
    ----------
    mode
        In which it flies on.
    item, items
        The item it flies to, and how many there are; None where it does not say.
    skipped
        Passes that lie behind it in the new mission: number and region. They are not flown.
    cut
        The pass in whose middle it goes on, so that its sensor is not switched on; None where there is none.
    again
        Where to send it for the first of these passes, and all behind it; None where none is left out.
    """

    mode: str
    item: int | None
    items: int
    skipped: tuple[tuple[int, str], ...]
    cut: tuple[int, str] | None
    again: LeadIn | None = None

    def __str__(self) -> str:
        if self.mode in OFF_ITS_MISSION:
            return (
                f"the aircraft has left its mission (mode {self.mode}), as one does that is given fewer "
                "items than it has flown: goto_item 1, then resume, have it fly all of the new one"
            )
        if self.item is None:
            return f"the aircraft flies on in mode {self.mode}, and does not say to which item"
        words = f"the aircraft goes on at item {self.item} of {self.items - 1} (mode {self.mode})"
        if self.skipped:
            words += "; skipped: " + ", ".join(f"pass {seq} ({roi})" for seq, roi in self.skipped)
        if self.cut is not None:
            words += (
                f"; pass {self.cut[0]} ({self.cut[1]}) is begun in its middle, its sensor is not switched on"
            )
        if not self.skipped and self.cut is None:
            return words + "; no pass is skipped"
        return words if self.again is None else f"{words}; to fly them begin with the first: {self.again}"


async def replaced(
    client: VehicleClient, mission: Mission, plan: Plan, vehicle: str, payload: str | None
) -> Replaced:
    """Where a flying aircraft goes on with the mission it has just been given."""
    items = mission.items_of(MissionType.MISSION)
    begun_s = client.now_s

    # What is told of the current item before the new list was taken is of the old one.
    def told(now_s: float) -> bool:
        return client.state.mission_heard_s is not None and client.state.mission_heard_s > now_s

    try:
        await client.wait_for(lambda _: told(begun_s), TELLING_S)
        item = client.state.mission_current
    except TimeoutError:
        item = None
    state = client.state
    switch = DEFAULT_PAYLOAD if payload is None else parse_payload(payload)
    named = [(collect.seq, collect.roi) for collect in plan.collects_of(vehicle)]
    passes = passes_of(items, switch, state.autopilot)
    here = -1 if item is None else item
    skipped = tuple(name for run, name in zip(passes, named, strict=False) if run[-1] < here)
    cut = [name for run, name in zip(passes, named, strict=False) if run[0] < here <= run[-1]]
    behind = [run for run in passes if run[0] < here]
    again = lead_in(items, behind[0], passes, hovers=state.type == "multirotor") if behind else None
    return Replaced(state.mode, item, len(items), skipped, cut[0] if cut else None, again)
