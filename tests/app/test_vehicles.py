"""Vehicles over HTTP: simulated aircraft, uploads with their outcomes, commands, flights."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import pty
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from app.main import create_app
from app.routers.bodies import EXAMPLE
from app.settings import Settings
from mavlink.links.tcp import open_tcp_server
from mavlink.links.udp import UdpLink, open_udp
from mavlink.sim import missions
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from tests.app.conftest import fake_house, serving, stored
from tests.app.test_problems import check_problem
from tests.app.test_restart import flying
from tests.patience import PATIENCE_S

VEHICLES = "/api/v1/vehicles"


async def until(client: httpx.AsyncClient, path: str, ready: Callable[[Any], bool]) -> Any:
    """What stands at a path once it is ready."""
    async with asyncio.timeout(PATIENCE_S):
        while not ready(body := (await client.get(path)).json()):
            await asyncio.sleep(0.02)
    return body


async def connected(client: httpx.AsyncClient, url: str = "sim:?speedup=100", name: str = "uav") -> str:
    """The place of a connected vehicle."""
    answer = await client.post(VEHICLES, json={"name": name, "url": url})
    assert answer.status_code == 201, answer.text
    assert answer.json()["connected"]
    return answer.headers["location"]


@asynccontextmanager
async def faulty_vehicle(client: httpx.AsyncClient, settings: SimSettings) -> AsyncIterator[str]:
    """The place of a vehicle that misbehaves on request."""
    async with listening() as (link, url):
        connecting = asyncio.create_task(connected(client, url))
        # It begins to speak when somebody listens, or the first heartbeat would be lost.
        while not (link.peers or connecting.done()):
            await asyncio.sleep(0.005)
        async with flying(link, settings):
            yield await connecting


@asynccontextmanager
async def listening() -> AsyncIterator[tuple[UdpLink, str]]:
    """A vehicle's link, and the address by which it can be called."""
    link = await open_udp("127.0.0.1", 0, listen=True)
    try:
        yield link, f"udpout:127.0.0.1:{link.local_port}"
    finally:
        await link.close()


@pytest.mark.parametrize(
    ("aircraft", "payload"),
    [
        ("autopilot=ardupilot", None),
        ("autopilot=px4&sensor_reports=no", "actuator:1"),
    ],
    ids=["reported", "actuator"],
)
async def test_whole_journey(client: httpx.AsyncClient, aircraft: str, payload: str | None) -> None:
    """Plan, connect, upload, fly, and see as flown what was planned, wherever its sensor shows."""
    record = (await client.post("/api/v1/plans", json=EXAMPLE, params={"wait": PATIENCE_S})).json()
    assert record["state"] == "done", record
    plan_id = record["id"]
    # Slow enough to be met in flight on a busy machine.
    vehicle = await connected(client, f"sim:?speedup=80&{aircraft}")
    answer = await client.post(
        vehicle + "/mission",
        json={"plan_id": plan_id, "parts": ["mission", "fence", "rally"], "payload": payload},
    )
    report = answer.json()
    assert answer.status_code == 200, report
    assert (report["outcome"], report["verified"]) == ("accepted", True)
    held = report["parts"]["mission"]["held"]
    assert len(held) == report["parts"]["mission"]["meant"] > 10
    assert (await client.get(vehicle)).json()["plan_id"] == plan_id
    assert (await client.get(vehicle + "/mission")).json()["parts"]["mission"] == held
    for command in ("arm", "start"):
        ordered = await client.post(vehicle + "/commands", json={"command": command})
        assert (ordered.status_code, ordered.json().get("outcome")) == (200, "done"), ordered.text
    await until(client, vehicle, lambda body: body["state"]["landed"] is False)
    reload = {"plan_id": plan_id}
    in_flight = await client.post(vehicle + "/mission", json=reload)
    check_problem(in_flight, 409, "vehicle-flying")
    flights = await until(
        client, "/api/v1/flights", lambda body: [each["state"] for each in body["flights"]] == ["ended"]
    )
    flight = flights["flights"][0]
    assert (flight["plan_id"], flight["plan_vehicle"]) == (plan_id, "uav-1")
    track = (await client.get(flight["links"]["track.geojson"])).json()
    roles = [feature["properties"]["role"] for feature in track["features"]]
    plan = (await client.get(f"/api/v1/plans/{plan_id}/plan.geojson")).json()
    collects = [f for f in plan["features"] if f["properties"]["role"] == "collect"]
    assert roles.count("track") == 1
    assert roles.count("sensor_on") == len(collects)
    line = track["features"][0]
    assert len(line["geometry"]["coordinates"]) == flight["points"] == len(line["properties"]["times_s"])
    seen = (await client.get(flight["links"]["coverage.geojson"])).json()
    assert set(seen["coverage"]) == {"harbour", "depot"}
    assert min(seen["coverage"].values()) > 0.99
    assert max(collect["cross_track_max_m"] for collect in seen["collects"]) < 10.0
    cleared = await client.delete(vehicle + "/mission")
    assert cleared.json()["parts"] == {"mission": "accepted"}
    assert (await client.get(vehicle)).json()["plan_id"] is None
    assert (await client.delete(vehicle)).status_code == 204
    check_problem(await client.get(vehicle), 404)


async def test_hard_violations_need_an_override(client: httpx.AsyncClient, plan_file: Path) -> None:
    """A plan that breaks a hard constraint goes up only with an override and its reason."""
    violation = {"constraint": "turn-radius", "feature": "uav-1", "message": "too tight", "amount": 1.0}
    violations = [violation | {"unit": "m", "where": None, "hard": True}]
    plan_id = await stored(client, plan_file, violations=violations)
    vehicle = await connected(client)
    check_problem(await client.post(vehicle + "/mission", json={"plan_id": plan_id}), 409, "turn-radius")
    unexplained = {"plan_id": plan_id, "override": True}
    check_problem(await client.post(vehicle + "/mission", json=unexplained), 422)
    explained = unexplained | {"reason": "the range is closed"}
    report = (await client.post(vehicle + "/mission", json=explained)).json()
    assert (report["outcome"], report["override_reason"]) == ("accepted", "the range is closed")
    assert [finding["rule"] for finding in report["findings"]] == ["turn-radius"]


async def test_a_mission_over_the_limit_is_refused_with_number_limit_and_fix(
    client: httpx.AsyncClient, plan_id: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a board that holds nine items: how many there are, how many are held, and in how many sorties."""
    vehicle = await connected(client, "sim:?autopilot=px4")
    body = {"plan_id": plan_id, "override": True, "reason": "a test"}
    monkeypatch.setattr("mavlink.dialects.px4.DEFAULT_MISSION_LIMIT", 9)
    answer = await client.post(vehicle + "/mission", json=body)
    check_problem(answer, 422, "too-many-items")
    (finding,) = [each for each in answer.json()["errors"] if each["rule"] == "too-many-items"]
    count = int(finding["message"].split()[0])
    assert finding["message"] == f"{count} items, the vehicle holds 9"
    assert f"at least {-(-count // 9)} sorties" in finding["fix"]


async def test_second_upload_at_once_is_refused(client: httpx.AsyncClient, plan_id: str) -> None:
    """Of two uploads at once the second is refused, and told of the first."""
    vehicle = await connected(client)
    answers = await asyncio.gather(
        *(client.post(vehicle + "/mission", json={"plan_id": plan_id}) for _ in range(2))
    )
    done, refused = sorted(answers, key=lambda answer: answer.status_code)
    assert done.status_code == 200, done.text
    check_problem(refused, 409)
    assert plan_id in refused.json()["detail"]


async def test_vanished_vehicle_leaves_unknown_until_read_back(
    impatient: httpx.AsyncClient, plan_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A vehicle that vanishes in mid-upload leaves the outcome unknown until it has been read back."""
    # Until it gives up the upload it lets nobody read.
    monkeypatch.setitem(missions._GIVE_UP_S, Flavour.ARDUPILOT, 2.0)
    client, plan_id = impatient, await stored(impatient, plan_file)
    settings = SimSettings(faults=("vanish_mid_upload",), vanish_for_s=3.5)
    async with faulty_vehicle(client, settings) as vehicle:
        answer = await client.post(vehicle + "/mission", json={"plan_id": plan_id})
        assert (answer.status_code, answer.json()["outcome"]) == (202, "unknown")
        record = (await client.get(vehicle)).json()
        assert record["pending"]
        assert record["plan_id"] is None
        record = await until(client, vehicle, lambda body: not body["pending"])
        assert record["upload"]["outcome"] == "different"
        assert record["upload"]["parts"]["mission"]["differences"]


@pytest.mark.parametrize(
    ("fault", "outcome", "verified"),
    [
        ("error_ack_at_1", "refused", False),
        ("altered_item", "different", False),
        ("no_final_ack", "accepted", True),
    ],
)
async def test_outcomes_are_told_as_they_are(
    impatient: httpx.AsyncClient, plan_file: Path, fault: str, outcome: str, verified: bool
) -> None:
    """Refusals, silent alterations and lost acknowledgements are told apart by reading back."""
    client, plan_id = impatient, await stored(impatient, plan_file)
    async with faulty_vehicle(client, SimSettings(faults=(fault,))) as vehicle:
        report = (await client.post(vehicle + "/mission", json={"plan_id": plan_id})).json()
        assert (report["outcome"], report["verified"]) == (outcome, verified)
        held = (await client.get(vehicle)).json()["plan_id"]
        assert held == (plan_id if verified else None)


async def test_commands_refused_by_the_vehicle_are_409(client: httpx.AsyncClient) -> None:
    """The vehicle's no is handed on with its reason; a missing item number is a 422."""
    async with faulty_vehicle(client, SimSettings(faults=("deny_arm",))) as vehicle:
        check_problem(await client.post(vehicle + "/commands", json={"command": "arm"}), 409)
        check_problem(
            await client.post(vehicle + "/commands", json={"command": "goto_item"}), 422, "seq-missing"
        )
        check_problem(await client.post(vehicle + "/commands", json={"command": "explode"}), 422)
        assert not (await client.get(vehicle)).json()["state"]["armed"]


@pytest.mark.parametrize(
    ("url", "status", "rule"),
    [
        ("nonsense", 422, "link-address"),
        ("http://127.0.0.1:1", 422, "link-address"),
        ("udpin:127.0.0.1:99999", 422, "link-address"),
        ("replay:?plan=x", 422, "link-address"),
        ("sim:?colour=red", 422, "sim-address"),
        ("sim:?airspeed=300", 422, "sim-address"),
        ("sim:?climb=-1e3", 422, "sim-address"),
        ("sim:?home=north", 422, "sim-address"),
        ("sim:?speedup=nan", 422, "sim-address"),
        ("sim:?autopilot=toy", 422, "sim-address"),
        ("sim:?airspeed=-1", 422, "sim-address"),
        ("udpin:127.0.0.1:port", 422, "link-address"),
        ("tcp:127.0.0.1:1", 409, None),
        ("serial:/dev/none:57600", 409, None),
    ],
)
async def test_bad_addresses(client: httpx.AsyncClient, url: str, status: int, rule: str | None) -> None:
    """Addresses that cannot be are refused, those that cannot be opened are a conflict; none stays listed."""
    check_problem(await client.post(VEHICLES, json={"name": "x", "url": url}), status, rule)
    assert (await client.get(VEHICLES)).json() == {"vehicles": []}


async def test_silent_vehicle_is_listed_and_takes_no_orders(client: httpx.AsyncClient, plan_id: str) -> None:
    """A vehicle nobody has heard is known, not connected, and cannot be uploaded to."""
    body = {"name": "quiet", "url": "udpin:127.0.0.1:0", "timeout_s": 0.1}
    answer = await client.post(VEHICLES, json=body)
    assert (answer.status_code, answer.json()["connected"]) == (201, False)
    vehicle = answer.headers["location"]
    check_problem(await client.post(vehicle + "/mission", json={"plan_id": plan_id}), 409)
    check_problem(await client.get(vehicle + "/mission"), 409)
    check_problem(await client.post(vehicle + "/commands", json={"command": "arm"}), 409)
    check_problem(await client.post(VEHICLES, json=body | {"url": "sim:"}), 409)


async def test_telemetry_streams_states_until_the_vehicle_is_let_go(client: httpx.AsyncClient) -> None:
    """Telemetry is a stream of states that ends with the vehicle."""
    vehicle = await connected(client)

    async def let_go() -> None:
        await asyncio.sleep(0.6)
        await client.delete(vehicle)

    streaming = asyncio.create_task(client.get(vehicle + "/telemetry"))
    await let_go()
    text = (await streaming).text
    states = [json.loads(line[6:]) for line in text.splitlines() if line.startswith("data: ")]
    assert len(states) > 1
    assert states[0]["state"]["autopilot"] == "ardupilot"


async def test_simulated_aircraft_ends_with_the_service(settings: Settings) -> None:
    """No simulator outlives the service."""
    app = create_app(settings, fake_house)
    async with serving(app) as client:
        await connected(client)
        (vehicle,) = app.state.house.fleet.all()
        simulator = vehicle._connection.simulator
    assert simulator._process.returncode is not None


async def test_failed_link_is_opened_anew(impatient: httpx.AsyncClient) -> None:
    """A vehicle whose TCP side goes away and comes back is connected again without anyone's help."""
    client = impatient
    link = await open_tcp_server("127.0.0.1", 0)
    port = link.local_port
    async with flying(link, SimSettings()):
        vehicle = await connected(client, f"tcp:127.0.0.1:{port}")
    await link.close()
    await until(client, vehicle, lambda body: not body["connected"])
    link = await open_tcp_server("127.0.0.1", port)
    async with flying(link, SimSettings()):
        await until(client, vehicle, lambda body: body["connected"])
    await link.close()


@pytest.mark.parametrize("autopilot", [Flavour.ARDUPILOT, Flavour.PX4])
async def test_a_vehicle_that_is_still_starting_is_not_uploaded_to(
    client: httpx.AsyncClient, plan_id: str, autopilot: Flavour
) -> None:
    """It would store nothing: refused with the reason, override or not, until it has started."""
    async with listening() as (link, url):
        async with flying(link, SimSettings(autopilot=autopilot, boot_s=3600.0)):
            vehicle = await connected(client, url)
            body = {"plan_id": plan_id, "override": True, "reason": "in a hurry"}
            refused = await client.post(vehicle + "/mission", json=body)
            check_problem(refused, 409, "vehicle-booting")
            assert "still starting" in refused.json()["detail"]
            assert (await client.get(vehicle)).json()["upload"] is None
        async with flying(link, SimSettings(autopilot=autopilot)):
            await until(client, vehicle, lambda body: not body["state"]["booting"])
            report = (await client.post(vehicle + "/mission", json={"plan_id": plan_id})).json()
            assert (report["outcome"], report["verified"]) == ("accepted", True)


class Modem:
    """The vehicle's end of a serial cable: the master of a pseudo-terminal, as a link."""

    def __init__(self, place: Path) -> None:
        self.url = f"serial:{place}:57600"
        self._master, slave = pty.openpty()
        place.unlink(missing_ok=True)
        place.symlink_to(os.ttyname(slave))
        os.close(slave)
        self._heard: asyncio.Queue[bytes] = asyncio.Queue()
        os.set_blocking(self._master, False)
        asyncio.get_running_loop().add_reader(self._master, self._read)

    def _read(self) -> None:
        with contextlib.suppress(OSError):  # nobody has the other end open
            self._heard.put_nowait(os.read(self._master, 4096))

    async def send(self, data: bytes) -> None:
        with contextlib.suppress(OSError):
            os.write(self._master, data)

    async def receive(self) -> bytes:
        return await self._heard.get()

    async def close(self) -> None:
        asyncio.get_running_loop().remove_reader(self._master)
        os.close(self._master)


@asynccontextmanager
async def plugged(modem: Modem) -> AsyncIterator[None]:
    """A simulated aircraft at the other end of the cable, until it is pulled."""
    async with flying(modem, SimSettings()):
        yield
    await modem.close()


async def test_a_serial_port_that_failed_is_opened_anew(
    client: httpx.AsyncClient, plan_id: str, tmp_path: Path
) -> None:
    """The cable of an armed one is pulled: it is lost, as told last; plugged in, it takes an upload."""
    place = tmp_path / "ttyRadio"
    modem = Modem(place)
    async with plugged(modem):
        vehicle = await connected(client, modem.url)
        armed = await client.post(vehicle + "/commands", json={"command": "arm", "hold_first": True})
        assert armed.json()["outcome"] == "done"
        before = await until(client, vehicle, lambda body: body["position_age_s"] is not None)
    place.unlink()
    gone = await until(client, vehicle, lambda body: body["link_failure"])
    assert (gone["url"], gone["connected"], gone["link"]["lost"]) == (modem.url, False, True)
    # It may be in the air: what was known of it is neither taken back nor thought to be of now.
    for key in ("armed", "mode", "type", "lat_deg", "lon_deg"):
        assert gone["state"][key] == before["state"][key], key
    older = await until(client, vehicle, lambda body: body["position_age_s"] > gone["position_age_s"])
    assert older["link"]["lost_since"] == gone["link"]["lost_since"]
    refused = await client.post(vehicle + "/commands", json={"command": "rtl"})
    check_problem(refused, 409)
    assert str(place) in refused.json()["detail"]
    check_problem(await client.post(vehicle + "/mission", json={"plan_id": plan_id}), 409)
    async with plugged(Modem(place)):
        back = await until(client, vehicle, lambda body: body["connected"])
        assert (back["link"]["lost"], back["state"]["armed"]) == (False, False)
        report = (await client.post(vehicle + "/mission", json={"plan_id": plan_id})).json()
        assert (report["outcome"], report["verified"]) == ("accepted", True)


async def test_json_sent_as_a_form_is_told_its_header(client: httpx.AsyncClient) -> None:
    """A body that curl sends with -d alone is refused with the header it lacks."""
    headers = {"Content-Type": "application/x-www-form-urlencoded"}
    answer = await client.post(VEHICLES, content='{"name": "x", "url": "sim:"}', headers=headers)
    check_problem(answer, 422)
    assert "Content-Type: application/json" in answer.json()["errors"][0]["fix"]


@pytest.mark.parametrize("name", ["", "  ", "a\0b", "a\x1b[2J", "a\r\nX-Y: z", "\x7f"])
async def test_a_name_that_cannot_be_shown_is_refused(client: httpx.AsyncClient, name: str) -> None:
    """Names stand in logs, terminals and files: blank ones and control characters are a 422."""
    check_problem(await client.post(VEHICLES, json={"name": name, "url": "sim:"}), 422)
    assert (await client.get(VEHICLES)).json()["vehicles"] == []
