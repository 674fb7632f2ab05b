"""When a flight begins and ends, and what is kept of it."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Sequence
from dataclasses import replace
from typing import Any

import pytest

from app.services.errors import ServiceError, StorageError
from app.services.records import TrackSample
from app.services.store.database import Database
from app.services.store.flights import FlightStore
from app.services.vehicles.recorder import LANDED_LOOKS, FlightRecorder, HeldPlan, is_flying
from app.settings import Settings
from mavlink.links.link import memory_pair
from mavlink.state.outputs import RelayOutput
from mavlink.state.telemetry import VehicleState
from mavlink.state.track import TrackRecorder
from mavlink.station.client import VehicleClient
from tests.mavlink.state.test_outputs import received
from tests.mavlink.state.test_telemetry import at

PLAN = HeldPlan("plan-1", "uav-1", "relay:2", RelayOutput(2))
GROUND = VehicleState(connected=True, armed=False, landed=True)
FLIGHT = replace(GROUND, armed=True, landed=False)


class Client(VehicleClient):
    """A client whose state is what a test says, and whose recorders hear what a test tells."""

    def __init__(self) -> None:
        super().__init__(memory_pair()[0])
        self.told = GROUND
        self.recorders: list[TrackRecorder] = []
        self.ended: str | None = None

    @property
    def state(self) -> VehicleState:
        return self.told

    @property
    def failure(self) -> str | None:
        return self.ended

    def start_recording(self, output: object = None, in_gimbal: bool = False) -> TrackRecorder:
        assert output is None or isinstance(output, RelayOutput)
        self.recorders.append(TrackRecorder(output))
        return self.recorders[-1]

    def stop_recording(self, recorder: TrackRecorder) -> None:
        self.recorders.remove(recorder)

    def hear(self, second: int) -> None:
        """A position, a moment after the relay was reported closed."""
        state = replace(self.told, time_s=float(second), lon_deg=8.0, lat_deg=47.0)
        state = replace(state, altitude_amsl_m=500.0, relative_altitude_m=100.0)
        for recorder in self.recorders:
            recorder.take(received("RELAY_STATUS", time_boot_ms=1000 * second, on=0b100, present=0xFF), state)
            recorder.take(at(1000 * second), state)

    def photograph(self, index: int) -> None:
        """A photo was taken."""
        for recorder in self.recorders:
            recorder.take(received("CAMERA_FEEDBACK", img_idx=index, lat=1, lng=1), self.told)


@pytest.fixture
async def store(settings: Settings) -> AsyncIterator[FlightStore]:
    """Flights in a database of their own."""
    database = Database(settings.database)
    await database.open()
    yield FlightStore(database)
    await database.close()


@pytest.fixture
def recorder(store: FlightStore) -> FlightRecorder:
    """The recorder of one vehicle."""
    return FlightRecorder(store, "vehicle", "uav", 0.0)


async def test_a_flight_is_from_the_take_off_to_the_landing(
    recorder: FlightRecorder, store: FlightStore
) -> None:
    """Armed on the ground is none yet; the plan, its payload and the relay's state are kept with it."""
    client = Client()
    for state in (GROUND, replace(GROUND, armed=True)):
        client.told = state
        await recorder.look(client, PLAN)
        assert recorder.flight_id is None
    client.told = FLIGHT
    await recorder.look(client, PLAN)
    flight_id = recorder.flight_id
    assert flight_id is not None
    for second in range(3):
        client.hear(second)
    client.told = replace(GROUND, armed=False)
    await recorder.look(client, PLAN)
    assert recorder.flight_id is None
    assert client.recorders == []
    record = await store.get(flight_id)
    assert (record.state, record.plan_id, record.payload) == ("ended", "plan-1", "relay:2")
    samples = await store.track(flight_id)
    assert [(sample.time_s, sample.sensor_on) for sample in samples] == [
        (0.0, True),
        (1.0, True),
        (2.0, True),
    ]


async def test_a_flight_looked_at_late_has_its_beginning(
    recorder: FlightRecorder, store: FlightStore
) -> None:
    """All since the last look on the ground is kept, and no more, with the switch thrown meanwhile."""
    client = Client()
    for second in range(3):
        client.hear(second)
        await recorder.look(client, PLAN)
    client.told = FLIGHT
    client.recorders[0].take(received("RELAY_STATUS", time_boot_ms=2500, on=0, present=0xFF), FLIGHT)
    for second in range(3, 6):
        client.hear(second)
    await recorder.look(client, PLAN)
    flight_id = recorder.flight_id
    assert flight_id is not None
    client.hear(6)
    await recorder.end("ended")
    assert client.recorders == []
    assert [sample.time_s for sample in await store.track(flight_id)] == [3.0, 4.0, 5.0, 6.0]
    assert [(event.kind, event.time_s) for event in await store.events(flight_id)] == [
        ("off", 2.5),
        ("on", 3.0),
    ]


async def test_nothing_is_missed_between_two_plans_in_flight(slow: SlowStore) -> None:
    """What comes while the first flight is being stored belongs to the second."""
    recorder, client = FlightRecorder(slow, "vehicle", "uav", 0.0), Client()
    client.told = FLIGHT
    await recorder.look(client, PLAN)
    first = recorder.flight_id
    client.hear(1)
    slow.wait_s = 0.1
    looking = asyncio.create_task(recorder.look(client, HeldPlan("plan-2", "uav-1")))
    await asyncio.sleep(0)
    client.hear(2)
    await looking
    second = recorder.flight_id
    assert first is not None
    assert second not in (None, first)
    await recorder.end("ended")
    assert [sample.time_s for sample in await slow.track(str(second))] == [2.0]


async def test_a_bounce_is_no_landing(recorder: FlightRecorder) -> None:
    """On the ground for a moment only, then in the air again: one flight. On the ground for long: its end."""
    client = Client()
    client.told = FLIGHT
    await recorder.look(client, PLAN)
    flight_id = recorder.flight_id
    for _ in range(2):
        for landed in (True,) * (LANDED_LOOKS - 1) + (False,):
            client.told = replace(FLIGHT, landed=landed)
            await recorder.look(client, PLAN)
            assert recorder.flight_id == flight_id
    client.told = replace(FLIGHT, landed=True)
    for _ in range(LANDED_LOOKS):
        await recorder.look(client, PLAN)
    assert recorder.flight_id is None


async def test_hovering_and_silence_are_no_landing(recorder: FlightRecorder, store: FlightStore) -> None:
    """A vehicle that never says whether it has landed flies until it disarms; one that is lost, on and on."""
    client = Client()
    moving = replace(FLIGHT, landed=None, ground_speed_m_s=8.0)
    for state in (moving, replace(moving, ground_speed_m_s=0.0), replace(moving, connected=False)):
        client.told = state
        await recorder.look(client, None)
        assert recorder.flight_id is not None
    flight_id = recorder.flight_id
    client.ended = "the port is gone"
    await recorder.look(client, None)
    assert flight_id is not None
    assert (await store.get(flight_id)).state == "interrupted"
    assert not is_flying(replace(moving, ground_speed_m_s=0.0))


async def test_another_plan_in_flight_is_another_flight(recorder: FlightRecorder, store: FlightStore) -> None:
    """Each flight is judged by the plan it followed; while a plan is being replaced the old one goes on."""
    client = Client()
    client.told = FLIGHT
    await recorder.look(client, PLAN)
    first = recorder.flight_id
    client.hear(1)
    await recorder.look(client, None)
    assert recorder.flight_id == first
    await recorder.look(client, HeldPlan("plan-2", "uav-1"))
    second = recorder.flight_id
    assert first is not None
    assert second is not None
    assert second != first
    client.hear(2)
    await recorder.end("ended")
    assert [sample.time_s for sample in await store.track(first)] == [1.0]
    assert [sample.time_s for sample in await store.track(second)] == [2.0]
    assert (await store.get(second)).plan_id == "plan-2"


@pytest.mark.parametrize(("payload", "told"), [("trigger:video", None), (None, True)])
async def test_relays_tell_of_a_sensor_alone_that_nobody_named(
    recorder: FlightRecorder, store: FlightStore, payload: str | None, told: bool | None
) -> None:
    """A relay that closes says nothing of a video; where no payload is known it may be the sensor's."""
    client, plan = Client(), HeldPlan("plan-1", "uav-1", payload)
    client.told = FLIGHT
    await recorder.look(client, plan)
    client.recorders[0].take(received("RELAY_STATUS", time_boot_ms=0, on=0, present=0xFF), FLIGHT)
    client.hear(1)
    flight_id = recorder.flight_id
    await recorder.end("ended")
    assert flight_id is not None
    assert [sample.sensor_on for sample in await store.track(flight_id)] == [told]


async def test_a_flight_that_cannot_be_stored_is_tried_again(
    recorder: FlightRecorder, store: FlightStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No recorder is left behind by a database that fails."""
    client = Client()
    client.told = FLIGHT
    with monkeypatch.context() as broken:

        async def fail(*_: object) -> str:
            raise ServiceError("no room")

        broken.setattr(store, "begin", fail)
        for _ in range(3):
            with pytest.raises(ServiceError):
                await recorder.look(client, PLAN)
    assert client.recorders == []
    await recorder.look(client, PLAN)
    assert recorder.flight_id is not None


class FullStore(FlightStore):
    """A database that takes nothing while it is full."""

    full = False

    def _take(self) -> None:
        if self.full:
            raise StorageError("no room")

    async def begin(self, *what: Any, **named: Any) -> str:
        self._take()
        return await super().begin(*what, **named)

    async def add(self, *what: Any) -> None:
        self._take()
        await super().add(*what)

    async def add_events(self, *what: Any) -> None:
        self._take()
        await super().add_events(*what)

    async def end(self, *what: Any) -> None:
        self._take()
        await super().end(*what)


@pytest.mark.parametrize("full", [(0, 3), (2, 5), (4, 9), (5, 7), (8, 10), (0, 4), (3, 4)])
async def test_a_full_disk_costs_nothing_of_a_flight(settings: Settings, full: tuple[int, int]) -> None:
    """Whenever the database takes nothing for a while, the flight is stored whole once it does."""
    database = Database(settings.database)
    await database.open()
    store = FullStore(database)
    recorder = FlightRecorder(store, "vehicle", "uav", 0.0)
    client = Client()
    await recorder.look(client, PLAN)
    client.told = FLIGHT
    for second in range(8):
        store.full = full[0] <= second < full[1]
        client.hear(second)
        client.photograph(second)
        await recorder.look(client, PLAN)
    client.told = GROUND
    for second in range(8, 12):
        store.full = full[0] <= second < full[1]
        await recorder.look(client, PLAN)
    (flight,) = await FlightStore(database).newest(10, 0, None)
    assert flight.state == "ended"
    assert [sample.time_s for sample in await store.track(flight.id)] == [float(s) for s in range(8)]
    assert [event.index for event in await store.events(flight.id)] == list(range(8))
    await database.close()


class SlowStore(FlightStore):
    """A database that is busy with something else when it is first asked to write."""

    wait_s = 0.1

    async def _turn(self) -> None:
        wait_s, self.wait_s = self.wait_s, 0.0
        await asyncio.sleep(wait_s)

    async def begin(self, *what: Any, **named: Any) -> str:
        await self._turn()
        return await super().begin(*what, **named)

    async def add(self, flight_id: str, samples: Sequence[TrackSample]) -> None:
        await self._turn()
        await super().add(flight_id, samples)


@pytest.fixture
async def slow(settings: Settings) -> AsyncIterator[SlowStore]:
    """The same, slower."""
    database = Database(settings.database)
    await database.open()
    yield SlowStore(database)
    await database.close()


async def test_a_link_lost_while_the_track_is_saved_loses_none_of_it(slow: SlowStore) -> None:
    """The flight ends after what is being saved has been: places in order, switches with their flight."""
    recorder, client = FlightRecorder(slow, "vehicle", "uav", 0.0), Client()
    client.told = FLIGHT
    await recorder.look(client, PLAN)
    flight_id = recorder.flight_id
    assert flight_id is not None
    client.hear(0)
    client.recorders[0].take(received("RELAY_STATUS", time_boot_ms=500, on=0, present=0xFF), FLIGHT)
    slow.wait_s = 0.1
    looking = asyncio.create_task(recorder.look(client, PLAN))
    await asyncio.sleep(0)
    client.hear(1)
    await asyncio.gather(looking, recorder.end("interrupted"))
    assert [sample.time_s for sample in await slow.track(flight_id)] == [0.0, 1.0]
    assert [event.kind for event in await slow.events(flight_id)] == ["off", "on"]
    assert (await slow.get(flight_id)).state == "interrupted"


async def test_a_flight_that_begins_as_its_link_is_lost_is_closed(slow: SlowStore) -> None:
    """No flight is left open that nothing more is heard of, and none begins on a link that has failed."""
    recorder, client = FlightRecorder(slow, "vehicle", "uav", 0.0), Client()
    client.told = FLIGHT
    looking = asyncio.create_task(recorder.look(client, PLAN))
    await asyncio.sleep(0)
    client.ended = "reset by peer"
    await asyncio.gather(looking, recorder.end("interrupted"))
    assert (recorder.flight_id, client.recorders) == (None, [])
    await recorder.look(client, PLAN)
    assert recorder.flight_id is None
    assert [flight.state for flight in await slow.newest(9, 0, None)] == ["interrupted"]


async def test_each_sortie_is_a_flight_of_its_own(recorder: FlightRecorder, store: FlightStore) -> None:
    """The mission of the next sortie, uploaded between two flights, is what the second is held against."""
    client = Client()
    kept = []
    for sortie in (1, 2):
        client.told = FLIGHT
        await recorder.look(client, replace(PLAN, sortie=sortie))
        assert recorder.flight_id is not None
        kept.append(recorder.flight_id)
        client.hear(sortie)
        client.told = GROUND
        await recorder.look(client, replace(PLAN, sortie=sortie))
    assert [(await store.get(flight_id)).plan_sortie for flight_id in kept] == [1, 2]
