"""Ids of lists: first signs of what a vehicle holds, which never decide."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence

import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from mavlink.state.telemetry import VehicleState
from mavlink.station.client import VehicleClient
from mavlink.station.list_ids import ListIds
from mavlink.transfer.outcome import Accepted, Unknown
from mavlink.wire.codec import Codec
from mavlink.wire.items import MissionItem, MissionType
from mavlink.wire.messages import Message
from tests.mavlink.station.aircraft import Aircraft, flying
from tests.mavlink.station.test_client_transfers import compare
from tests.mavlink.transfer.vehicle import waypoints
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.virtual_time

MISSION, FENCE = MissionType.MISSION, MissionType.FENCE
OTHER = 0x0BADCAFE


async def report(aircraft: Aircraft, client: VehicleClient, times: int = 1, **ids: int) -> None:
    """Have the vehicle tell its ids, as it does every second, and wait until the client has heard it."""
    told = {"mission_id": aircraft.vehicle.ids[0], "fence_id": aircraft.vehicle.ids[1], **ids}
    for _ in range(times):
        await aircraft.say("MISSION_CURRENT", seq=1, total=4, **told)
    await client.wait_for(lambda state: state.mission_id == (told["mission_id"] or None), PATIENCE_S)
    await asyncio.sleep(0.01)


def warnings(state: VehicleState) -> list[str]:
    return [text.text for text in state.texts if "uploaded from here" in text.text]


async def test_another_mission_is_told_of() -> None:
    """The vehicle reports another id than that of our upload, twice: warned once, with both ids."""
    async with flying("px4") as (client, aircraft):
        assert (await client.upload_verified(waypoints(4), MISSION, compare)).status == "stored"
        ours = aircraft.vehicle.ids[0]
        await report(aircraft, client, times=3)
        assert client.replaced == frozenset()
        await report(aircraft, client, mission_id=OTHER)
        assert client.replaced == frozenset()
        await report(aircraft, client, times=3, mission_id=OTHER)
        assert client.replaced == {MISSION}
        (warning,) = warnings(client.state)
        assert "another mission" in warning
        assert f"{OTHER:08x}" in warning
        assert f"{ours:08x}" in warning
        await report(aircraft, client, times=2)
        assert client.replaced == frozenset()


async def test_another_mission_is_noticed_on_return() -> None:
    """While the vehicle was away somebody else gave it a mission: known from its first reports."""
    async with flying("px4", lost_after_s=0.6) as (client, aircraft):
        await client.upload_verified(waypoints(4), MISSION, compare)
        await report(aircraft, client)
        aircraft.vanish()
        await client.wait_for(lambda state: not state.connected, PATIENCE_S)
        aircraft.vehicle.held[0], aircraft.vehicle.ids[0] = waypoints(2), OTHER
        aircraft.come_back()
        await client.wait_for(lambda state: state.connected, PATIENCE_S)
        await report(aircraft, client, times=2)
        assert client.replaced == {MISSION}
        # The sign is true: what it holds is not ours, and a fresh upload cures it.
        assert await client.download(MISSION) == waypoints(2)
        assert (await client.upload_verified(waypoints(4), MISSION, compare)).status == "stored"
        await report(aircraft, client, times=3)
        assert client.replaced == frozenset()


async def test_a_mission_gone_is_told_of() -> None:
    """An id that was ours and is no more: cleared by somebody else."""
    async with flying("px4") as (client, aircraft):
        await client.upload_verified(waypoints(4), MISSION, compare)
        await report(aircraft, client)
        await report(aircraft, client, times=2, mission_id=0)
        assert client.replaced == {MISSION}
        assert "no longer holds" in warnings(client.state)[0]


async def test_a_vehicle_that_numbers_no_lists_draws_no_warning() -> None:
    """ArduPilot sends 0 for every id: nothing is concluded from it."""
    async with flying("ardupilot") as (client, aircraft):
        result = await client.upload_verified(waypoints(4), MISSION, compare)
        assert result.status == "stored"
        await report(aircraft, client, times=4)
        assert (client.replaced, client.state.mission_id) == (frozenset(), None)


def test_an_id_that_is_never_reported_draws_no_warning() -> None:
    """A vehicle that gives an id with its acknowledgement alone has lost nothing."""
    ids, state = ListIds(), VehicleState()
    ids.sent(MISSION, Accepted(), OTHER, state)
    for now_s in range(4):
        state = ids.watched(state, Message("MISSION_CURRENT", {"seq": 1}), float(now_s))
    assert ids.replaced == frozenset()
    assert state.texts == ()


async def test_our_own_clearing_and_uploads_draw_no_warning() -> None:
    """What was known of a list ends with the next order about it; other lists keep theirs."""
    async with flying("px4") as (client, aircraft):
        await client.upload_verified(waypoints(4), MISSION, compare)
        await client.upload_verified(waypoints(3, FENCE), FENCE, compare)
        await report(aircraft, client, times=2)
        await client.clear(MISSION)
        await report(aircraft, client, times=3)
        assert client.replaced == frozenset()
        await report(aircraft, client, times=2, fence_id=OTHER)
        assert client.replaced == {FENCE}
        assert "another fence" in warnings(client.state)[0]


@pytest.mark.parametrize("same", [False, True])
async def test_ids_that_mismatch_decide_nothing(monkeypatch: pytest.MonkeyPatch, same: bool) -> None:
    """The acknowledgement's id is not that of the list read back: the items alone say what is held."""
    async with flying("px4") as (client, aircraft):
        real = aircraft.vehicle._commit

        def another(items: Sequence[MissionItem], kind: int) -> list[Message]:
            answers = real(items, kind)
            aircraft.vehicle.ids[kind] = OTHER
            if not same:
                aircraft.vehicle.held[kind] = waypoints(2)
            return answers

        monkeypatch.setattr(aircraft.vehicle, "_commit", another)
        result = await client.upload_verified(waypoints(4), MISSION, compare)
        assert result.status == ("stored" if same else "different")
        await report(aircraft, client, times=3)
        # Read back as meant, the id of the list read back is the one that counts.
        assert client.replaced == (frozenset() if same else {MISSION})


async def test_a_lost_last_word_shows_first_in_the_id() -> None:
    """Unknown, with the sign that the id has changed; the read-back then decides, here for stored."""
    async with flying("px4") as (client, aircraft):
        aircraft.vehicle.held[0], aircraft.vehicle.ids[0] = waypoints(2), OTHER
        await report(aircraft, client)
        aircraft.vehicle.lose_final = True
        upload = asyncio.create_task(client.upload(waypoints(4), MISSION))
        while aircraft.vehicle.held[0] != waypoints(4):
            await asyncio.sleep(0.01)
        await report(aircraft, client)
        outcome = await upload
        assert outcome == Unknown("lost-acknowledgement", 3, sign="changed")
        assert "seems to hold a new list" in str(outcome)
        result = await client.upload_verified(waypoints(4), MISSION, compare)
        assert (result.status, result.outcome) == ("stored", Accepted())
        assert result.resolved_from == Unknown("lost-acknowledgement", 3, sign="unchanged")


async def test_a_sign_does_not_make_a_read_back_unneeded(monkeypatch: pytest.MonkeyPatch) -> None:
    """The id has changed, but to that of something else: read back, it is different."""
    async with flying("px4") as (client, aircraft):
        aircraft.vehicle.held[0], aircraft.vehicle.ids[0] = waypoints(2), OTHER
        await report(aircraft, client)
        real = aircraft.vehicle._commit

        def other(items: Sequence[MissionItem], kind: int) -> list[Message]:
            real(waypoints(3), kind)
            return []

        monkeypatch.setattr(aircraft.vehicle, "_commit", other)
        upload = asyncio.create_task(client.upload_verified(waypoints(4), MISSION, compare))
        while aircraft.vehicle.held[0] != waypoints(3):
            await asyncio.sleep(0.01)
        await report(aircraft, client)
        result = await upload
        assert result.status == "different"
        assert result.outcome == Unknown("lost-acknowledgement", 3, sign="changed")


@pytest.mark.parametrize(
    ("name", "place", "ids"),
    [
        ("MISSION_ACK", 4, {"opaque_id": 0xDEADBEEF}),
        ("MISSION_COUNT", 5, {"opaque_id": 0xDEADBEEF}),
        ("MISSION_CURRENT", 6, {"mission_id": 0xA0000001, "fence_id": 0xB0000002, "rally_points_id": 3}),
    ],
)
def test_ids_stand_behind_the_fields_pymavlink_knows(name: str, place: int, ids: dict[str, int]) -> None:
    """At the bytes of common.xml, read back as sent, whole frames to pymavlink; none where they are 0."""
    frame = Codec(1, 1).pack(Message(name, dict(ids)))
    wire = b"".join(value.to_bytes(4, "little") for value in ids.values())
    assert frame[10 + place : -2] == wire.rstrip(b"\0")
    (read,) = Codec().feed(frame)
    assert {key: read.fields[key] for key in ids} == ids
    (theirs,) = dialect.MAVLink(None).parse_buffer(frame)
    assert theirs.get_type() == name
    assert Codec(1, 1).pack(Message(name, dict.fromkeys(ids, 0))) == Codec(1, 1).pack(Message(name))
