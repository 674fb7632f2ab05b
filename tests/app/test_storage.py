"""A disk that is full and a database that is held: nothing is left half done, and all goes on afterwards."""

from __future__ import annotations

import asyncio
import resource
import sqlite3
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest

from app.main import create_app
from app.services.errors import OverloadedError
from app.services.plans import planning
from app.services.store import database as databases
from app.services.store.database import Database
from app.services.store.plans import PlanStore
from app.settings import Settings
from tests.app.conftest import fake_house, serving
from tests.app.rasters import ramp
from tests.app.test_problems import check_problem
from tests.app.test_process import PLANS, Service, service
from tests.patience import PATIENCE_S

READY = "/health/ready"
SOUND = {"features": [{}], "name": "sound"}


@contextmanager
def full_disk(process: Service) -> Iterator[None]:
    """No file of a service may grow beyond what the locks of its workers need."""
    pid = process.process.pid
    soft, hard = resource.prlimit(pid, resource.RLIMIT_FSIZE)
    resource.prlimit(pid, resource.RLIMIT_FSIZE, (1000, hard))
    try:
        yield
    finally:
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (soft, hard))


def wait_ready(running: Service, status: int) -> dict[str, bool]:
    """The checks of the probe once it answers with a status."""
    end_s = time.monotonic() + PATIENCE_S
    while (answer := running.client.get(READY)).status_code != status:
        assert time.monotonic() < end_s, answer.text
        time.sleep(0.05)
    checks: dict[str, bool] = answer.json()["checks"]
    return checks


@pytest.mark.skipif(not hasattr(resource, "prlimit"), reason="limits another process, as Linux does")
def test_a_plan_that_cannot_be_written_has_failed(tmp_path: Path) -> None:
    """On a full disk a plan that is made ends failed, new ones are refused in words, and the probe tells.

    With room again all goes on, and what was told is written.
    """
    end = tmp_path / "end"
    with service(tmp_path / "plans.db") as running:
        wait_ready(running, 200)
        waiting = SOUND | {"fake": "waits", "for": str(end)}
        plan = running.client.post(PLANS, json=waiting).json()
        running.until(plan["id"], "running")
        with full_disk(running):
            end.touch()
            assert running.until(plan["id"], "failed")["error"]["type"] == "storage"
            for state, total in (("running", 0), ("failed", 1), ("queued", 0)):
                assert running.client.get(PLANS, params={"state": state}).json()["total"] == total
            refused = running.client.post(PLANS, json=SOUND)
            check_problem(refused, 503)
            assert "retry-after" in refused.headers
            assert running.client.get(PLANS).json()["total"] == 1
            assert not wait_ready(running, 503)["database"]
        assert running.post("done", wait_s=20)["state"] == "done"
        wait_ready(running, 200)
        with closing(sqlite3.connect(f"file:{tmp_path / 'plans.db'}?mode=ro", uri=True)) as rows:
            end_s = time.monotonic() + PATIENCE_S
            while rows.execute("SELECT state FROM plans ORDER BY number").fetchall()[0] != ("failed",):
                assert time.monotonic() < end_s
                time.sleep(0.05)


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Little patience with a database that is held."""
    monkeypatch.setattr(databases, "BUSY_S", 1)
    monkeypatch.setattr(planning, "SETTLE_S", 0.1)


@contextmanager
def held(settings: Settings) -> Iterator[None]:
    """Another program writes to the database all the while."""
    holder = sqlite3.connect(settings.database, isolation_level=None)
    holder.execute("BEGIN IMMEDIATE")
    try:
        yield
    finally:
        holder.close()


@pytest.mark.usefixtures("short")
async def test_requests_that_fail_leave_nothing_behind(settings: Settings, tmp_path: Path) -> None:
    """Plans, scenarios, rasters, vehicles: a 503 in words, and neither rows nor files nor open links."""
    async with serving(create_app(settings, fake_house)) as client:
        with held(settings):
            posts = (
                client.post(PLANS, json=SOUND),
                client.post("/api/v1/scenarios", json=SOUND),
                client.post("/api/v1/terrain", content=ramp(), params={"vertical_datum": "EGM96"}),
                client.post(
                    "/api/v1/vehicles", json={"name": "uav", "url": "udpin:127.0.0.1:0", "timeout_s": 0.1}
                ),
            )
            for answer in await asyncio.gather(*posts):
                check_problem(answer, 503)
            assert (await client.get(READY)).status_code == 503
        assert (await client.get(READY)).status_code == 200
        for path, members in (
            (PLANS, "plans"),
            ("/api/v1/scenarios", "scenarios"),
            ("/api/v1/terrain", "terrain"),
            ("/api/v1/vehicles", "vehicles"),
        ):
            assert (await client.get(path)).json()[members] == []
        assert list(tmp_path.glob("plans-terrain/*.npz")) == []


@pytest.mark.usefixtures("short")
async def test_a_vehicle_that_cannot_be_forgotten_stays(settings: Settings) -> None:
    """Let go while nothing can be written, a vehicle is there as before."""
    async with serving(create_app(settings, fake_house)) as client:
        url = "udpin:127.0.0.1:0"
        body = {"name": "uav", "url": url, "timeout_s": 0.1}
        vehicle = (await client.post("/api/v1/vehicles", json=body)).json()
        path = f"/api/v1/vehicles/{vehicle['id']}"
        with held(settings):
            check_problem(await client.delete(path), 503)
            forward = {"forward": [{"url": "udpout:127.0.0.1:9", "write": False}]}
            check_problem(await client.put(f"{path}/forward", json=forward), 503)
        assert (await client.get(path)).json()["forward"] == []
        assert (await client.delete(path)).status_code == 204


async def test_the_queue_holds_its_limit(settings: Settings) -> None:
    """However many plans are posted at once, no more wait than may, and nothing is kept of the others."""
    database = Database(settings.database)
    await database.open()
    store = PlanStore(database)
    posts = [store.add("plan", "{}", "", [], None, None, "", 5) for _ in range(25)]
    answers = await asyncio.gather(*posts, return_exceptions=True)
    assert sum(isinstance(answer, OverloadedError) for answer in answers) == 20
    assert await store.count("queued") == await store.count() == 5
    await database.close()
