"""What is ordered of vehicles is written before it is sent, and completed; what a crash left is resolved."""

from __future__ import annotations

import asyncio
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import httpx
import pytest

from app.services.store import database as databases
from app.services.vehicles import audit
from app.settings import Settings
from mavlink.station.client import VehicleClient
from tests.app.conftest import stored
from tests.app.small_flight import order
from tests.app.test_problems import check_problem
from tests.app.test_restart import VEHICLES, add, autopilot, free_port, service, until
from tests.app.test_storage import held
from tests.app.test_vehicles import connected
from tests.patience import PATIENCE_S

AUDIT = "/api/v1/audit"


async def entries(
    client: httpx.AsyncClient, ready: Callable[[list[dict[str, Any]]], bool], **which: Any
) -> list[dict[str, Any]]:
    """Entries, the newest first, once they are as they should be."""
    async with asyncio.timeout(PATIENCE_S):
        while not ready(found := (await client.get(AUDIT, params=which)).json()["entries"]):
            await asyncio.sleep(0.05)
    return found


def settled(found: list[dict[str, Any]]) -> bool:
    """Whether nothing is pending."""
    return bool(found) and all(entry["outcome"] != "pending" for entry in found)


async def test_all_that_is_ordered_is_there_with_its_outcome(
    client: httpx.AsyncClient, plan_file: Path
) -> None:
    """Upload, override, orders done and refused, clearing: each once, by kind, vehicle and time."""
    violation = {"constraint": "turn-radius", "feature": "uav-1", "message": "too tight", "amount": 1.0}
    violations = [violation | {"unit": "m", "where": None, "hard": True}]
    plan_id = await stored(client, plan_file, violations=violations)
    vehicle = await connected(client)
    body = {"plan_id": plan_id, "override": True, "reason": "a test of the audit"}
    assert (await client.post(vehicle + "/mission", json=body)).json()["outcome"] == "accepted"
    await order(client, vehicle, "resume")
    await order(client, vehicle, "arm")
    await client.delete(vehicle + "/mission", params={"part": ["mission", "fence"]})
    found = await entries(client, settled)
    assert [(entry["kind"], entry["outcome"]) for entry in reversed(found)] == [
        ("upload", "accepted"),
        ("override", "accepted"),
        ("order", "refused"),
        ("order", "done"),
        ("clear", "accepted"),
    ]
    assert {entry["actor"] for entry in found} == {"local"}
    assert found[3]["what"]["reason"] == "a test of the audit"
    assert found[2]["what"] == {"command": "resume"}
    assert "not armed" in found[2]["reason"]
    assert all(entry["at"] <= entry["ended_at"] for entry in found)
    orders = (await client.get(AUDIT, params={"kind": "order", "limit": 1})).json()
    assert (orders["total"], orders["entries"]) == (2, [found[1]])
    since = {"since": found[2]["at"], "until": found[0]["at"]}
    assert (await client.get(AUDIT, params=since)).json()["entries"] == found[1:3]
    assert (await client.get(AUDIT, params={"vehicle": "another"})).json()["total"] == 0
    assert (await client.get(AUDIT, params={"vehicle": "uav"})).json()["total"] == 5


@pytest.mark.parametrize(
    "which",
    [
        {"since": "0001-01-01T00:00:00+05:00"},
        {"until": "soon"},
        {"since": "2026"},
        {"until": "-5.0"},
        {"kind": "x"},
        {"limit": 0},
    ],
)
async def test_odd_filters_are_refused(client: httpx.AsyncClient, which: dict[str, Any]) -> None:
    """What is no moment, no kind, no number of entries is a 422."""
    check_problem(await client.get(AUDIT, params=which), 422)


async def test_an_entry_is_there_before_the_order_is_sent(
    client: httpx.AsyncClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    """When the vehicle hears of an order, its entry is in the table already."""
    vehicle = await connected(client)
    seen: list[Any] = []
    arm = VehicleClient.arm

    async def watched(self: VehicleClient, *what: Any, **named: Any) -> Any:
        seen.extend((await client.get(AUDIT)).json()["entries"])
        return await arm(self, *what, **named)

    monkeypatch.setattr(VehicleClient, "arm", watched)
    await order(client, vehicle, "arm")
    assert [(entry["what"], entry["outcome"]) for entry in seen] == [({"command": "arm"}, "pending")]


async def test_a_full_disk_holds_up_nothing_that_makes_safe(
    client: httpx.AsyncClient, settings: Settings, monkeypatch: pytest.MonkeyPatch, plan_id: str
) -> None:
    """While nothing can be written: arm, upload and clear are refused unsent; hold goes out, and says so."""
    monkeypatch.setattr(databases, "BUSY_S", 1)
    monkeypatch.setattr(audit, "WAIT_S", 0.3)
    vehicle = await connected(client)
    with held(settings):
        for answer in (
            await order(client, vehicle, "arm"),
            await client.post(vehicle + "/mission", json={"plan_id": plan_id}),
            await client.delete(vehicle + "/mission"),
        ):
            check_problem(answer, 503)
            assert "cannot be recorded" in answer.json()["detail"]
        assert not (await client.get(vehicle)).json()["state"]["armed"]
        assert (await client.get(vehicle)).json()["upload"] is None
        answer = await order(client, vehicle, "hold")
        assert answer.json()["outcome"] == "done"
        assert "could not be written yet" in answer.json()["unrecorded"]
    found = await entries(client, lambda found: len(found) == 4 and settled(found))
    assert [(entry["kind"], entry["outcome"]) for entry in found] == [
        ("order", "done"),
        ("clear", "refused"),
        ("upload", "refused"),
        ("order", "refused"),
    ]
    commands = (await client.get(vehicle + "/commands")).json()["commands"]
    assert [command["unrecorded"] for command in commands] == [None]


@pytest.mark.parametrize("kept", [True, False])
async def test_an_upload_left_by_a_crash_is_resolved(settings: Settings, plan_file: Path, kept: bool) -> None:
    """A row that is pending at the start becomes what reading back finds: accepted, or different."""
    url = f"127.0.0.1:{free_port()}"
    async with autopilot(f"udpout:{url}"):
        async with service(settings) as client:
            vehicle = await add(client, "uav", f"udpin:{url}")
            plan_id = await stored(client, plan_file)
            path = f"{VEHICLES}/{vehicle['id']}"
            body = {"plan_id": plan_id, "parts": ["mission", "fence"]}
            assert (await client.post(path + "/mission", json=body)).json()["outcome"] == "accepted"
            if not kept:
                await client.delete(path + "/mission")
        with closing(sqlite3.connect(settings.database)) as database, database:
            # As a crash in the middle of it would have left it.
            database.execute("UPDATE uploads SET outcome = 'pending', ended_at = NULL")
            database.execute("UPDATE audit SET outcome = 'pending', ended_at = NULL")
            database.execute("UPDATE vehicles SET held_plan_id = NULL, last_plan_id = NULL")
        async with service(settings) as client:
            body = await until(client, lambda body: body["upload"] is not None and body["sent"] is not None)
            assert body["upload"]["outcome"] == ("accepted" if kept else "different")
            assert body["plan_id"] == (plan_id if kept else None)
            found = await entries(client, settled)
            assert {entry["outcome"] for entry in found} == {"unknown"}
            assert "may have been carried out" in found[0]["reason"]
            with closing(sqlite3.connect(settings.database)) as database:
                async with asyncio.timeout(PATIENCE_S):
                    while (rows := database.execute("SELECT outcome FROM uploads").fetchall()) == [
                        ("pending",)
                    ]:
                        await asyncio.sleep(0.05)
            assert rows == [("accepted" if kept else "different",)]


async def test_an_upload_left_for_a_vehicle_let_go_is_unknown(settings: Settings) -> None:
    """Where there is nobody to ask any more, that is what stands."""
    async with service(settings):
        pass
    with closing(sqlite3.connect(settings.database)) as database, database:
        database.execute(
            "INSERT INTO uploads (vehicle_id, vehicle_name, plan_id, parts, outcome, detail, started_at) "
            "VALUES ('gone', 'gone', 'plan', '[\"mission\"]', 'pending', '{}', '2026-01-01T00:00:00+00:00')"
        )
    async with service(settings):
        pass
    with closing(sqlite3.connect(settings.database)) as database:
        assert database.execute("SELECT outcome FROM uploads").fetchall() == [("unknown",)]
