"""The client carries missions to a stub aircraft and back: refusals, lost words, read-back, vanishing."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import replace

import pytest

from mavlink.dialects.compare import Difference
from mavlink.errors import (
    BusyError,
    CodecError,
    NotConnectedError,
    TransferFailedError,
)
from mavlink.links.link import LinkFaults
from mavlink.transfer.machine import Progress
from mavlink.transfer.outcome import Accepted, Refused, Unknown
from mavlink.wire.items import Command, MissionItem, MissionResult, MissionType
from mavlink.wire.messages import Message
from tests.mavlink.station.aircraft import HASTY, LOST_AFTER_S, flying
from tests.mavlink.transfer.vehicle import waypoints
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.virtual_time

MISSION, FENCE = MissionType.MISSION, MissionType.FENCE


def compare(meant: tuple[MissionItem, ...], held: tuple[MissionItem, ...]) -> Sequence[Difference]:
    """Item by item, nothing forgiven."""
    if len(meant) != len(held):
        return [Difference(None, "count", len(meant), len(held))]
    pairs = zip(meant, held, strict=True)
    return [Difference(want.seq, "item", None, None) for want, got in pairs if want != got]


@pytest.mark.parametrize("manner", ["ardupilot", "px4"])
@pytest.mark.parametrize("mission_type", MissionType)
async def test_up_down_and_clear(manner: str, mission_type: MissionType) -> None:
    """What is uploaded comes back; cleared it is empty; progress rises to the end."""
    items = waypoints(30, mission_type)
    seen: list[Progress] = []
    async with flying(manner) as (client, aircraft):
        assert await client.upload(items, mission_type, seen.append) == Accepted()
        assert aircraft.vehicle.held[mission_type] == items
        assert await client.download(mission_type) == items
        assert await client.clear(mission_type) == Accepted()
        assert await client.download(mission_type) == ()
    assert [progress.done for progress in seen] == list(range(31))


async def test_over_a_bad_link() -> None:
    """A tenth lost, some doubled, some overtaken: it is stored in the end, and not said to be before."""
    faults = LinkFaults(loss=0.1, duplication=0.05, reordering=0.05, delay_s=0.002)
    patient = replace(HASTY, silence_s=5.0, acknowledgement_s=1.0)
    async with flying("px4", faults=faults, seed=3, settings=patient) as (client, aircraft):
        for _ in range(5):
            result = await client.upload_verified(waypoints(20), MISSION, compare)
            stored = aircraft.vehicle.held[0] == waypoints(20)
            assert stored or result.status != "stored"
            if result.status == "stored":
                break
        assert result.held == waypoints(20) == aircraft.vehicle.held[0]


async def test_one_transfer_at_a_time() -> None:
    """A second one is refused by name, and the first goes on."""
    async with flying() as (client, aircraft):
        first = asyncio.create_task(client.upload(waypoints(5), MISSION))
        await asyncio.sleep(0)
        with pytest.raises(BusyError):
            await client.download(MISSION)
        assert await first == Accepted()
        assert aircraft.vehicle.held[0] == waypoints(5)


async def test_a_cancelled_upload_tells_the_vehicle() -> None:
    """Cancelling the caller's task sends OPERATION_CANCELLED and frees the way for the next transfer."""
    async with flying() as (client, aircraft):
        task = asyncio.create_task(client.upload(waypoints(500), MISSION, lambda _: task.cancel()))
        with pytest.raises(asyncio.CancelledError):
            await task
        assert await client.upload(waypoints(3), MISSION) == Accepted()
        words = [message.fields["type"] for message in aircraft.heard if message.name == "MISSION_ACK"]
        assert words == [MissionResult.OPERATION_CANCELLED]


async def test_a_download_that_fails_says_how(monkeypatch: pytest.MonkeyPatch) -> None:
    """There is no partial answer: TransferFailedError carries the outcome."""
    async with flying() as (client, aircraft):
        await client.upload(waypoints(3), MISSION)
        real = aircraft.vehicle.receive

        def deaf(message: Message, now_s: float) -> list[Message]:
            return [] if message.name == "MISSION_REQUEST_INT" else real(message, now_s)

        monkeypatch.setattr(aircraft.vehicle, "receive", deaf)
        with pytest.raises(TransferFailedError, match="timeout") as caught:
            await client.download(MISSION)
        assert caught.value.outcome == Unknown("timeout", 0)


async def test_unsendable_items_are_refused_and_the_client_lives() -> None:
    """A number that does not fit its field is named, and the next upload works."""
    async with flying() as (client, _):
        with pytest.raises(CodecError, match="MISSION_ITEM_INT"):
            await client.upload((MissionItem(0, 3, 16, x=2**40),), MISSION)
        assert await client.upload(waypoints(2), MISSION) == Accepted()


async def test_a_lost_final_word_is_resolved_by_reading_back() -> None:
    """Unknown becomes accepted, because the vehicle holds what was meant; how it was found out is told."""
    async with flying() as (client, aircraft):
        aircraft.vehicle.lose_final = True
        result = await client.upload_verified(waypoints(4), MISSION, compare)
        assert (result.status, result.outcome, result.held) == ("stored", Accepted(), waypoints(4))
        assert result.resolved_from == Unknown("lost-acknowledgement", 3)
        assert not client.pending


@pytest.mark.parametrize("result", [r for r in MissionResult if r not in (0, 1, 13)])
async def test_a_refused_upload_says_what_the_vehicle_now_holds(result: MissionResult) -> None:
    """ArduPilot keeps the items before the refused one: the read-back shows the mixture."""
    async with flying() as (client, aircraft):
        await client.upload(waypoints(4), MISSION)
        aircraft.vehicle.refuse_item = {2: result}
        moved = tuple(replace(item, z=7.0) for item in waypoints(4))
        upload = await client.upload_verified(moved, MISSION, compare)
        assert (upload.status, upload.outcome) == ("refused", Refused(result, 2))
        assert upload.held == (*moved[:2], *waypoints(4)[2:])
        assert [difference.seq for difference in upload.differences] == [2, 3]


async def test_an_error_at_the_end_is_a_refusal_once_the_read_back_differs() -> None:
    """ERROR after the last item is ambiguous until it is seen that the list is not there."""
    async with flying("px4") as (client, aircraft):
        aircraft.vehicle.refuse_item = {3: MissionResult.ERROR}
        upload = await client.upload_verified(waypoints(4), MISSION, compare)
        assert (upload.status, upload.outcome, upload.held) == ("refused", Refused(MissionResult.ERROR), ())


async def test_a_fence_is_cleared_before_it_is_uploaded() -> None:
    """Circles over a stored polygon leave ArduPilot without any fence, though it accepts them."""
    async with flying() as (client, aircraft):
        result = await client.upload_verified(waypoints(3, FENCE), FENCE, compare)
        assert result.status == "stored"
        words = [
            message.name
            for message in aircraft.heard
            if message.name in ("MISSION_CLEAR_ALL", "MISSION_COUNT")
        ]
        assert words == ["MISSION_CLEAR_ALL", "MISSION_COUNT"]


async def test_a_vehicle_that_alters_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Accepted, yet different: the differences are listed."""
    async with flying() as (client, aircraft):
        real = aircraft.vehicle._commit

        def flatten(items: Sequence[MissionItem], kind: int) -> list[Message]:
            return real([replace(item, z=0.0) for item in items], kind)

        monkeypatch.setattr(aircraft.vehicle, "_commit", flatten)
        result = await client.upload_verified(waypoints(2), MISSION, compare)
        assert (result.outcome, result.status) == (Accepted(), "different")
        assert [difference.seq for difference in result.differences] == [0, 1]


@pytest.mark.parametrize(("vanish_at", "status"), [(9, "stored"), (4, "different")])
async def test_a_vehicle_that_vanishes_is_resolved_when_it_returns(vanish_at: int, status: str) -> None:
    """Lost in mid-upload the outcome is unknown with its reason; after the return the read-back decides."""
    async with flying(lost_after_s=LOST_AFTER_S) as (client, aircraft):
        aircraft.vanish_at_item = vanish_at
        result = await client.upload_verified(waypoints(10), MISSION, compare)
        assert (result.status, result.held) == ("unknown", None)
        assert isinstance(result.outcome, Unknown)
        await client.wait_for(lambda state: not state.connected, PATIENCE_S)
        assert client.pending
        with pytest.raises(NotConnectedError):
            await client.resolve_pending()
        aircraft.come_back()
        await client.wait_for(lambda state: state.connected, PATIENCE_S)
        resolved = await client.resolve_pending()
        assert resolved is not None
        assert resolved.status == status
        assert resolved.held == aircraft.vehicle.held[0] == waypoints(10)[: vanish_at + 1]
        assert not client.pending
        assert await client.resolve_pending() is None


async def test_losing_the_vehicle_ends_what_is_under_way() -> None:
    """A transfer ends as link-lost, a command without an answer, and both are refused until it returns."""
    async with flying(lost_after_s=LOST_AFTER_S) as (client, aircraft):
        aircraft.vanish()
        transfer = asyncio.create_task(client.upload(waypoints(3), MISSION))
        command = asyncio.create_task(client.command(Command.MISSION_START))
        assert await asyncio.wait_for(transfer, PATIENCE_S) == Unknown("link-lost")
        assert (await asyncio.wait_for(command, PATIENCE_S)).result is None
        with pytest.raises(NotConnectedError, match="no vehicle"):
            await client.clear(MISSION)


@pytest.mark.parametrize("how", ["upload", "clear", "broken off"])
async def test_a_number_of_items_told_while_they_change_counts_no_longer(
    how: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An autopilot counts those that have arrived by then; afterwards it is unknown until told anew."""
    async with flying() as (client, aircraft):
        assert (await client.upload(waypoints(5), MISSION)).kind == "accepted"
        answer = aircraft._answer

        async def told(message: Message) -> None:
            await aircraft.say("MISSION_CURRENT", seq=0, total=2)
            await answer(message)

        monkeypatch.setattr(aircraft, "_answer", told)
        if how == "broken off":
            aircraft.vanish_at_item = 3
        outcome = await (client.clear(MISSION) if how == "clear" else client.upload(waypoints(8), MISSION))
        assert outcome.kind == ("unknown" if how == "broken off" else "accepted")
        assert client.state.mission_current == 0
        assert client.state.mission_total is None
        monkeypatch.undo()
        aircraft.come_back()
        await aircraft.say("MISSION_CURRENT", seq=0, total=7)
        await client.wait_for(lambda state: state.mission_total == 8, PATIENCE_S)
