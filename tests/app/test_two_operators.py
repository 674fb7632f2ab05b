"""Two operators at one vehicle: what one does stands, the other is told, nothing half-done is called done."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
from pathlib import Path

import httpx
import pytest

from app.settings import Settings
from mavlink.sim.settings import SimSettings
from tests.app.deaf import deaf_vehicle
from tests.app.test_problems import check_problem
from tests.app.test_process import ROOT
from tests.app.test_restart import free_port, service
from tests.app.test_vehicles import VEHICLES, connected, faulty_vehicle, until
from tests.patience import PATIENCE_S

#: Nothing answers the announcement of a list: an upload that takes its time.
SLOW = SimSettings(faults=("no_response_to_count",))


async def uploading(client: httpx.AsyncClient, vehicle: str, plan_id: str) -> asyncio.Task[httpx.Response]:
    """An upload that has begun."""
    upload = asyncio.create_task(
        client.post(vehicle + "/mission", json={"plan_id": plan_id}, timeout=PATIENCE_S)
    )
    await until(client, vehicle, lambda body: body["operation"] is not None and body["upload"] is not None)
    return upload


async def test_orders_to_fly_wait_for_the_end_of_an_upload(client: httpx.AsyncClient, plan_id: str) -> None:
    """In mid-upload nobody arms or starts, uploads or clears; pause and return are taken at any time."""
    async with deaf_vehicle(client) as (vehicle, link):
        upload = await uploading(client, vehicle, plan_id)
        for command in ("arm", "start", "resume", "goto_item"):
            answer = await client.post(vehicle + "/commands", json={"command": command, "seq": 1})
            check_problem(answer, 409)
            assert f"upload of plan {plan_id}" in answer.text
        check_problem(await client.post(vehicle + "/mission", json={"plan_id": plan_id}), 409)
        check_problem(await client.delete(vehicle + "/mission"), 409)
        for command in ("pause", "rtl"):
            answer = await client.post(vehicle + "/commands", json={"command": command})
            assert (answer.status_code, answer.json()["outcome"]) == (200, "done"), answer.text
        link.hears = True
        assert (await upload).json()["verified"]
        assert (await client.post(vehicle + "/commands", json={"command": "arm"})).status_code == 200


async def test_an_upload_waits_for_the_answer_to_an_order_to_fly(
    client: httpx.AsyncClient, plan_id: str
) -> None:
    """While one operator's order is unanswered, the mission it is about is not exchanged by the other."""
    async with faulty_vehicle(client, SimSettings(faults=("no_command_ack",))) as vehicle:
        order = asyncio.create_task(
            client.post(vehicle + "/commands", json={"command": "arm"}, timeout=PATIENCE_S)
        )
        # Carried out, so it was given; the answer to it never comes.
        await until(client, vehicle, lambda body: body["state"]["armed"])
        refused = await client.post(vehicle + "/mission", json={"plan_id": plan_id})
        check_problem(refused, 409)
        assert "the order arm is not answered yet" in refused.text
        await client.delete(vehicle)
        await order


async def test_a_plan_deleted_in_mid_upload_is_uploaded_all_the_same(
    client: httpx.AsyncClient, plan_id: str
) -> None:
    """The vehicle got what was meant, so the answer says so, and the check behind it is made."""
    async with deaf_vehicle(client) as (vehicle, link):
        upload = await uploading(client, vehicle, plan_id)
        assert (await client.delete(f"/api/v1/plans/{plan_id}")).status_code == 204
        link.hears = True
        answer = await upload
        assert (answer.status_code, answer.json()["verified"]) == (200, True), answer.text
        assert answer.json()["preflight"] is not None


async def test_a_vehicle_let_go_in_mid_upload_leaves_the_outcome_unknown(
    client: httpx.AsyncClient, plan_id: str
) -> None:
    """Nobody can tell what it holds; it is gone, its name and address are free again."""
    async with faulty_vehicle(client, SLOW) as vehicle:
        upload = await uploading(client, vehicle, plan_id)
        url = (await client.get(vehicle)).json()["url"]
        assert (await client.delete(vehicle)).status_code == 204
        answer = await upload
        assert (answer.status_code, answer.json()["outcome"]) == (202, "unknown"), answer.text
        check_problem(await client.delete(vehicle), 404)
        assert await connected(client, url) != vehicle


async def test_a_vehicle_let_go_while_it_is_opened_is_told_at_once(client: httpx.AsyncClient) -> None:
    """The request that waits for its heartbeat ends with the reason, and the port is free."""
    body = {"name": "quiet", "url": f"udpin:127.0.0.1:{free_port()}", "timeout_s": 60}
    opening = asyncio.create_task(client.post(VEHICLES, json=body, timeout=PATIENCE_S))
    listed = await until(client, VEHICLES, lambda found: found["vehicles"])
    assert (await client.delete(f"{VEHICLES}/{listed['vehicles'][0]['id']}")).status_code == 204
    answer = await opening
    check_problem(answer, 409)
    assert "let go while it was being connected" in answer.text
    again = await client.post(VEHICLES, json=body | {"timeout_s": 0.1})
    assert again.status_code == 201, again.text


async def test_the_same_name_or_address_twice_at_once(client: httpx.AsyncClient) -> None:
    """Of two requests for one vehicle at the same moment one is refused."""
    body = {"name": "quiet", "url": f"udpin:127.0.0.1:{free_port()}", "timeout_s": 0.3}
    answers = await asyncio.gather(*(client.post(VEHICLES, json=body) for _ in range(2)))
    assert sorted(answer.status_code for answer in answers) == [201, 409]


async def test_a_recording_takes_no_upload(settings: Settings, tmp_path: Path, plan_file: Path) -> None:
    """What is replayed cannot be uploaded to: refused, named, the replay goes on."""
    from tests.app.conftest import stored

    recorded = settings.model_copy(update={"log_dir": tmp_path / "logs"})
    async with service(recorded) as client:
        async with faulty_vehicle(client, SimSettings()) as vehicle:
            await until(client, vehicle, lambda body: (body["state"]["time_s"] or 0.0) > 0.5)
            await client.delete(vehicle)
        (tlog,) = (tmp_path / "logs").rglob("*.tlog")
        # Slow: it is still playing when all is said.
        replay = await connected(client, f"replay:{tlog}?speedup=0.05")
        answer = await client.post(replay + "/mission", json={"plan_id": await stored(client, plan_file)})
        check_problem(answer, 409)
        assert "recording" in answer.text
        assert (await client.get(replay)).json()["connected"]


@pytest.mark.parametrize("what", ["opening", "upload"])
def test_the_end_of_the_service_answers_who_waits(tmp_path: Path, plan_file: Path, what: str) -> None:
    """SIGTERM while a vehicle is opened, or does not answer an upload: an answer, and no traceback."""
    command = [sys.executable, "-m", "tests.app.fake_server", str(tmp_path / "plans.db")]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, cwd=ROOT, stdout=pipe, stderr=pipe, text=True) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        try:
            answer = asyncio.run(
                _ended_meanwhile(process, process.stdout.readline().strip(), plan_file, what)
            )
        finally:
            process.terminate()
        told = process.stderr.read()
    if what == "opening":
        check_problem(answer, 409)
        assert "the service is ending" in answer.text
    else:
        assert (answer.status_code, answer.json()["outcome"]) == (202, "unknown"), answer.text
    assert "Traceback" not in told, told
    assert process.returncode in (0, -signal.SIGTERM)


async def _ended_meanwhile(
    process: subprocess.Popen[str], address: str, plan_file: Path, what: str
) -> httpx.Response:
    from tests.app.conftest import stored

    async with httpx.AsyncClient(base_url=address, timeout=PATIENCE_S) as client:
        if what == "opening":
            body = {"name": "quiet", "url": "udpin:127.0.0.1:0", "timeout_s": 60}
            waiting = asyncio.create_task(client.post(VEHICLES, json=body))
            await until(client, VEHICLES, lambda found: found["vehicles"])
        else:
            plan_id = await stored(client, plan_file)
            waiting = await uploading(
                client, await connected(client, "sim:?fault=no_response_to_count"), plan_id
            )
        os.kill(process.pid, signal.SIGTERM)
        return await waiting
