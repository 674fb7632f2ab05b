"""Whether a vehicle holds the mission last sent to it, and what shows it."""

from __future__ import annotations

from typing import Literal

from app.services.records import SentMission
from mavlink.station.client import VehicleClient
from mavlink.wire.items import MissionType

Standing = Literal["held", "differs", "unknown"]
Shown = Literal["read_back", "id"]


def standing_of(
    sent: SentMission, client: VehicleClient, found: bool | None
) -> tuple[Standing, Shown | None]:
    """What is known of a vehicle that is there, and whose mission is not being changed.

    A read-back tells, until the vehicle reports another id or falls silent; where there was none, its id
    is a first sign. Of one that gives no ids, or was not read, nothing is known.

    Parameters
    ----------
    found
        Whether reading back has shown the mission sent; None: it was not read back.
    """
    expected, reported = sent.list_id, client.state.mission_id
    if MissionType.MISSION in client.replaced:
        return "differs", "id"
    if found is not None:
        return ("held" if found else "differs"), "read_back"
    if expected is None or reported is None:
        return "unknown", None
    return ("held" if reported == expected else "differs"), "id"
