"""Commands and reasons: each answer is of its command and the vehicle's state, failure has its status."""

from __future__ import annotations

import asyncio
from datetime import UTC, datetime, timedelta
from types import SimpleNamespace
from typing import cast

import httpx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.services.vehicles.flight_orders import _settled
from app.services.vehicles.order_book import Order
from app.services.vehicles.said import refusal, said_of
from app.services.vehicles.vehicle import Vehicle
from mavlink.sim.geodesy import Place
from mavlink.sim.settings import SimSettings
from mavlink.state.telemetry import StatusText, VehicleState
from mavlink.transfer.command import CommandOutcome, CommandResult
from mavlink.wire.items import Command
from tests.app.small_flight import in_flight, order, planned, ready, small_scenario
from tests.app.test_problems import check_problem
from tests.app.test_restart import flying
from tests.app.test_vehicles import connected, faulty_vehicle, listening, until
from tests.patience import PATIENCE_S

#: Texts of the firmwares, and the command each has to do with.
TEXTS = {
    "PreArm: Compass not calibrated": Command.COMPONENT_ARM_DISARM,
    "Arming denied! throttle not zero": Command.COMPONENT_ARM_DISARM,
    "Disarm denied: in flight": Command.COMPONENT_ARM_DISARM,
    "Mode change to AUTO failed: requires GPS position": Command.DO_SET_MODE,
    "Switching to mode Mission is currently not available": Command.DO_SET_MODE,
    "Battery 1 low 10.4V used 2200 mAh": None,
    "EKF3 IMU0 origin set": None,
    "RC Short Failsafe Cleared": None,
    "Terrain: no data": None,
}


@given(
    st.lists(st.tuples(st.sampled_from(list(TEXTS)), st.floats(0.0, 20.0)), max_size=12), st.floats(0.0, 20.0)
)
def test_texts_of_another_matter_or_time_are_no_reason(said: list[tuple[str, float]], begun_s: float) -> None:
    """Of all that was said only that of the command's matter, since the command, each once, in order."""
    state = VehicleState(texts=tuple(StatusText(at_s, 4, text) for text, at_s in said))
    arm = said_of(state, Command.COMPONENT_ARM_DISARM, begun_s)
    wanted = [t for t, at_s in said if at_s >= begun_s and TEXTS[t] == Command.COMPONENT_ARM_DISARM]
    assert list(arm) == list(dict.fromkeys(wanted))
    for text in said_of(state, Command.DO_SET_MODE, begun_s):
        assert TEXTS[text] in (Command.DO_SET_MODE, None)
        assert "Battery" not in text
        assert "Failsafe" not in text


@given(st.sampled_from([r for r in CommandResult if r != CommandResult.ACCEPTED]), st.booleans())
def test_a_refusal_says_code_and_state_in_words(result: CommandResult, landed: bool) -> None:
    """Whatever MAV_RESULT: no bare number, and how the vehicle stands."""
    state = VehicleState(armed=True, landed=landed, mode="AUTO")
    words = refusal(state, CommandOutcome(Command.COMPONENT_ARM_DISARM, result), 0.0)
    assert "COMPONENT_ARM_DISARM" in words
    assert "MAV_RESULT" not in words
    assert ("on the ground" if landed else "in the air") in words


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
async def test_in_flight_each_refusal_has_its_own_reason(client: httpx.AsyncClient, autopilot: str) -> None:
    """An item that is not there, a disarm, a new mission, a deletion: told apart, none a 200 in vain."""
    vehicle, report = await ready(client, autopilot, "fixed_wing", 5.0)
    count = len(report["parts"]["mission"]["held"])
    for seq in (count, 999, 60_000):
        refused = await order(client, vehicle, "goto_item", seq=seq)
        check_problem(refused, 409, "item-out-of-range")
        assert f"0 to {count - 1}" in refused.json()["reason"]
    # ArduPilot's home row begins the mission anew; PX4's first item is 0.
    assert (await order(client, vehicle, "goto_item", seq=0)).json()["outcome"] == "done"
    await in_flight(client, vehicle)
    check_problem(await client.delete(vehicle + "/mission"), 409, "in-flight")
    refused = await order(client, vehicle, "disarm")
    check_problem(refused, 409, "in-flight")
    assert "in the air" in refused.json()["reason"]
    check_problem(await client.delete(vehicle), 409, "in-flight")
    assert (await client.get(vehicle)).json()["state"]["armed"]
    went = await order(client, vehicle, "goto_item", seq=count - 2)
    assert went.status_code == 200, went.text
    plan_id = await planned(client, small_scenario(autopilot, "fixed_wing"))
    body = {"plan_id": plan_id, "override": True, "reason": "another strip"}
    told = (await client.post(vehicle + "/mission", json=body, timeout=PATIENCE_S)).json()["in_flight"]
    current = (await client.get(vehicle)).json()["state"]["mission_current"]
    assert told["mode"] == (await client.get(vehicle)).json()["state"]["mode"]
    if told["item"] is not None and told["item"] > count // 2:
        assert told["skipped"] == [{"seq": 1, "roi": "field"}]
        assert "skipped: pass 1 (field)" in told["message"]
    assert told["item"] is None or abs(told["item"] - current) <= 2
    assert (await client.delete(vehicle, params={"in_flight": "true"})).status_code == 204


async def test_without_a_mission_there_is_no_item(client: httpx.AsyncClient) -> None:
    """Whatever its number: refused unsent, and not left open."""
    vehicle = await connected(client)
    refused = await order(client, vehicle, "goto_item", seq=0)
    check_problem(refused, 409, "item-out-of-range")
    assert "no mission" in refused.json()["reason"]


async def test_the_loss_of_a_flights_link_is_an_event(impatient: httpx.AsyncClient) -> None:
    """When the vehicle was last heard stands in the flight's record."""
    scenario = small_scenario("ardupilot", "fixed_wing")
    start = next(f for f in scenario["features"] if f["properties"]["role"] == "start")
    lon_deg, lat_deg = start["geometry"]["coordinates"][:2]
    plan_id = await planned(impatient, scenario)
    settings = SimSettings(home=Place(lat_deg, lon_deg, 0.0), turn_radius_m=60.0)
    async with listening() as (link, url):
        connecting = asyncio.create_task(connected(impatient, url))
        while not (link.peers or connecting.done()):
            await asyncio.sleep(0.005)
        async with flying(link, settings):
            vehicle = await connecting
            sent = await impatient.post(vehicle + "/mission", json={"plan_id": plan_id}, timeout=PATIENCE_S)
            assert sent.json()["verified"], sent.text
            await in_flight(impatient, vehicle)
            body = await until(impatient, vehicle, lambda body: body["flight_id"] is not None)
            place = f"/api/v1/flights/{body['flight_id']}"
            assert (await impatient.get(place)).json()["link"] == []
        silent = datetime.now(UTC)
        record = await until(impatient, place, lambda flight: flight["link"])
        (event,) = record["link"]
        assert event["kind"] == "lost"
        assert abs(datetime.fromisoformat(event["at"]) - silent) < timedelta(seconds=2.4)
        assert event["time_s"] is not None
        check_problem(refused := await order(impatient, vehicle, "resume"), 409)
        assert "last heard" in refused.json()["detail"]
        assert "nothing is sent" in refused.json()["detail"]
        # What makes safe is sent all the same: it may hear what it does not answer.
        for stop in ("rtl", "hold", "sensor_off"):
            check_problem(unknown := await order(impatient, vehicle, stop), 504)
            assert unknown.json()["outcome"] == "unknown"
            assert "sent, but it was last heard" in unknown.json()["reason"]
        check_problem(await order(impatient, vehicle, "land"), 409, "vehicle-silent")
        await impatient.delete(vehicle, params={"in_flight": "true"})


@pytest.mark.parametrize("connected", [True, False])
@pytest.mark.parametrize("heard_s", [None, 4.0, 6.0])
@pytest.mark.parametrize("mode", ["AUTO", "RTL"])
async def test_without_an_answer_only_what_was_heard_since_proves_that_it_is_done(
    connected: bool, heard_s: float | None, mode: str
) -> None:
    """Neither what was known before, nor what would be so anyhow: an aircraft that stands need not return."""
    state = VehicleState(connected=connected, heard_s=heard_s, mode=mode, armed=False)
    client = SimpleNamespace(state=state, now_s=5.0, silent_s=1.0)

    async def unanswered() -> CommandOutcome:
        return CommandOutcome(Command.NAV_RETURN_TO_LAUNCH, None)

    told, reason = await _settled(
        cast(Vehicle, SimpleNamespace(client=client)),
        Order("rtl"),
        unanswered(),
        lambda state: state.mode == "RTL" or not state.armed,
        proves=lambda state: state.mode == "RTL",
    )
    assert told == ("done" if connected and heard_s == 6.0 and mode == "RTL" else "unknown")
    assert ("last heard" in reason) is not connected


async def test_a_sensor_that_nothing_shows_is_not_known_to_be_off(impatient: httpx.AsyncClient) -> None:
    """Its order was never answered, and nothing tells of it: a 504."""
    settings = SimSettings(faults=("no_command_ack",), sensor_reports=False)
    async with faulty_vehicle(impatient, settings) as vehicle:
        check_problem(answer := await order(impatient, vehicle, "sensor_off"), 504)
        assert answer.json()["outcome"] == "unknown"
