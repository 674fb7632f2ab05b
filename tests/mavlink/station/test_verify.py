"""What an upload does besides sending: clearing and waiting, where ArduPilot needs it."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import replace

import pytest

from mavlink.dialects.mission import numbered, placed
from mavlink.station.verify import upload_and_verify
from mavlink.transfer.machine import Progress
from mavlink.transfer.outcome import Accepted, Outcome
from mavlink.wire.items import Command, Frame, MissionItem, MissionType

pytestmark = pytest.mark.virtual_time

HERE = (8.5, 47.4)
CORNER = replace(placed(Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION, HERE, 0.0, Frame.GLOBAL), param1=3.0)
CIRCLE = replace(placed(Command.NAV_FENCE_CIRCLE_EXCLUSION, HERE, 0.0, Frame.GLOBAL), param1=250.0)
RETURN = placed(Command.NAV_FENCE_RETURN_POINT, HERE, 0.0, Frame.GLOBAL)
POINT = placed(Command.NAV_WAYPOINT, HERE, 50.0, Frame.GLOBAL)


class Obedient:
    """Takes everything and notes what it was told."""

    def __init__(self, told: list[str]) -> None:
        self.told = told
        self.held: tuple[MissionItem, ...] = ()

    async def upload(
        self,
        items: Sequence[MissionItem],
        mission_type: MissionType,
        progress: Callable[[Progress], None] | None = None,
    ) -> Outcome:
        self.told.append("upload")
        self.held = tuple(items)
        return Accepted()

    async def download(self, mission_type: MissionType) -> tuple[MissionItem, ...]:
        self.told.append("download")
        return self.held

    async def clear(self, mission_type: MissionType) -> Outcome:
        self.told.append("clear")
        return Accepted()


@pytest.mark.parametrize(
    ("kind", "items", "expected"),
    [
        (MissionType.MISSION, [POINT], "upload download"),
        (MissionType.FENCE, [CORNER] * 3, "clear upload download"),
        (MissionType.FENCE, [CIRCLE] * 3, "clear upload download"),
        (MissionType.FENCE, [], "clear upload download"),
        (MissionType.FENCE, [CIRCLE], "clear pause upload download"),
        (MissionType.FENCE, [CIRCLE, CIRCLE, RETURN], "clear pause upload download"),
    ],
)
async def test_a_fence_is_cleared_and_a_short_one_waits(
    monkeypatch: pytest.MonkeyPatch, kind: MissionType, items: list[MissionItem], expected: str
) -> None:
    """ArduPilot wipes a fence of fewer than three corners and circles that follows its clearing at once."""
    told: list[str] = []

    async def pause(seconds: float) -> None:
        assert seconds >= 0.2
        told.append("pause")

    monkeypatch.setattr(asyncio, "sleep", pause)
    vehicle = Obedient(told)
    result = await upload_and_verify(vehicle, numbered(items, kind), kind, lambda meant, held: (), None)
    assert (result.status, " ".join(told)) == ("stored", expected)
