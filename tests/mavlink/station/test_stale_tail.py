"""Power cut in mid-upload: the vehicle comes back with new items in front and old ones behind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest

from mavlink.dialects import dialect_for
from mavlink.dialects.compare import Difference, differences
from mavlink.wire.items import Frame, MissionItem, MissionType
from tests.mavlink.station.aircraft import LOST_AFTER_S, flying
from tests.mavlink.transfer.vehicle import StubVehicle, waypoints
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.virtual_time

PLANE = dialect_for("ardupilot", "fixed_wing")


def mission(count: int, altitude_m: float) -> tuple[MissionItem, ...]:
    """Waypoints as ArduPlane keeps them, told apart from others by their altitude alone."""
    return tuple(
        replace(
            item,
            frame=Frame.GLOBAL_RELATIVE_ALT,
            param1=0.0,
            param2=0.0,
            param3=0.0,
            param4=0.0,
            z=altitude_m,
        )
        for item in waypoints(count)
    )


def compare(meant: tuple[MissionItem, ...], held: tuple[MissionItem, ...]) -> Sequence[Difference]:
    """As the service compares for ArduPlane."""
    return differences(meant, held, PLANE)


async def test_the_old_missions_tail_is_found() -> None:
    """ArduPilot keeps the items it got; the read-back names each that is still the old mission's."""
    old, new = mission(12, 50.0), mission(10, 120.0)
    async with flying(lost_after_s=LOST_AFTER_S) as (client, aircraft):
        aircraft.vehicle.held[0] = old
        aircraft.vanish_at_item = 4
        cut = await client.upload_verified(new, MissionType.MISSION, compare)
        assert (cut.status, cut.held) == ("unknown", None)
        await client.wait_for(lambda state: not state.connected, PATIENCE_S)
        kept = aircraft.vehicle.held[0]
        assert kept == (*new[:5], *old[5:10])
        aircraft.vehicle = StubVehicle()  # started anew: the upload forgotten, the storage as it was
        aircraft.vehicle.held[0] = kept
        aircraft.come_back()
        await client.wait_for(lambda state: state.connected, PATIENCE_S)
        resolved = await client.resolve_pending()
        assert resolved is not None
        assert resolved.status == "different"
        assert [(d.seq, d.field, d.meant, d.held) for d in resolved.differences] == [
            (seq, "z", 120.0, 50.0) for seq in range(5, 10)
        ]
        again = await client.upload_verified(new, MissionType.MISSION, compare)
        assert (again.status, again.held) == ("stored", new)
